#include "coupler/plot/canvas.hpp"

#include "proto/error.hpp"

#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake::picture {
namespace {

constexpr double finer = 2;  // pixels of an image per unit of an SVG

cairo_status_t keep(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

void choose_font(cairo_t* c, double size, bool bold) {
  cairo_select_font_face(c, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, size);
}

}  // namespace

Canvas::Kind kind_of(const std::filesystem::path& path, const std::string& option, const std::string& what,
                     const std::string& fix) {
  if (path.extension() == ".png") return Canvas::Kind::png;
  if (path.extension() == ".svg") return Canvas::Kind::svg;
  throw Error(ExitCode::command_line, option + " " + path.string(), what + " is a .png or an .svg",
              option + " " + fix);
}

struct Canvas::Parts {
  Kind kind = Kind::png;
  std::string bytes;
  cairo_surface_t* surface = nullptr;
  cairo_t* page = nullptr;
  cairo_surface_t* image = nullptr;  // between begin_image and end_image
  cairo_t* in_image = nullptr;
  double image_x = 0, image_y = 0;
  cairo_t* at() const { return in_image != nullptr ? in_image : page; }
  void colour(const Colour& c) const { cairo_set_source_rgb(at(), c.red, c.green, c.blue); }
  void walk(const std::vector<Place>& points) const {
    for (std::size_t i = 0; i < points.size(); ++i)
      i == 0 ? cairo_move_to(at(), points[i].x, points[i].y) : cairo_line_to(at(), points[i].x, points[i].y);
  }
};

Canvas::Canvas(Kind kind, int width, int height, double ratio) : parts_(std::make_unique<Parts>()) {
  parts_->kind = kind;
  parts_->surface = kind == Kind::png
                        ? cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(ratio * width),
                                                     static_cast<int>(ratio * height))
                        : cairo_svg_surface_create_for_stream(keep, &parts_->bytes, width, height);
  if (kind == Kind::svg) cairo_svg_surface_set_document_unit(parts_->surface, CAIRO_SVG_UNIT_PX);
  parts_->page = cairo_create(parts_->surface);
  if (cairo_status(parts_->page) != CAIRO_STATUS_SUCCESS)
    throw Error(ExitCode::command_line, "--size", cairo_status_to_string(cairo_status(parts_->page)),
                "a smaller picture, e.g. --size 1280x720");
  if (kind == Kind::png) cairo_scale(parts_->page, ratio, ratio);
  fill_rectangle(0, 0, width, height, {1, 1, 1});
}

Canvas::~Canvas() {
  if (parts_->in_image != nullptr) cairo_destroy(parts_->in_image);
  if (parts_->image != nullptr) cairo_surface_destroy(parts_->image);
  cairo_destroy(parts_->page);
  cairo_surface_destroy(parts_->surface);
}

void Canvas::fill_rectangle(double x, double y, double width, double height, const Colour& colour) {
  // Soft edges of squares that touch would let a grid of the background shine through.
  cairo_set_antialias(parts_->at(), CAIRO_ANTIALIAS_NONE);
  parts_->colour(colour);
  cairo_rectangle(parts_->at(), x, y, width, height);
  cairo_fill(parts_->at());
  cairo_set_antialias(parts_->at(), CAIRO_ANTIALIAS_DEFAULT);
}

void Canvas::dot(double x, double y, double radius, const Colour& colour) {
  parts_->colour(colour);
  cairo_arc(parts_->at(), x, y, radius, 0, 2 * std::numbers::pi);
  cairo_fill(parts_->at());
}

void Canvas::square(double x, double y, double half, const Colour& colour) {
  fill_rectangle(x - half, y - half, 2 * half, 2 * half, colour);
}

void Canvas::path(const std::vector<Place>& points, const Style& style, const std::string& /*title*/) {
  parts_->colour(style.colour);
  parts_->walk(points);
  if (style.filled) {
    cairo_close_path(parts_->at());
    cairo_fill_preserve(parts_->at());
  }
  // Edges in the colour of the inside, so that neighbours leave no gap; facets of an outline meet without a
  // notch.
  cairo_set_line_width(parts_->at(), style.filled ? 0.5 : style.width);
  cairo_set_line_cap(parts_->at(), style.dashes.empty() ? CAIRO_LINE_CAP_SQUARE : CAIRO_LINE_CAP_BUTT);
  cairo_set_line_join(parts_->at(), CAIRO_LINE_JOIN_ROUND);
  cairo_set_dash(parts_->at(), style.dashes.data(), static_cast<int>(style.dashes.size()), 0);
  cairo_stroke(parts_->at());
  cairo_set_dash(parts_->at(), nullptr, 0, 0);
}

