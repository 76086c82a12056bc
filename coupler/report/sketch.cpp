#include "coupler/report/sketch.hpp"

#include "coupler/case/case_view.hpp"
#include "coupler/plot/canvas.hpp"
#include "coupler/plot/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <sstream>

namespace strake::report {
namespace {

using picture::Align;
using picture::PageCanvas;
using picture::Place;
using picture::Range;
constexpr double width = 720, edge = 44, tallest = 420;  // [px]
constexpr double letters = 15;                           // [px] of the page's style sheet

/// Metres to pixels.
struct View {
  Range x, y;
  double scale = 1, height = 0;
  Place operator()(const Place& p) const {
    return {edge + scale * (p.x - x.lo), height - edge - scale * (p.y - y.lo)};
  }
  std::vector<Place> operator()(std::vector<Place> points) const {
    for (Place& p : points) p = (*this)(p);
    return points;
  }
};

std::vector<Place> corners(const std::vector<Place>& box) {
  return {box[0], {box[1].x, box[0].y}, box[1], {box[0].x, box[1].y}};
}

std::vector<Place> area(const Recorded& run, const std::string& polygon, const std::string& box) {
  std::vector<Place> points = places(run.setting(polygon));
  if (points.size() >= 3) return points;
  points = places(run.setting(box));
  return points.size() == 2 ? corners(points) : std::vector<Place>{};
}

/// The probes of one place share a label, which stands below them in the order of x, so that none hides
/// another.
void draw_probes(PageCanvas& canvas, const Recorded& run, const View& view) {
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
  double free_from = 0, depth = 0;  // where the last label ends, and how far down it stood
  for (const Label& label : labels) {
    const double half = 4.2 * static_cast<double>(label.names.size());
    depth = label.at.x - half < free_from ? depth + 18 : 0;
    free_from = label.at.x + half;
    const double x = std::clamp(label.at.x, edge + 6 + half, width - edge - 6 - half);
    const double lowest = view.height - edge - 6;
    const double below = label.at.y + 34 + depth, y = below > lowest ? lowest - depth : below;
    canvas.path({label.at, {x, y - 13}}, {.name = "leader"});
    canvas.circle(label.at, 4.5, {.name = "probe"});
    canvas.text(x, y, label.names, letters, Align::centre);
  }
}

/// Supported sides of a body, drawn as heavy lines. at: its corners, counter-clockwise from the lower left.
void draw_sides(PageCanvas& canvas, const Recorded& run, const View& view, const std::string& prefix,
                const std::vector<Place>& at, std::string& said) {
  const std::vector<std::pair<std::string, std::vector<Place>>> known = {{"left", {at[0], at[3]}},
                                                                         {"right", {at[1], at[2]}},
                                                                         {"bottom", {at[0], at[1]}},
                                                                         {"top", {at[3], at[2]}}};
  for (const auto& [side, ends] : known) {
    const std::string how = run.setting(prefix + "." + side);
    if (how.empty() || how == "free") continue;
    canvas.path(view(ends), {.name = how == "clamped" ? "support held" : "support hinged"});
    said += (said.empty() ? "" : ", ") + side + " " + how;
  }
}

/// The tables of all bodies: structure, or structures[0], structures[1], ….
std::vector<std::string> tables_of(const Recorded& run) {
  std::vector<std::string> tables;
  for (int i = 0; !run.setting(fmt::format("structures[{}].name", i)).empty(); ++i)
    tables.push_back(fmt::format("structures[{}]", i));
  return tables.empty() ? std::vector<std::string>{"structure"} : tables;
}

/// Corners of a plate at the start, turned by its angle about the middle of its lower face. Empty: no plate.
std::vector<Place> corners_of_plate(const Recorded& run, const std::string& plate) {
  const auto number = [&](const char* key) {
    return std::strtod(run.setting(plate + "." + key).c_str(), nullptr);
  };
  const auto bottom = places("[" + run.setting(plate + ".bottom") + "]");
  const double half = 0.5 * number("length"), thickness = number("thickness");
  const double angle = number("angle") * std::numbers::pi / 180;
  if (half <= 0 || thickness <= 0 || bottom.empty()) return {};
  std::vector<Place> at = corners({{-half, 0}, {half, thickness}});
  for (Place& corner : at)
    corner = {bottom[0].x + corner.x * std::cos(angle) - corner.y * std::sin(angle),
              bottom[0].y + corner.x * std::sin(angle) + corner.y * std::cos(angle)};
  return at;
}

/// What holds a body, in words. A rigid one has no supports, though its case may name them for other solvers.
std::string draw_supports(PageCanvas& canvas, const Recorded& run, const View& view,
                          const std::string& body) {
  std::string said;
  if (run.setting(body + ".solver") == "rigid") return said;
  if (const auto plate = corners_of_plate(run, body + ".plate"); !plate.empty()) {
    draw_sides(canvas, run, view, body + ".plate.supports", plate, said);
    return said;
  }
  for (int i = 0;; ++i) {
    const std::string box = fmt::format("{}.box[{}]", body, i);
    const auto low = places("[" + run.setting(box + ".min") + "]"),
               high = places("[" + run.setting(box + ".max") + "]");
    if (low.empty() || high.empty()) return said;
    draw_sides(canvas, run, view, box + ".supports", corners({low[0], high[0]}), said);
  }
}

/// The way the supports, or a whole body at the start, go. top: the middle of its upper side.
void draw_arrow(PageCanvas& canvas, const Recorded& run, const View& view, const std::string& body,
                const Place& top) {
  const auto v = places("[" + run.setting(body + ".velocity") + "]");
  if (v.empty()) return;
  const double speed = std::hypot(v[0].x, v[0].y);
  if (speed == 0) return;
  const double length = 40, ux = v[0].x / speed, uy = -v[0].y / speed;
  const Place head = view(top);
  const Place tip = {head.x, std::max(head.y - 8, length + 4)},
              tail = {tip.x - length * ux, tip.y - length * uy};
  const Place left = {tip.x - 9 * ux + 5 * uy, tip.y - 9 * uy - 5 * ux},
              right = {tip.x - 9 * ux - 5 * uy, tip.y - 9 * uy + 5 * ux};
  canvas.shape({{tail, tip}, {left, tip, right}}, "arrow", false);
  canvas.text(tail.x + 12, std::max(14.0, tail.y + 10), quantity(speed, "m/s"), letters);
}

struct Extent {
  Range x, y;
  void add(const std::vector<Place>& points) {
    for (const Place& p : points) {
      x.add(p.x);
      y.add(p.y);
    }
  }
};

/// Supports and ways of all bodies; what they are, in words for the caption.
std::string draw_bodies(PageCanvas& canvas, const Recorded& run, const View& view, const Extent& all) {
  if (all.x.empty()) return {};
  const std::vector<std::string> tables = tables_of(run);
  std::string said;
  if (tables.size() == 1)
    said =
        fmt::format(". Body {} × {}", quantity(all.x.hi - all.x.lo, "m"), quantity(all.y.hi - all.y.lo, "m"));
  for (const std::string& table : tables) {
    const auto plate = corners_of_plate(run, table + ".plate");
    Extent own;
    own.add(plate);
    if (plate.empty() && tables.size() == 1) own = all;
    const std::string supports = draw_supports(canvas, run, view, table);
    if (!own.x.empty()) draw_arrow(canvas, run, view, table, {0.5 * (own.x.lo + own.x.hi), own.y.hi});
    if (tables.size() > 1) said += (said.empty() ? ". Bodies: " : "; ") + run.setting(table + ".name");
    if (!supports.empty()) said += tables.size() > 1 ? " (" + supports + ")" : ", supports: " + supports;
  }
  return said;
}

/// The middle of a drawing that is as large as it may be.
View view_of(const Extent& all) {
  View view = {.x = all.x, .y = all.y};
  const double wide = view.x.hi - view.x.lo, high = std::max(view.y.hi - view.y.lo, 1e-3 * wide);
  view.scale = std::min((width - 2 * edge) / wide, tallest / high);
  view.height = view.scale * high + 2 * edge;
  view.x.lo -= 0.5 * ((width - 2 * edge) / view.scale - wide);
  return view;
}

void draw_tank(PageCanvas& canvas, const Recorded& run, const View& view, const std::vector<Place>& tank) {
  const bool open = run.setting("fluid.open_top") == "true" && tank.size() == 4 &&
                    run.setting("fluid.tank_polygon").empty();
  const std::vector<Place> walls = open ? std::vector<Place>{tank[3], tank[0], tank[1], tank[2]} : tank;
  canvas.shape({view(walls)}, "tank", !open);
  Extent box;
  box.add(tank);
  canvas.text(view({0.5 * (box.x.lo + box.x.hi), 0}).x, view.height - 14,
              quantity(box.x.hi - box.x.lo, "m") + " wide", letters, Align::centre);
}

void tell_depth(PageCanvas& canvas, const View& view, const std::vector<Place>& water) {
  Extent box;
  box.add(water);
  // Beside a column that is too narrow for the words.
  const bool fits = view.scale * (box.x.hi - box.x.lo) > 190;
  const Place p = view({fits ? box.x.lo : box.x.hi, 0.5 * (box.y.lo + box.y.hi)});
  canvas.text(p.x + 8, p.y, "water " + quantity(box.y.hi - box.y.lo, "m") + " deep", letters);
}

}  // namespace

std::vector<Place> places(const std::string& list) {
  std::vector<Place> points;
  std::istringstream rest(list);
  for (std::string point; std::getline(rest, point, ']');)
    if (const std::vector<double> numbers = numbers_in(point); numbers.size() >= 2)
      points.push_back({numbers[0], numbers[1]});
  return points;
}

std::string sketch(const Recorded& run, const picture::Scene* start) {
  const auto tank = area(run, "fluid.tank_polygon", "fluid.tank");
  const auto water = area(run, "fluid.water_polygon", "fluid.water");
  auto bodies = start != nullptr ? outline(*start) : std::vector<std::vector<Place>>{};
  Extent body, all;
  for (const auto& loop : bodies) body.add(loop);
  for (const auto* points : {&tank, &water}) all.add(*points);
  for (const auto& loop : bodies) all.add(loop);
  if (all.x.empty() || !(all.x.lo < all.x.hi)) return {};
  const View view = view_of(all);

  PageCanvas canvas(width, view.height);
  if (!water.empty()) canvas.shape({view(water)}, "water", true);
  if (!tank.empty()) draw_tank(canvas, run, view, tank);
  if (!water.empty()) tell_depth(canvas, view, water);
  for (auto& loop : bodies) loop = view(loop);
  canvas.shape(bodies, "body", true);
  const std::string said = draw_bodies(canvas, run, view, body);
  for (const auto& line : start != nullptr ? start->lines : std::vector<std::vector<Place>>{})
    canvas.path(view(line), {.name = "line"});
  draw_probes(canvas, run, view);

  std::string caption = "The case at its start, to scale";
  if (start != nullptr && !start->cut.empty()) caption += "; " + start->cut;
  caption += said;
  if (start != nullptr && !start->lines.empty()) caption += ". Lines: springs and mooring lines";
  caption += run.setting("output.probe[0].name").empty() ? "." : ". Dots: probes.";
  return fmt::format(
      "<figure class=\"wide\">\n<div class=\"scroll\">{}</div>\n<figcaption>{}</figcaption>\n</figure>\n",
      canvas.svg("sketch", caption), escape(caption));
}

}  // namespace strake::report
