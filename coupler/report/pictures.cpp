// Pictures of the runs at chosen instants, each instant in the same colours for every run.
#include "coupler/plot/drawing.hpp"
#include "coupler/plot/html.hpp"
#include "coupler/report/sections.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>

namespace strake::report {
namespace {

constexpr std::size_t most_runs = 6;  // that are drawn; more would make a page of many megabytes

std::string base64(const std::string& bytes) {
  constexpr int variant = sodium_base64_VARIANT_ORIGINAL;
  std::string text(sodium_base64_encoded_len(bytes.size(), variant), '\0');
  sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()),
                    bytes.size(), variant);
  text.pop_back();  // the end of a C string
  return text;
}

struct Instant {
  std::string name;  // "contact"
  double time = 0;   // [s]
};

struct FirstPeak {
  double time = 0, size = 0;  // [s], of the deflection [m]
};

/// Of the largest displacement that a probe of this run saw.
std::optional<FirstPeak> largest_first_peak(const Recorded& run) {
  std::optional<FirstPeak> best;
  for (const ProbeResult& result : run.probes) {
    const auto time = result.metric("time_of_first_peak"), value = result.metric("first_peak");
    if (time && value && result.unit == "m" && std::abs(*value) > (best ? best->size : 0))
      best = {*time, std::abs(*value)};
  }
  return best;
}

/// Of the first probe that has one; of force.x, force.y and force.z of the largest, as those across a
/// symmetric body are noise.
std::optional<double> first_peak_of_forces(const Recorded& run) {
  std::optional<double> at;
  double largest = 0;
  for (const ProbeResult& result : run.probes) {
    const bool force =
        result.probe.starts_with("force.") || result.probe.find(".force.") != std::string::npos;
    const auto time = result.metric("time_of_first_peak"), value = result.metric("first_peak");
    if (!time || (at && !(force && largest > 0 && value && std::abs(*value) > largest))) continue;
    at = time;
    largest = force && value ? std::abs(*value) : 0;  // 0: no force, so that it stays
  }
  return at;
}

/// Where one run bends and another is rigid, the rigid one is shown at the first peak of the other.
std::optional<double> first_peak_time(const Recorded& run, const std::vector<Recorded>& runs) {
  std::optional<FirstPeak> largest;
  for (const Recorded& other : runs)
    if (const auto peak = largest_first_peak(other); peak && peak->size > (largest ? largest->size : 0))
      largest = peak;
  const auto own = largest_first_peak(run);
  if (own && own->size > 1e-3 * largest->size) return own->time;
  if (largest) return largest->time;
  return first_peak_of_forces(run);
}

std::vector<Instant> instants_of(const Recorded& run, const std::vector<Recorded>& runs,
                                 const std::vector<double>& wanted) {
  std::vector<Instant> instants;
  for (const double time : wanted) instants.push_back({quantity(time, "s"), time});
  if (!wanted.empty()) return instants;
  const double end = run.end_time.value_or(std::numeric_limits<double>::infinity());
  double contact = std::numeric_limits<double>::infinity();
  for (const auto& [probe, time] : run.contact) contact = std::min(contact, time);
  if (std::isfinite(contact)) instants.push_back({"contact", contact});
  if (const auto time = first_peak_time(run, runs)) instants.push_back({"first peak", *time});
  if (instants.empty() && std::isfinite(end)) instants.push_back({"half way", 0.5 * end});
  instants.push_back({"end", end});
  return instants;
}

struct Shot {
  std::string run, instant;
  picture::Scene scene;
};

/// The last frame by damage, where something is damaged.
void add_damage(const picture::RunFrames& frames, const std::string& run, std::vector<Shot>& shots,
                std::vector<std::string>& order) {
  const std::string instant = "damage at the end";
  try {
    picture::Scene scene = picture::read_scene(frames, {.field = "damage"});
    if (scene.solid_field.name != "damage" || !(scene.solid_field.all.hi > 0)) return;
    scene.solid_field.shown = {0, 1};
    shots.push_back({run, instant, std::move(scene)});
  } catch (const Error&) {  // no frame has such a field
    return;
  }
  if (std::find(order.begin(), order.end(), instant) == order.end()) order.push_back(instant);
}

