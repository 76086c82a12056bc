#include "structure/solver/sketch.hpp"

#include "structure/body/surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace strake::structure {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double width = 960, margin = 40, header = 84;  // [px]
constexpr double tallest = 560;                          // [px] of the body
constexpr Index most_marks = 40'000;  // cells or particles beyond which a drawing is only ink
constexpr std::array<const char*, 6> part_colour = {"#dfe7ef", "#f3e3cf", "#dcebdd",
                                                    "#eadff0", "#f2dcdc", "#e6e6d8"};

/// Places [m] to pixels: y upwards; z of a solid goes up and to the right (cabinet projection).
class View {
 public:
  View(const Box& box, bool solid) : solid_(solid) {
    Vector2d low = Vector2d::Constant(1e300), high = -low;
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d X((corner & 1) ? box.max.x() : box.min.x(), (corner & 2) ? box.max.y() : box.min.y(),
                       (corner & 4) ? box.max.z() : box.min.z());
      low = low.cwiseMin(flat(X));
      high = high.cwiseMax(flat(X));
    }
    const Vector2d size = high - low;
    scale_ = std::min((width - 2 * margin) / size.x(), tallest / size.y());
    low_ = low;
    height_ = header + scale_ * size.y() + 2 * margin;
    left_ = 0.5 * (width - scale_ * size.x());
  }
  Vector2d operator()(const Vector3d& X) const {
    const Vector2d x = flat(X) - low_;
    return {left_ + scale_ * x.x(), height_ - margin - scale_ * x.y()};
  }
  double scale() const { return scale_; }    // [px/m]
  double height() const { return height_; }  // [px]

 private:
  Vector2d flat(const Vector3d& X) const {
    return solid_ ? Vector2d(X.x() + 0.35 * X.z(), X.y() + 0.35 * X.z()) : Vector2d(X.head<2>());
  }
  bool solid_;
  double scale_ = 1, height_ = 0, left_ = 0;
  Vector2d low_;
};

class Svg {
 public:
  template <class... Value>
  void add(fmt::format_string<Value...> form, Value&&... value) {
    text_ += fmt::format(form, std::forward<Value>(value)...) + '\n';
  }
  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

std::string path(const View& view, const std::vector<Vector3d>& points, bool closed) {
  std::string d;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector2d x = view(points[i]);
    d += fmt::format("{}{:.2f} {:.2f}", i == 0 ? "M" : "L", x.x(), x.y());
  }
  return d + (closed ? "Z" : "");
}

/// A facet or quadrilateral as a closed walk.
std::vector<Vector3d> walk(const Points& node, const Eigen::MatrixXi& corners, Index column) {
  std::vector<Vector3d> points;
  for (Index k = 0; k < corners.rows(); ++k) points.emplace_back(node.col(corners(k, column)));
  return points;
}

std::vector<Vector3d> quadrilateral(const Solid& solid, Index c) {
  std::vector<Vector3d> corner;
  for (const Index k : {0, 1, 3, 2}) corner.emplace_back(solid.node.col(solid.cell(k, c)));
  return corner;
}

const char* colour_of(const Solid& solid, Index c) {
  const auto part = static_cast<std::size_t>(solid.part_of[static_cast<std::size_t>(c)]);
  return part_colour.at(part % part_colour.size());
}

void draw_parts(Svg& svg, const View& view, const Solid& solid) {
  if (solid.dimension == 2)
    for (Index c = 0; c < solid.cell.cols(); ++c)
      svg.add("<path d='{0}' fill='{1}' stroke='{1}' stroke-width='0.6'/>",
              path(view, quadrilateral(solid, c), true), colour_of(solid, c));
  else
    for (Index f = 0; f < solid.facet.cols(); ++f)
      svg.add("<path d='{}' fill='{}' fill-opacity='0.35' stroke='#8a94a0' stroke-width='0.8'/>",
              path(view, walk(solid.node, solid.facet, f), true),
              colour_of(solid, solid.facet_cell[static_cast<std::size_t>(f)]));
}

/// Cells of a frame, or its particles.
std::string draw_discretisation(Svg& svg, const View& view, const Frame& frame, const Parameters& p) {
  const Index cells = frame.cells.cols(), points = frame.position.cols();
  if (p.kind == "rigid" || p.kind == "replay") return "a rigid outline";
  if (cells > 0) {
    if (frame.cells.rows() == 4 && cells <= most_marks) {
      std::string all;
      for (Index c = 0; c < cells; ++c) all += path(view, walk(frame.position, frame.cells, c), true);
      svg.add("<path d='{}' fill='none' stroke='#5b6b7c' stroke-width='0.35'/>", all);
    }
    return fmt::format("mesh of {} nodes", points);
  }
  if (points <= most_marks && p.dimension == 2) {
    const double radius = std::max(0.8, 0.42 * p.particle.spacing * view.scale());
    svg.add("<g fill='#3d6f99' fill-opacity='0.75'>");
    for (Index i = 0; i < points; ++i) {
      const Vector2d x = view(frame.position.col(i));
      svg.add("<circle cx='{:.2f}' cy='{:.2f}' r='{:.2f}'/>", x.x(), x.y(), radius);
    }
    svg.add("</g>");
  }
  return fmt::format("{} particles, those of the clamps included", points);
}

