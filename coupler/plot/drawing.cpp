#include "coupler/plot/drawing.hpp"

#include "coupler/plot/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake::picture {
namespace {

constexpr double left_margin = 62, right_margin = 18, top_margin = 58, axis_height = 46, bar_height = 58;
constexpr double small = 12, normal = 13, large = 17;  // [px] letters
constexpr std::size_t most_shapes = 5'000;             // of an SVG; more marks become an image
const Colour grey = {0.55, 0.58, 0.62}, dark = {0.11, 0.13, 0.16}, pale = {0.88, 0.90, 0.92},
             plain_water = {0.36, 0.55, 0.75}, plain_solid = {0.35, 0.37, 0.40};

/// Metres to pixels.
struct PlotArea {
  View view;
  double x = 0, y = 0, width = 0, height = 0, scale = 1;  // [px] of the drawn part, [px/m]
  Place operator()(const Place& p) const {
    return {x + scale * (p.x - view.left), y + height - scale * (p.y - view.low)};
  }
};

View whole(const Scene& scene) {
  View view;
  if (scene.x.empty() || scene.y.empty()) return view;
  const double room = std::max(0.02 * std::max(scene.x.hi - scene.x.lo, scene.y.hi - scene.y.lo),
                               1.5 * std::max(scene.spacing, scene.solid_spacing));
  view = {scene.x.lo - room, scene.y.lo - room, scene.x.hi + room, scene.y.hi + room};
  return view;
}

PlotArea place(const View& view, const DrawingOptions& options, double below) {
  PlotArea f;
  f.view = view;
  f.x = left_margin;
  f.y = top_margin;
  f.width = options.width - left_margin - right_margin;
  f.scale = f.width / (view.right - view.left);
  f.height = f.scale * (view.high - view.low);
  const double room = options.height > 0 ? options.height - top_margin - below : 900;
  if (f.height > room) {  // high and narrow: the height decides, and the picture stands in the middle
    f.scale = room / (view.high - view.low);
    f.height = room;
    const double narrow = f.scale * (view.right - view.left);
    f.x += 0.5 * (f.width - narrow);
    f.width = narrow;
  }
  return f;
}

Colour colour_of(double value, const Range& range, bool solid) {
  if (!std::isfinite(value) || range.empty()) return solid ? plain_solid : plain_water;
  const double s = (value - range.lo) / (range.hi - range.lo);
  return solid ? solid_colour(s) : water_colour(s);
}

constexpr double covering = 1.42, touching = 1.02;  // √2 of the radius; more than 1, since pixels are whole

double radius_of(double spacing, const PlotArea& f) {
  return std::max(0.7, 0.5 * spacing * f.scale);
}

void draw_water(Canvas& canvas, const PlotArea& f, const std::vector<Mark>& marks, double spacing,
                const Range& range) {
  // Large discs are single particles. Smaller ones cover the square around each, so that the field has no
  // gaps; the smallest are squares, which cost less and look the same.
  constexpr double seen_alone = 6, disc = 3;  // [px]
  const double radius = radius_of(spacing, f);
  for (const Mark& mark : marks) {
    const Place p = f(mark.at);
    if (p.x < f.x - radius || p.x > f.x + f.width + radius || p.y < f.y - radius ||
        p.y > f.y + f.height + radius)
      continue;
    const Colour colour = colour_of(mark.value, range, false);
    if (radius < disc)
      canvas.square(p.x, p.y, covering * radius, colour);
    else
      canvas.dot(p.x, p.y, (radius < seen_alone ? covering : 1.04) * radius, colour);
  }
}

/// Squares of a body's particles. A lattice that is turned or cut has gaps between them: those inside the
/// body are filled first by larger ones, which the body's own outline hides.
void draw_solid(Canvas& canvas, const PlotArea& f, const std::vector<Mark>& marks, double spacing,
                const Range& range) {
  const double radius = radius_of(spacing, f);
  const std::vector<bool> inner = surrounded(marks, spacing);
  for (const double larger : {covering, touching})
    for (std::size_t k = 0; k < marks.size(); ++k)
      if (inner[k] || larger == touching)
        canvas.square(f(marks[k].at).x, f(marks[k].at).y, larger * radius,
                      colour_of(marks[k].value, range, true));
}

void draw_cells(Canvas& canvas, const PlotArea& f, const std::vector<Patch>& cells, const Range& range,
                bool solid) {
  std::vector<Place> corner;
  for (const Patch& patch : cells) {
    corner.clear();
    for (const Place& p : patch.corner) corner.push_back(f(p));
    const Colour colour = colour_of(patch.value, range, solid);
    canvas.path(corner, {.colour = colour, .width = 2.5, .filled = corner.size() > 2});
  }
}

/// Springs and mooring lines: dark, with a light border, so that they are seen in water of any colour.
void draw_lines(Canvas& canvas, const PlotArea& f, const std::vector<std::vector<Place>>& lines) {
  for (const std::vector<Place>& line : lines) {
    std::vector<Place> path;
    for (const Place& p : line) path.push_back(f(p));
    canvas.path(path, {.colour = pale, .width = 4});
    canvas.path(path, {.colour = dark, .width = 1.8});
  }
}

void draw_axes(Canvas& canvas, const PlotArea& f) {
  canvas.path(
      {{f.x, f.y}, {f.x + f.width, f.y}, {f.x + f.width, f.y + f.height}, {f.x, f.y + f.height}, {f.x, f.y}},
      {.colour = grey});
  const double distance = f.height < 120 ? 40 : 60;
  const auto along = text_ticks(f.view.left, f.view.right, f.width / 90);
  const auto up = text_ticks(f.view.low, f.view.high, f.height / distance);
  for (const auto& [t, text] : along) {
    const double x = f({t, 0}).x, y = f.y + f.height;
    canvas.path({{x, y}, {x, y + 5}}, {.colour = dark});
    canvas.text(x, y + 19, text, small, Align::centre);
  }
  for (const auto& [t, text] : up) {
    const double y = f({0, t}).y;
    canvas.path({{f.x - 5, y}, {f.x, y}}, {.colour = dark});
    canvas.text(f.x - 8, y + 4, text, small, Align::right);
  }
  canvas.text(f.x + 0.5 * f.width, f.y + f.height + 37, "x [m]", small, Align::centre);
  canvas.text(f.x - 8, f.y - 10, "y [m]", small, Align::right);
}

/// "von_mises" → "von Mises stress of the structure".
std::string words(const std::string& field, bool solid) {
  if (field == "gap") return "gap of the air";
  if (field == "damage") return "damage of the structure (0 sound, 1 broken)";
  return (field == "von_mises" ? "von Mises stress" : in_words(field)) +
         (solid ? " of the structure" : " of the water");
}

/// A bar of colours with their range; values outside are noted beside the name.
void draw_bar(Canvas& canvas, double x, double y, double width, const Quantity& quantity, const Range& range,
              bool solid) {
  const double largest = std::max(std::abs(range.lo), std::abs(range.hi));
  const Prefix prefix = prefix_for(largest, quantity.unit);
  const std::string unit = with_prefix(prefix, quantity.unit);
  std::string title = words(quantity.name, solid) + (unit.empty() ? "" : " [" + unit + "]");
  const double slack = 1e-9 * largest;
  if (!quantity.all.empty() && (quantity.all.lo < range.lo - slack || quantity.all.hi > range.hi + slack)) {
    const std::string extremes = fmt::format(
        "   (extremes {:.3g} and {:.3g})", prefix.factor * quantity.all.lo, prefix.factor * quantity.all.hi);
    if (canvas.text_width(title + extremes, small) < width) title += extremes;
  }
  canvas.text(x, y + 12, title, small);
  constexpr int steps = 128;
  for (int k = 0; k < steps; ++k) {
    const double s = (k + 0.5) / steps;
    canvas.fill_rectangle(x + width * k / steps, y + 19, width / steps + 0.6, 12,
                          solid ? solid_colour(s) : water_colour(s));
  }
  const double lo = prefix.factor * range.lo, hi = prefix.factor * range.hi;
  for (const auto& [t, text] : text_ticks(lo, hi, width / 80)) {
    const double at = x + width * (t - lo) / (hi - lo);
    canvas.path({{at, y + 31}, {at, y + 35}}, {.colour = dark});
    canvas.text(at, y + 48, text, small, Align::centre);
  }
}

std::string time_text(double time) {
  const Prefix prefix = prefix_for(time, "s");
  return fmt::format("t = {:.5g} {}s", prefix.factor * time, prefix.text);
}

/// As much of a title as fits.
std::string fitted(Canvas& canvas, std::string text, double size, double width) {
  if (canvas.text_width(text, size, true) <= width) return text;
  while (!text.empty() && canvas.text_width(text + "…", size, true) > width) {
    while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80) text.pop_back();
    if (!text.empty()) text.pop_back();
  }
  return text + "…";
}

