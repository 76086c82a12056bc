#include "fluid/boundary/packing.hpp"

#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"

#include <algorithm>
#include <cmath>

namespace strake::fluid {
namespace {

constexpr double packed_depth = 8;  // [l0] of the places that may move
constexpr double radius = 3.1;      // [l0] of the concentration
constexpr int most_rounds = 300;

/// Returns the middles of the cells beside the tank's bounding box that lie above an open side.
std::vector<Vector<2>> lid(const TankShape<2>& tank, double spacing) {
  const long reach = static_cast<long>(std::ceil(radius));
  const long nx = std::lround((tank.high()[0] - tank.low()[0]) / spacing),
             ny = std::lround((tank.high()[1] - tank.low()[1]) / spacing);
  std::vector<Vector<2>> rows;
  for (long y = -reach; y < ny + reach; ++y)
    for (long x = -reach; x < nx + reach; ++x) {
      if (x >= 0 && x < nx && y >= 0 && y < ny) continue;
      const Vector<2> place =
          tank.low() + spacing * Vector<2>(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
      if (tank.contains(place)) rows.push_back(place);
    }
  return rows;
}

}  // namespace

void pack(std::vector<Vector<2>>& places, const TankShape<2>& tank, const WallParticles<2>& walls,
          double spacing, double level) {
  // The places that move come first, then the fixed ones around them.
  const auto distance = [&](const Vector<2>& x) { return tank.distance_to_slanted(x); };
  const auto moving = std::stable_partition(
      places.begin(), places.end(), [&](const Vector<2>& x) { return distance(x) < packed_depth * spacing; });
  const auto movers = static_cast<Eigen::Index>(moving - places.begin());
  std::vector<Vector<2>> all(places.begin(), moving);
  const auto stand = [&](const Vector<2>& x) {
    if (distance(x) < (packed_depth + radius + 2) * spacing) all.push_back(x);
  };
  std::for_each(moving, places.end(), stand);
  for (const Vector<2>& x : lid(tank, spacing)) stand(x);
  for (const auto& wall : walls.wall) stand(wall.position);
  for (const auto& dummy : walls.dummy) stand(dummy.position);
  Vectors<2> position(2, static_cast<Eigen::Index>(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i) position.col(static_cast<Eigen::Index>(i)) = all[i];

  const LatticeConstants lattice = lattice_constants<2>(radius, spacing);
  NeighbourSearch<2> search(lattice.radius, 0.5 * spacing);
  for (int round = 0; round < most_rounds; ++round) {
    const Neighbours& near = search.update(position);
    Vectors<2> move(2, movers);
#pragma omp parallel for schedule(static)
    for (Eigen::Index i = 0; i < movers; ++i) {
      const auto columns = near.row(i);
      const auto inverses = near.inverses(i);
      Vector<2> concentration = Vector<2>::Zero();
      for (std::size_t e = 0; e < columns.size(); ++e)
        concentration += (lattice.radius * inverses[e] - 1) * inverses[e] * inverses[e] *
                         (position.col(columns[e]) - position.col(i));
      Vector<2> step = -packing_strength * spacing * spacing * 2 / lattice.n0 * concentration;
      if (std::abs(position(1, i) - level) < level_row * spacing) step[1] = 0;
      if (const double length = step.norm(); length > longest_move * spacing)
        step *= longest_move * spacing / length;
      move.col(i) = step;
    }
    position.leftCols(movers) += move;
    if (movers == 0 || move.colwise().norm().maxCoeff() < settled_move * spacing) break;
  }
  for (Eigen::Index i = 0; i < movers; ++i) places[static_cast<std::size_t>(i)] = position.col(i);
}

}  // namespace strake::fluid
