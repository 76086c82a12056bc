#pragma once

#include "structure/body/parameters.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace strake::structure {

/// A bar 20 mm long and high (E 2 GPa, ρ 1000) of `layers` × `layers` cells between two blocks. The blocks
/// are four hundred times as heavy and a hundred times as stiff. The bar is notched from above and below in
/// its middle, down to a ligament of 10 mm.
///
/// Its columns of cells lean by `lean` [rad] where the crack runs. The notches stand one above the other, or
/// in one column of cells (`in_line`), which a crack can then follow. All of it is turned by `turn` [rad]
/// about the origin. This has no effect on its cells, and turns a lattice of particles against it.
inline Parameters notched_cells(FailureCriterion criterion, int layers, double lean = 0, double turn = 0,
                                bool in_line = false) {
  Parameters p;
  p.kind = "fem";
  p.shape.kind = ShapeKind::solid;
  p.material.young = 2e9;
  p.material.density = 1000;
  Material heavy = p.material;
  heavy.young *= 100;
  heavy.density *= 400;
  const double d = 0.02 / layers;
  const auto node = [&](int i, int j) {  // the lean fades towards the blocks
    const double x = i * d, y = j * d, fade = std::clamp(0.02 - 2 * std::abs(x - 0.01), 0.0, 0.01) / 0.01;
    return Eigen::Vector3d(x + std::tan(lean) * (y - 0.01) * fade, y, 0);
  };
  Solid& solid = p.solid;
  solid.dimension = 2;
  solid.parts = {{"bar", p.material, false}, {"blocks", heavy, false}};
  const int columns = 3 * layers;
  solid.node.resize(3, (columns + 1) * (layers + 1));
  for (int i = 0; i <= columns; ++i)
    for (int j = 0; j <= layers; ++j) solid.node.col(i * (layers + 1) + j) = node(i - layers, j);
  solid.cell.resize(4, columns * layers);
  Eigen::Index cells = 0;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < layers; ++j) {
      const int a = i * (layers + 1) + j, b = a + layers + 1;
      const Eigen::Vector3d middle =
          0.25 * (solid.node.col(a) + solid.node.col(a + 1) + solid.node.col(b) + solid.node.col(b + 1));
      const double off = middle.x() - 0.01 + 1e-6 * d;
      const bool notched = in_line ? i == layers + layers / 2 - 1 : off > -0.5 * d && off <= 0.5 * d;
      if (notched && std::abs(middle.y() - 0.01) > 0.005) continue;
      solid.cell.col(cells++) << a, b, a + 1, b + 1;
      solid.part_of.push_back(i < layers || i >= 2 * layers ? 1 : 0);
    }
  solid.cell.conservativeResize(4, cells);
  solid.node = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix() * solid.node;
  find_facets(solid);
  p.shape.corner = outer_polygons(solid).front();
  p.surface_spacing = 0.005;
  p.failure.criterion = criterion;
  p.failure.fracture_energy = 100;
  p.failure.strength = 2e6;
  return p;
}
inline constexpr double notched_ligament = 0.01;  // [m]

/// The squares of an axis-aligned lattice whose middles lie in a solid, as the solid that particles stand in.
inline Solid squares_in(const Solid& solid, double size) {
  const Eigen::Vector3d low = solid.node.rowwise().minCoeff(), high = solid.node.rowwise().maxCoeff();
  Solid squares;
  squares.dimension = 2;
  squares.parts = solid.parts;
  Eigen::Vector2i count;
  for (const int axis : {0, 1}) {
    count[axis] = static_cast<int>(std::ceil((high[axis] - low[axis]) / size));
    for (int k = 0; k <= count[axis]; ++k)
      squares.plane[static_cast<std::size_t>(axis)].push_back(low[axis] + k * size);
  }
  std::map<std::pair<int, int>, int> number;
  std::vector<Eigen::Vector3d> node;
  std::vector<int> cell;
  const auto corner = [&](int i, int j) {
    const auto [found, fresh] = number.emplace(std::pair(i, j), static_cast<int>(node.size()));
    if (fresh)
      node.emplace_back(squares.plane[0][static_cast<std::size_t>(i)],
                        squares.plane[1][static_cast<std::size_t>(j)], 0);
    return found->second;
  };
  for (int i = 0; i < count[0]; ++i)
    for (int j = 0; j < count[1]; ++j) {
      const int in = cell_at(solid, low + size * Eigen::Vector3d(i + 0.5, j + 0.5, 0), 1e-9);
      if (in < 0) continue;
      for (const auto& [x, y] : {std::pair(i, j), {i + 1, j}, {i, j + 1}, {i + 1, j + 1}})
        cell.push_back(corner(x, y));
      squares.part_of.push_back(solid.part_of[static_cast<std::size_t>(in)]);
    }
  squares.cell = Eigen::Map<Eigen::MatrixXi>(cell.data(), 4, static_cast<Eigen::Index>(cell.size() / 4));
  squares.node.resize(3, static_cast<Eigen::Index>(node.size()));
  for (std::size_t k = 0; k < node.size(); ++k) squares.node.col(static_cast<Eigen::Index>(k)) = node[k];
  find_facets(squares);
  return squares;
}

/// Velocity along the bar at x [m] of the bar before it is turned. The blocks fly apart with `speed`, and the
/// bar stretches evenly between them.
inline double pulled(double speed, double x) {
  return speed * std::clamp(100 * x - 1, -1.0, 1.0);
}

}  // namespace strake::structure
