#include "coupler/report/sketch.hpp"

#include "coupler/plot/html.hpp"
#include "coupler/report/outline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>

namespace strake::report {
namespace {

using picture::Place;
using picture::Range;
constexpr double width = 720, edge = 44, tallest = 420;  // [px]

/// Metres to pixels.
struct View {
  Range x, y;
  double scale = 1, height = 0;
  Place operator()(const Place& p) const {
    return {edge + scale * (p.x - x.lo), height - edge - scale * (p.y - y.lo)};
  }
};

std::string path(const View& view, const std::vector<Place>& points, bool closed) {
  std::string d;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Place p = view(points[i]);
    fmt::format_to(std::back_inserter(d), "{}{:.1f} {:.1f}", i == 0 ? "M" : "L", p.x, p.y);
  }
  return d + (closed ? "Z" : "");
}

std::vector<Place> corners(const std::vector<Place>& box) {
  return {box[0], {box[1].x, box[0].y}, box[1], {box[0].x, box[1].y}};
}

std::vector<Place> area(const Recorded& run, const std::string& polygon, const std::string& box) {
  std::vector<Place> points = places(run.setting(polygon));
  if (points.size() >= 3) return points;
  points = places(run.setting(box));
  return points.size() == 2 ? corners(points) : std::vector<Place>{};
}

std::string text(const Place& p, const std::string& words, const char* anchor = "middle") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", p.x, p.y, anchor,
                     escape(words));
}

/// Draws the probes. Those of one place share a label; labels stand below in the order of x, so that none
/// covers another.
std::string probes(const Recorded& run, const View& view) {
  struct Label {
    Place at;
    std::string names;
  };
  std::vector<Label> labels;
  for (int i = 0;; ++i) {
    const std::string name = run.setting(fmt::format("output.probe[{}].name", i));
    if (name.empty()) break;
    const auto at = places(run.setting(fmt::format("output.probe[{}].at", i)));
    if (at.empty()) continue;
    const Place p = view(at[0]);
    const auto same = std::find_if(labels.begin(), labels.end(), [&](const Label& l) {
      return std::abs(l.at.x - p.x) < 8 && std::abs(l.at.y - p.y) < 8;
    });
    if (same == labels.end())
      labels.push_back({p, name});
    else
      same->names += ", " + name;
  }
  std::sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) { return a.at.x < b.at.x; });
  std::string svg;
  double free_from = 0, depth = 0;  // where the last label ends, and how far down it stood
  for (const Label& label : labels) {
    const double half = 4.2 * static_cast<double>(label.names.size());
    depth = label.at.x - half < free_from ? depth + 18 : 0;
    free_from = label.at.x + half;
    const double x = std::clamp(label.at.x, edge + 6 + half, width - edge - 6 - half);
    const double lowest = view.height - edge - 6;
    const double below = label.at.y + 34 + depth, y = below > lowest ? lowest - depth : below;
    svg += fmt::format(
        "<path class=\"leader\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>"
        "<circle class=\"probe\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\"/>\n",
        label.at.x, label.at.y, x, y - 13, label.at.x, label.at.y);
    svg += text({x, y}, label.names);
  }
  return svg;
}

/// A supported side of a body, hatched by a heavy line.
std::string support(const View& view, const Place& a, const Place& b, const std::string& how) {
  const Place p = view(a), q = view(b);
  return fmt::format("<path class=\"support {}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n",
                     how == "clamped" ? "held" : "hinged", p.x, p.y, q.x, q.y);
}

std::string sides(const Recorded& run, const View& view, const std::string& prefix, const Place& low,
                  const Place& high, std::string& said) {
  const std::vector<std::pair<std::string, std::pair<Place, Place>>> known = {
      {"left", {low, {low.x, high.y}}},
      {"right", {{high.x, low.y}, high}},
      {"bottom", {low, {high.x, low.y}}},
      {"top", {{low.x, high.y}, high}}};
  std::string svg;
  for (const auto& [side, ends] : known) {
    const std::string how = run.setting(prefix + "." + side);
    if (how.empty() || how == "free") continue;
    svg += support(view, ends.first, ends.second, how);
    said += (said.empty() ? "" : ", ") + side + " " + how;
  }
  return svg;
}

std::string supports(const Recorded& run, const View& view, const Range& x, const Range& y,
                     std::string& said) {
  if (!run.setting("structure.plate.length").empty() && !x.empty())
    return sides(run, view, "structure.plate.supports", {x.lo, y.lo}, {x.hi, y.hi}, said);
  std::string svg;
  for (int i = 0;; ++i) {
    const std::string box = fmt::format("structure.box[{}]", i);
    const auto low = places("[" + run.setting(box + ".min") + "]"),
               high = places("[" + run.setting(box + ".max") + "]");
    if (low.empty() || high.empty()) break;
    svg += sides(run, view, box + ".supports", low[0], high[0], said);
  }
  return svg;
}