/// The body and as much again on every side, where it is small in its tank; else all.
std::optional<picture::View> around_body(const picture::Scene& scene) {
  picture::Range x, y;
  const auto add = [&](const picture::Place& p) {
    x.add(p.x);
    y.add(p.y);
  };
  for (const picture::Patch& patch : scene.cells)
    for (const picture::Place& p : patch.corner) add(p);
  for (const picture::Mark& mark : scene.solid) add(mark.at);
  const double length = x.empty() ? 0 : std::max(x.hi - x.lo, y.hi - y.lo);
  if (scene.water.empty() || !(length > 0) || length > 0.4 * (scene.x.hi - scene.x.lo)) return std::nullopt;
  const double room = 1.5 * scene.spacing;
  return picture::View{std::max(x.lo - length, scene.x.lo - room), std::max(y.lo - length, scene.y.lo - room),
                       std::min(x.hi + length, scene.x.hi + room),
                       std::min(y.hi + 0.5 * length, scene.y.hi + room)};
}

}  // namespace

std::string pictures(const std::vector<Recorded>& runs, const std::vector<double>& at) {
  std::vector<Shot> shots;
  std::vector<std::string> order;
  std::size_t drawn = 0;
  for (const Recorded& run : runs) {
    if (drawn == most_runs) break;
    const std::size_t before = shots.size();
    double last = -1;
    try {  // no frames, or damaged ones: the rest of the report stands
      const picture::RunFrames frames = picture::find_frames(run.folder);
      for (const Instant& instant : instants_of(run, runs, at)) {
        picture::Scene scene = picture::read_scene(frames, {.time = instant.time});
        if (shots.size() > before && scene.time == last) continue;  // the same frame twice
        last = scene.time;
        if (std::find(order.begin(), order.end(), instant.name) == order.end()) order.push_back(instant.name);
        shots.push_back({run.name, instant.name, std::move(scene)});
      }
      add_damage(frames, run.name, shots, order);
    } catch (const std::exception&) {
    }
    drawn += shots.size() > before ? 1 : 0;
  }
  if (shots.empty()) return {};

  std::map<std::string, std::pair<picture::Range, picture::Range>> ranges;  // instant → water, structure
  for (const Shot& shot : shots) {
    ranges[shot.instant].first.add(shot.scene.water_field.shown);
    ranges[shot.instant].second.add(shot.scene.solid_field.shown);
  }
  std::string body =
      "<p>Water by pressure, structure by von Mises stress where the solver gives it. The pictures of one "
      "instant share their colours; each shows the frame next to the time it is named after, around a body "
      "that is small in its tank.</p>\n";
  if (runs.size() > most_runs)
    body += fmt::format("<p>The first {} runs are drawn; <code>strake picture</code> draws any.</p>\n",
                        most_runs);
  for (const std::string& instant : order) {
    body += "<h3>" + escape(instant) + "</h3>\n<div class=\"pictures\">\n";
    for (const Shot& shot : shots) {
      if (shot.instant != instant) continue;
      picture::DrawingOptions drawing;
      drawing.width = 600;
      drawing.ratio = 1.6;
      drawing.field = "pressure";
      drawing.view = around_body(shot.scene);
      const auto& [water, solid] = ranges[instant];
      if (!water.empty()) drawing.range = water;
      if (!solid.empty()) drawing.solid_range = solid;
      const std::string caption =
          fmt::format("{}: {}, t = {}", shot.run, instant, quantity(shot.scene.time, "s"));
      body += fmt::format(
          "<figure>\n<div class=\"scroll\"><img "
          "alt=\"{0}\" "
          "src=\"data:image/png;base64,{1}\"></div>\n<figcaption>{0}</figcaption>\n</figure>\n",
          escape(caption), base64(picture::draw(shot.scene, drawing, picture::Canvas::Kind::png)));
    }
    body += "</div>\n";
  }
  return section("pictures", "Pictures", body);
}

}  // namespace strake::report
