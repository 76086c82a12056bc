#pragma once

#include "fluid/viscosity/viscous_stage.hpp"

#include <cmath>
#include <random>

namespace strake::fluid {

/// Water between two walls, y from 0 to 1 m, periodic along x. It is a lattice whose particles are moved at
/// random by up to `disorder` spacings, with three layers of particles behind each wall.
struct Channel {
  static constexpr int along = 16, rows = 3;
  double l0;
  std::int64_t water;
  Vectors<2> position, velocity;
  WallLayers<2> walls;
  Periodic<2> periodic;
  NeighbourSearch<2> search;
  const Neighbours* near;
  Parameters parameters;
  Eigen::VectorXd k;
  ViscousStage<2> stage;

  explicit Channel(int across, double disorder = 0, bool slip = false)
      : l0(1.0 / across),
        water(std::int64_t{along} * across),
        position(2, water + 2 * rows * along),
        velocity(Vectors<2>::Zero(2, position.cols())),
        periodic(Vector<2>(along * l0, 0)),
        search(2.1 * l0, 0, periodic),
        k(Eigen::VectorXd::Zero(position.cols())) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> shift(-disorder, disorder);
    for (std::int64_t i = 0; i < water; ++i) {
      const Vector<2> cell(static_cast<double>(i % along) + 0.5, static_cast<double>(i / along) + 0.5);
      const double aside = disorder > 0 ? shift(generator) : 0, up = disorder > 0 ? shift(generator) : 0;
      position.col(i) = periodic.wrap(l0 * (cell + Vector<2>(aside, up)), Vector<2>::Zero());
    }
    walls.resize(water, position.cols() - water);
    for (std::int64_t w = 0; w < walls.size(); ++w) {
      const bool top = w >= rows * along;
      const std::int64_t row = w / along % rows;
      walls.depth[w] = (static_cast<double>(row) + 0.5) * l0;
      walls.normal(1, w) = top ? -1 : 1;
      walls.slip[static_cast<std::size_t>(w)] = slip;
      if (row > 0)
        walls.master[static_cast<std::size_t>(w)] = static_cast<std::int32_t>(water + w - row * along);
      position.col(water + w) << (static_cast<double>(w % along) + 0.5) * l0,
          top ? 1 + walls.depth[w] : -walls.depth[w];
    }
    near = &search.update(position);
    parameters.spacing = l0;
    parameters.kinematic_viscosity = 1;
    parameters.scheme.turbulence = Turbulence::none;
    parameters.scheme.gradient = Gradient::corrected;
  }
  double y(std::int64_t i) const { return position(1, i); }
  const Vectors<2>& acceleration(double dt = 0) {
    stage.compute(parameters, {position, velocity, *near, *near, walls, {}, {}, periodic}, dt, k);
    return stage.acceleration;
  }
};

}  // namespace strake::fluid