/// The way the supports, or the whole body at the start, go.
std::string arrow(const Recorded& run, const View& view, const Range& x, const Range& y) {
  const auto v = places("[" + run.setting("structure.velocity") + "]");
  if (v.empty() || x.empty()) return {};
  const double speed = std::hypot(v[0].x, v[0].y);
  if (speed == 0) return {};
  const double length = 40, ux = v[0].x / speed, uy = -v[0].y / speed;
  const Place head = view({0.5 * (x.lo + x.hi), y.hi});
  const Place tip = {head.x, std::max(head.y - 8, length + 4)},
              tail = {tip.x - length * ux, tip.y - length * uy};
  return fmt::format(
             "<path class=\"arrow\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}m{:.1f} {:.1f}L{:.1f} "
             "{:.1f}l{:.1f} {:.1f}\"/>\n",
             tail.x, tail.y, tip.x, tip.y, -9 * ux + 5 * uy, -9 * uy - 5 * ux, tip.x, tip.y, -9 * ux - 5 * uy,
             -9 * uy + 5 * ux) +
         text({tail.x + 12, std::max(14.0, tail.y + 10)}, quantity(speed, "m/s"), "start");
}

}  // namespace

std::vector<Place> places(const std::string& list) {
  std::vector<Place> points;
  std::vector<double> numbers;
  for (const char* at = list.c_str(); *at != '\0';) {
    if (*at == ']') {
      if (numbers.size() >= 2) points.push_back({numbers[0], numbers[1]});
      numbers.clear();
      ++at;
      continue;
    }
    char* end = nullptr;
    const double number = std::strtod(at, &end);
    if (end == at) {
      ++at;
      continue;
    }
    numbers.push_back(number);
    at = end;
  }
  return points;
}

std::string sketch(const Recorded& run, const picture::Scene* start) {
  const auto tank = area(run, "fluid.tank_polygon", "fluid.tank");
  const auto water = area(run, "fluid.water_polygon", "fluid.water");
  const auto bodies = start != nullptr ? outline(*start) : std::vector<std::vector<Place>>{};
  View view;
  const auto span = [&](const std::vector<Place>& points, Range& x, Range& y) {
    for (const Place& p : points) {
      x.add(p.x);
      y.add(p.y);
    }
  };
  Range body_x, body_y;
  for (const auto& loop : bodies) span(loop, body_x, body_y);
  for (const auto* points : {&tank, &water}) span(*points, view.x, view.y);
  for (const auto& loop : bodies) span(loop, view.x, view.y);
  if (view.x.empty() || !(view.x.lo < view.x.hi)) return {};
  const double high = std::max(view.y.hi - view.y.lo, 1e-3 * (view.x.hi - view.x.lo));
  view.scale = std::min((width - 2 * edge) / (view.x.hi - view.x.lo), tallest / high);
  view.height = view.scale * high + 2 * edge;
  const double shift = 0.5 * ((width - 2 * edge) / view.scale - (view.x.hi - view.x.lo));
  view.x.lo -= shift;  // in the middle of the drawing

  std::string svg, said;
  if (!water.empty()) svg += fmt::format("<path class=\"water\" d=\"{}\"/>\n", path(view, water, true));
  if (!tank.empty()) {
    const bool open = run.setting("fluid.open_top") == "true" && tank.size() == 4 &&
                      run.setting("fluid.tank_polygon").empty();
    const std::vector<Place> walls = open ? std::vector<Place>{tank[3], tank[0], tank[1], tank[2]} : tank;
    svg += fmt::format("<path class=\"tank\" d=\"{}\"/>\n", path(view, walls, !open));
    Range x, y;
    span(tank, x, y);
    svg += text({view({0.5 * (x.lo + x.hi), 0}).x, view.height - 14}, quantity(x.hi - x.lo, "m") + " wide");
  }
  if (!water.empty()) {
    Range x, y;
    span(water, x, y);
    // Beside a column that is too narrow for the words.
    const bool fits = view.scale * (x.hi - x.lo) > 190;
    const Place p = view({fits ? x.lo : x.hi, 0.5 * (y.lo + y.hi)});
    svg += text({p.x + 8, p.y}, "water " + quantity(y.hi - y.lo, "m") + " deep", "start");
  }
  std::string loops;
  for (const auto& loop : bodies) loops += path(view, loop, true);
  if (!loops.empty()) svg += fmt::format("<path class=\"body\" d=\"{}\"/>\n", loops);
  svg += supports(run, view, body_x, body_y, said);
  svg += arrow(run, view, body_x, body_y);
  svg += probes(run, view);

  std::string caption = "The case at its start, to scale";
  if (start != nullptr && !start->cut.empty()) caption += "; " + start->cut;
  if (!body_x.empty())
    caption += fmt::format(". Body {} × {}", quantity(body_x.hi - body_x.lo, "m"),
                           quantity(body_y.hi - body_y.lo, "m"));
  if (!said.empty()) caption += ", supports: " + said;
  caption += ". Dots: probes.";
  return fmt::format(
      "<figure class=\"wide\">\n<div class=\"scroll\"><svg class=\"sketch\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "role=\"img\" "
      "aria-label=\"{2}\">\n<title>{2}"
      "</title>\n{3}</svg></div>\n<figcaption>{2}</figcaption>\n</figure>\n",
      width, view.height, escape(caption), svg);
}

}  // namespace strake::report
