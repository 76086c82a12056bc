#include "structure/case/keys.hpp"
#include "structure/mesh_files/stl_body.hpp"

#include <fmt/format.h>

#include <cmath>

namespace strake::structure {
namespace {

/// Tells how the triangles' size compares with the distance that the fluid wants.
void compare_sizes(ClosedSurface& surface, double spacing) {
  constexpr double far_finer = 3;  // lengths: nine points where one is enough
  Eigen::Index longer = 0;
  for (Eigen::Index t = 0; t < surface.outer; ++t)
    for (Eigen::Index k = 0; k < 3; ++k) {
      const int a = surface.triangle(k, t), b = surface.triangle((k + 1) % 3, t);
      if (a < b && (surface.point.col(a) - surface.point.col(b)).norm() > longest_edge * spacing) ++longer;
    }
  if (longer > 0)
    surface.lines.push_back(fmt::format("{} edges longer than {:g} surface_spacing ({:.4g} m): halved",
                                        longer, longest_edge, longest_edge * spacing));
  const double apart =
      std::sqrt(2 * outer_area(surface) / static_cast<double>(surface.outer));  // two triangles a point
  if (apart * far_finer < spacing)
    surface.lines.push_back(
        fmt::format("points are about {:.3g} m apart, far nearer than surface_spacing ({:.3g} m): a coarser "
                    "STL file costs less time",
                    apart, spacing));
}

}  // namespace

void read_surface_body(CaseTable t, Parameters& p, const std::filesystem::path& stl,
                       const Eigen::Matrix3d& map, const Eigen::Vector3d& move) {
  if (p.kind != "rigid" && p.kind != "replay")
    throw t.error("mesh",
                  fmt::format("a file with cells (.msh, .inp): an STL file holds a surface alone, and a {} "
                              "structure deforms",
                              p.kind),
                  "structure.solver = \"rigid\", or mesh the body's inside with Gmsh");
  if (p.dimension != 3)
    throw t.error("mesh", "a mesh of the plane: an STL file is a body in space, fluid.dimension is 2",
                  "fluid.dimension = 3, or structure.outline");
  for (const char* key : {"part", "support"})
    if (t.has(key))
      throw t.error(key, "nothing: an STL file has no names for parts and faces", "leave it out");
  ClosedSurface surface = read_stl_body(stl);
  surface.point = (map * surface.point).colwise() + move;
  compare_sizes(surface, p.surface_spacing);
  p.closed_surface = std::move(surface);
  p.shape.kind = ShapeKind::surface;
}

}  // namespace strake::structure
