#pragma once

#include "fluid/parameters/parameters.hpp"
#include "proto/interface.hpp"
#include "structure/body/shape.hpp"
#include "structure/body/solid_surface.hpp"
#include "structure/body/surface.hpp"

#include <Eigen/Core>

namespace strake::fluid {

/// A box with its lower face's middle at `foot`, of triangles about `spacing` long.
inline InterfaceMesh box_surface(const Eigen::Vector3d& foot, const Eigen::Vector3d& size, double spacing) {
  const double left = foot.x() - 0.5 * size.x(), right = foot.x() + 0.5 * size.x();
  const InterfaceMesh outline = structure::outline(
      {{left, foot.y()}, {right, foot.y()}, {right, foot.y() + size.y()}, {left, foot.y() + size.y()}},
      spacing);
  return structure::prism_surface(outline, size.z(), foot.z(), spacing);
}

/// A round disc with an upright axis, its lower face at y = low.
inline InterfaceMesh disc_surface(double radius, double low, double thickness, double spacing) {
  const InterfaceMesh outline =
      structure::outline(structure::circle_polygon({0, 0}, radius, spacing), spacing);
  InterfaceMesh mesh = structure::prism_surface(outline, thickness, low + 0.5 * thickness, spacing);
  const Points lying = mesh.position;  // the axis z becomes y
  mesh.position.row(1) = lying.row(2);
  mesh.position.row(2) = -lying.row(1);
  return mesh;
}

/// Still water of width × depth × width, its surface at y = 0, with `above` of free wall.
inline Parameters basin(double width, double depth, double spacing, double above) {
  Parameters p;
  p.dimension = 3;
  p.spacing = spacing;
  p.tank = {{-0.5 * width, -depth, -0.5 * width}, {0.5 * width, above, 0.5 * width}};
  p.water = {p.tank.min, {0.5 * width, 0, 0.5 * width}};
  p.threads = 1;
  return p;
}

}  // namespace strake::fluid
