#pragma once

#include "structure/body/parameters.hpp"

#include <cmath>

namespace strake::structure {

/// Turek and Hron's flag, 0.35 m × 0.02 m behind a cylinder of radius 0.05 m at (0.2, 0.2). It has along ×
/// through cells, its left end on the cylinder, with smaller cells towards it.
inline Parameters flag(int along, int through) {
  Parameters p;
  p.shape.kind = ShapeKind::solid;
  Solid& solid = p.solid;
  const int row = along + 1;
  solid.node = Points::Zero(3, row * (through + 1));
  for (int j = 0; j <= through; ++j) {
    const double y = 0.19 + 0.02 * j / through, left = 0.2 + std::sqrt(0.05 * 0.05 - (y - 0.2) * (y - 0.2));
    for (int i = 0; i <= along; ++i) {
      const double s = static_cast<double>(i) / along, graded = (s + 2 * s * s) / 3;
      solid.node.col(j * row + i) << left + graded * (0.6 - left), y, 0;
    }
  }
  solid.cell.resize(4, along * through);
  for (int j = 0; j < through; ++j)
    for (int i = 0; i < along; ++i) {
      const int n = j * row + i;
      solid.cell.col(j * along + i) << n, n + 1, n + row, n + row + 1;
      solid.part_of.push_back(0);
    }
  solid.parts = {{"flag", {.density = 1000, .young = 1.4e6, .poisson = 0.4}, false}};
  find_facets(solid);
  SupportedFace clamp{"cylinder", Support::clamped, {}};
  for (int f = 0; f < solid.facet.cols(); ++f)
    if (solid.facet(0, f) % row == 0 && solid.facet(1, f) % row == 0) clamp.facet.push_back(f);
  solid.supported = {clamp};
  p.shape.corner = outer_polygons(solid).front();
  p.surface_spacing = 0.02;
  p.gravity = {0, -2, 0};
  return p;
}

}  // namespace strake::structure
