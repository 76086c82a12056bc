#pragma once

#include "fluid/mps/pressure_equation.hpp"
#include "fluid/pressure_solver/poisson_solver.hpp"
#include "tests/fluid/lattice.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

namespace strake::fluid {

/// Particles and the pressure equation on them, given by their places and the particles with P = 0: spacing 1
/// m.
template <int dim>
struct PressureCase {
  Vectors<dim> position;
  std::vector<Row> row;
  double radius = 3.1, sound_speed = std::numeric_limits<double>::infinity();
  Periodic<dim> space;
  KeepPair keep;  // empty: all pairs
  std::vector<std::uint8_t> tag;

  explicit PressureCase(Vectors<dim> places)
      : position(std::move(places)), row(static_cast<std::size_t>(position.cols()), Row::unknown) {}

  /// The right side is noise.
  PressureSystem assemble() const {
    NeighbourSearch<dim> search(radius, 0, space);
    const Neighbours& rows = search.update(position, tag, keep);
    const auto n = position.cols();
    Eigen::VectorXd divergence(n);
    std::mt19937 generator(11);
    std::uniform_real_distribution<double> noise(-1, 1);
    for (Eigen::Index i = 0; i < n; ++i) divergence[i] = noise(generator);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(n), density = Eigen::VectorXd::Constant(n, 1000);
    Scheme scheme;
    scheme.source = Source::divergence;
    PressureSystem system;
    assemble_pressure<dim>(rows, {row, divergence, zero, zero, density, 1000, sound_speed, 1e-3}, scheme,
                           lattice_constants<dim>(radius, 1), system);
    return system;
  }
};

/// Places in any order.
template <int dim>
Vectors<dim> shuffled(const Vectors<dim>& places, unsigned seed = 3) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(places.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  Vectors<dim> out(dim, places.cols());
  for (Eigen::Index i = 0; i < places.cols(); ++i)
    out.col(i) = places.col(order[static_cast<std::size_t>(i)]);
  return out;
}

/// A tank of side^dim particles, moved by up to a tenth of the spacing. P = 0 is prescribed on its top layer
/// alone, which is the hardest case.
template <int dim>
PressureCase<dim> tank(int side, double radius) {
  PressureCase<dim> c(block<dim>(side, 1, 0.1));
  c.radius = radius;
  constexpr int up = dim == 2 ? 1 : 2;  // the slowest axis of `block`
  for (Eigen::Index i = 0; i < c.position.cols(); ++i)
    if (c.position(up, i) > 0.5 * (side - 1) - 0.5) c.row[static_cast<std::size_t>(i)] = Row::zero;
  return c;
}

}  // namespace strake::fluid
