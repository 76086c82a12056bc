// The length of the projection beside bodies with oblique faces (fluid/THEORY.md (F74)).

#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace strake::fluid {
namespace projection_test {

constexpr double l0 = 0.01;

/// A body over the water: a box, or a trapezium that is wider above, with blunt lower corners.
InterfaceMesh body_over_water(double wider) {
  InterfaceMesh mesh = rectangle(-3 * l0, 3 * l0, 6 * l0, 2 * l0, l0);
  for (Eigen::Index k = 0; k < mesh.position.cols(); ++k)
    mesh.position(0, k) *= 1 + wider * (mesh.position(1, k) / l0 - 4);
  return mesh;
}

/// Pressures that alternate from particle to particle, in water on a lattice without gravity, after steps of
/// dt to the time l0/c. Returns the part of the alternation that is left at the middle of the water.
double left_of_alternation(const InterfaceMesh& mesh, double dt) {
  Parameters p = tank_case(24 * l0, 24 * l0, l0);
  p.gravity.setZero();
  p.scheme.negative_pressure = true;
  const Points none = Points::Zero(3, mesh.position.cols());
  Simulation<2> simulation(p, mesh, none);
  State<2> state = simulation.state();
  const auto sign = [&](std::int64_t i) {
    const auto place = [&](int d) { return std::lround(std::floor(state.position(d, i) / l0)); };
    return (place(0) + place(1)) % 2 == 0 ? 1.0 : -1.0;
  };
  std::vector<std::pair<std::int64_t, double>> middle;
  for (std::int64_t i = 0; i < state.position.cols(); ++i) {
    if (state.kind[static_cast<std::size_t>(i)] != Kind::fluid) continue;
    state.pressure[i] = 1e3 * sign(i);
    if (std::abs(state.position(0, i)) < 4 * l0 && std::abs(state.position(1, i) + 12 * l0) < 4 * l0)
      middle.emplace_back(state.id[static_cast<std::size_t>(i)], sign(i));
  }
  simulation.set_state(state);
  const auto steps = static_cast<int>(std::lround(l0 / p.sound_speed / dt));
  for (int k = 0; k < steps; ++k) simulation.step(dt, {none, none, none});
  double sum = 0;
  for (std::int64_t i = 0; i < state.position.cols(); ++i)
    for (const auto& [id, was] : middle)
      if (simulation.state().id[static_cast<std::size_t>(i)] == id)
        sum += was * simulation.state().pressure[i];
  return sum / (1e3 * static_cast<double>(middle.size()));
}

// One step of l0/c leaves 0.33 of them. Twenty steps of a twentieth leave 0.15 where a body has oblique
// faces, and 0.90 where the equation has the step's own length.
TEST(Projection, ShortStepsDampAlternatingPressuresAsAStepOfSoundDoes) {
  const double crossing = l0 / 1500;
  const InterfaceMesh oblique = body_over_water(0.2);
  const double one = left_of_alternation(oblique, crossing),
               many = left_of_alternation(oblique, crossing / 20);
  EXPECT_LT(std::abs(many), 0.25);
  EXPECT_LT(std::abs(many), one);
}

}  // namespace projection_test
}  // namespace strake::fluid