void draw_surface(Svg& svg, const View& view, const InterfaceMesh& mesh) {
  std::string all;
  for (Index f = 0; f < mesh.faces.cols(); ++f)
    all += path(view, walk(mesh.position, mesh.faces, f), mesh.faces.rows() > 2);
  svg.add("<path d='{}' fill='none' stroke='#0a66c2' stroke-width='{}'/>", all,
          mesh.dimension == 2 ? 1.6 : 0.3);
  if (mesh.dimension == 3 || mesh.position.cols() > 4000) return;
  svg.add("<g fill='#0a66c2'>");
  for (Index i = 0; i < mesh.position.cols(); ++i) {
    const Vector2d x = view(mesh.position.col(i));
    svg.add("<circle cx='{:.2f}' cy='{:.2f}' r='1.7'/>", x.x(), x.y());
  }
  svg.add("</g>");
}

void draw_supports(Svg& svg, const View& view, const Solid& solid, double top) {
  std::array<int, 2> lines{};
  for (const SupportedFace& face : solid.supported) {
    if (face.support == Support::free) continue;
    const bool line = face.support == Support::pinned || face.support == Support::roller;
    const Vector2d middle = view(middle_of(solid, face));
    for (const int f : face.facet)
      svg.add("<path d='{}' fill='#c1440e' fill-opacity='0.25' stroke='#c1440e' stroke-width='{}'{}/>",
              path(view, walk(solid.node, solid.facet, f), solid.dimension == 3), line ? 1.5 : 4,
              face.support == Support::symmetry ? " stroke-dasharray='6 4'" : "");
    if (line) svg.add("<circle cx='{:.2f}' cy='{:.2f}' r='5' fill='#c1440e'/>", middle.x(), middle.y());
    // Names stand above the body; names of one half stand below each other.
    const bool right = middle.x() > 0.5 * width;
    int& line_number = lines[right ? 1 : 0];
    svg.add("<text x='{:.1f}' y='{:.1f}' text-anchor='{}' fill='#c1440e'>{}: {}</text>",
            right ? width - margin : margin, top - 10 - 14 * line_number++, right ? "end" : "start",
            face.name, support_names.at(static_cast<std::size_t>(face.support)));
  }
  for (Index c = 0; c < solid.cell.cols() && solid.dimension == 2; ++c)
    if (solid.part(c).constrained)
      svg.add("<path d='{}' fill='#c1440e' fill-opacity='0.3'/>", path(view, quadrilateral(solid, c), true));
}

/// A length of 1, 2 or 5 times a power of ten, about an eighth of the drawing or more.
double round_length(double whole) {
  const double raw = 0.12 * whole, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double m : {1.0, 2.0, 5.0})
    if (m * power >= raw) return m * power;
  return 10 * power;
}

}  // namespace

std::string picture(const Solver& solver, const Parameters& p) {
  const bool elastic = p.kind != "rigid" && p.kind != "replay";
  const Solid solid = elastic || p.shape.kind == ShapeKind::solid ? elastic_solid(p) : Solid{};
  const Frame frame = solver.frame();
  Box box = bounds(p);
  for (Index i = 0; i < frame.position.cols(); ++i) {  // particles of the clamps stand outside the span
    box.min = box.min.cwiseMin(frame.position.col(i));
    box.max = box.max.cwiseMax(frame.position.col(i));
  }
  const View view(box, p.dimension == 3);

  Svg svg;
  svg.add(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0:.0f}' height='{1:.0f}' viewBox='0 0 {0:.0f} "
      "{1:.0f}' "
      "font-family='sans-serif' font-size='12'>",
      width, view.height());
  svg.add("<rect width='100%' height='100%' fill='white'/>");
  draw_parts(svg, view, solid);
  const std::string what = draw_discretisation(svg, view, frame, p);
  draw_surface(svg, view, solver.interface());
  if (!solid.empty()) draw_supports(svg, view, solid, view(box.max).y());
  svg.add("<text x='{}' y='24' font-size='16' font-weight='bold' fill='#222'>{}</text>", margin, p.kind);
  svg.add("<text x='{}' y='44' fill='#444'>{}; wet surface of {} points</text>", margin, what,
          solver.interface().position.cols());
  const double length = round_length((box.max - box.min).x()), px = length * view.scale();
  svg.add("<path d='M{0:.1f} 30v8m0 -4h{1:.1f}m0 -4v8' stroke='#222' fill='none'/>", width - margin - px, px);
  svg.add("<text x='{:.1f}' y='24' text-anchor='middle' fill='#222'>{:g} m</text>", width - margin - 0.5 * px,
          length);
  svg.add("</svg>");
  return std::move(svg).text();
}

}  // namespace strake::structure