void draw_head(Canvas& canvas, const Scene& scene, double width) {
  const std::string time = time_text(scene.time);
  const double taken = canvas.text_width(time, large, true);
  canvas.text(width - right_margin, 26, time, large, Align::right, true);
  canvas.text(left_margin, 26,
              fitted(canvas, scene.title, large, width - left_margin - right_margin - taken - 24), large,
              Align::left, true);
  std::string second = scene.cut;
  if (scene.scale != 1)
    second +=
        fmt::format("{}deformation drawn {:g} times as large", second.empty() ? "" : "   ", scene.scale);
  if (!second.empty()) canvas.text(width - right_margin, 45, second, normal, Align::right);
}

}  // namespace

std::string draw(const Scene& scene, const DrawingOptions& options, Canvas::Kind kind) {
  const bool water_bar = !scene.water_field.shown.empty(), solid_bar = !scene.solid_field.shown.empty();
  Range water = scene.water_field.shown, solid = scene.solid_field.shown;
  if (options.range) {
    if (scene.water_field.name == options.field) water = *options.range;
    if (scene.solid_field.name == options.field) solid = *options.range;
  }
  if (options.water_range) water = *options.water_range;
  if (options.solid_range) solid = *options.solid_range;

  const double below = axis_height + (water_bar || solid_bar ? bar_height : 0);
  const View view = options.view ? *options.view : whole(scene);
  const PlotArea f = place(view, options, below);
  // Even, as films want it.
  const int height = options.height > 0
                         ? options.height
                         : 2 * static_cast<int>(std::ceil(0.5 * (top_margin + f.height + below)));

  Canvas canvas(kind, options.width, height, options.ratio);
  draw_head(canvas, scene, options.width);
  const bool many = scene.water.size() + scene.wall.size() + scene.solid.size() > most_shapes;
  const auto inside = [&] {
    many ? canvas.begin_image(f.x, f.y, f.width, f.height) : canvas.clip(f.x, f.y, f.width, f.height);
  };
  inside();
  for (const Mark& mark : scene.wall) {
    const Place p = f(mark.at);
    canvas.square(p.x, p.y, touching * radius_of(scene.spacing, f), grey);
  }
  draw_water(canvas, f, scene.water, scene.spacing, water);
  draw_cells(canvas, f, scene.air, water, false);
  draw_solid(canvas, f, scene.solid, scene.solid_spacing, solid);
  many ? canvas.end_image() : canvas.unclip();
  canvas.clip(f.x, f.y, f.width, f.height);
  draw_lines(canvas, f, scene.lines);
  draw_cells(canvas, f, scene.cells, solid, true);
  canvas.unclip();
  draw_axes(canvas, f);

  const double gap = 36, whole_width = options.width - left_margin - right_margin;
  const double bar = water_bar && solid_bar ? 0.5 * (whole_width - gap) : std::min(whole_width, 520.0);
  const double y = height - bar_height;
  if (water_bar) draw_bar(canvas, left_margin, y, bar, scene.water_field, water, false);
  if (solid_bar)
    draw_bar(canvas, left_margin + (water_bar ? bar + gap : 0), y, bar, scene.solid_field, solid, true);
  return canvas.finish();
}

}  // namespace strake::picture