void Canvas::circle(const Place& centre, double radius, const Style& style) {
  parts_->colour(style.colour);
  cairo_new_sub_path(parts_->at());
  cairo_arc(parts_->at(), centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
  cairo_set_line_width(parts_->at(), style.width);
  cairo_stroke(parts_->at());
}

void Canvas::text(double x, double y, const std::string& text, double size, Align align, bool bold) {
  cairo_save(parts_->at());
  parts_->colour({0.11, 0.13, 0.16});
  choose_font(parts_->at(), size, bold);
  const double width = align == Align::left ? 0 : text_width(text, size, bold);
  cairo_translate(parts_->at(), x, y);
  if (align == Align::upwards) cairo_rotate(parts_->at(), -0.5 * std::numbers::pi);
  cairo_move_to(parts_->at(), align == Align::right ? -width : -0.5 * width, 0);
  cairo_show_text(parts_->at(), text.c_str());
  cairo_restore(parts_->at());
}

double Canvas::text_width(const std::string& text, double size, bool bold) {
  choose_font(parts_->at(), size, bold);
  cairo_text_extents_t extents;
  cairo_text_extents(parts_->at(), text.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::clip(double x, double y, double width, double height) {
  cairo_save(parts_->at());
  cairo_rectangle(parts_->at(), x, y, width, height);
  cairo_clip(parts_->at());
}

void Canvas::unclip() {
  cairo_restore(parts_->at());
}

void Canvas::begin_image(double x, double y, double width, double height) {
  if (parts_->kind == Kind::png) return clip(x, y, width, height);
  parts_->image_x = x;
  parts_->image_y = y;
  parts_->image = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, static_cast<int>(std::ceil(finer * width)),
                                             static_cast<int>(std::ceil(finer * height)));
  parts_->in_image = cairo_create(parts_->image);
  cairo_scale(parts_->in_image, finer, finer);
  cairo_translate(parts_->in_image, -x, -y);
}

void Canvas::end_image() {
  if (parts_->kind == Kind::png) return unclip();
  cairo_destroy(parts_->in_image);
  parts_->in_image = nullptr;
  cairo_save(parts_->page);
  cairo_translate(parts_->page, parts_->image_x, parts_->image_y);
  cairo_scale(parts_->page, 1 / finer, 1 / finer);
  cairo_set_source_surface(parts_->page, parts_->image, 0, 0);
  cairo_paint(parts_->page);
  cairo_restore(parts_->page);
  cairo_surface_destroy(parts_->image);
  parts_->image = nullptr;
}

std::string Canvas::finish() {
  cairo_surface_flush(parts_->surface);
  if (parts_->kind == Kind::png)
    cairo_surface_write_to_png_stream(parts_->surface, keep, &parts_->bytes);
  else
    cairo_surface_finish(parts_->surface);
  return std::move(parts_->bytes);
}

namespace {

/// The transfer function of sRGB (IEC 61966-2-1).
double encoded(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

}  // namespace

// OKLab (B. Ottosson, 2020): cube roots of cone responses are linear in L, a, b.
Colour from_oklch(double lightness, double chroma, double hue) {
  const double angle = hue * std::numbers::pi / 180;
  const double a = chroma * std::cos(angle), b = chroma * std::sin(angle);
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

// The chroma stays inside what a screen shows: its bound is lowest, 0.098, at the blue-green of s = 0.4.
Colour water_colour(double s) {
  const double x = std::clamp(s, 0.0, 1.0), off = x < 0.4 ? (x - 0.4) / 0.4 : (x - 0.4) / 0.6;
  const double chroma = 0.095 + (x < 0.4 ? 0.045 : 0.085) * off * off;
  return from_oklch(0.28 + 0.62 * x, chroma, 300 - 195 * x);
}

Colour solid_colour(double s) {
  const double x = std::clamp(s, 0.0, 1.0);
  return from_oklch(0.30 + 0.62 * x, 0.10 + 0.32 * x * (1 - x), 330 + 120 * x);
}

}  // namespace strake::picture
