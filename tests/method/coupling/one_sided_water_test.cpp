#include "coupler/coupling/scheme.hpp"
#include "tests/algebra/factors.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake {
namespace one_sided_water_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int points = 40;
constexpr double length = 0.4, spacing = length / points, window = 1e-5, speed = 6.26;

/// Half a space of incompressible water under a strip, as the added mass of its waves. It is ρ/k per area at
/// the wave number k. It pushes and does not pull.
struct Touch {
  VectorXd place, face, water;  // of the strip, its velocity, the water's under it
};
class OneSidedWater final : public models::Model<Touch> {
 public:
  explicit OneSidedWater(MatrixXd mass) : mass_(std::move(mass)) {
    const VectorXd zero = VectorXd::Zero(points);
    begin(models::line_of_points("fluid", points), {zero, VectorXd::Constant(points, -speed), zero});
  }

 private:
  Advanced step(const Window& w, const Input& input) override {
    const VectorXd x = models::y_of(input, "displacement");
    now_.face = 2 / w.dt * (x - now_.place) - now_.face;
    now_.place = x;
    const VectorXd force = (mass_ * (now_.water - now_.face) / w.dt).cwiseMax(0.0);
    now_.water -= w.dt * solution_of(mass_, force);
    Advanced advanced;
    advanced.output = {models::y_field("force", "N", force)};
    return advanced;
  }
  MatrixXd mass_;
};

/// Σ over the modes sin(nπx/L) of value(n) on the points, per point [kg or N/m].
template <class Value>
MatrixXd of_modes(Value value) {
  MatrixXd sum = MatrixXd::Zero(points, points);
  for (int n = 1; n <= points; ++n) {
    VectorXd mode(points);
    for (Index i = 0; i < points; ++i)
      mode[i] = std::sin(n * std::numbers::pi * (static_cast<double>(i) + 0.5) / points);
    sum += spacing * value(n) / mode.squaredNorm() * mode * mode.transpose();
  }
  return sum;
}

struct Count {
  double mean = 0;
  int most = 0, unconverged = 0;
};

/// A plate [kg/m²], pinned at its ends, 0.02 m of steel in stiffness, meets the water as a whole.
Count plate_on_water(double plate_mass) {
  const double stiffness = 2.1e11 * std::pow(0.02, 3) / (12 * (1 - 0.09));
  const auto wave = [](int n) { return n * std::numbers::pi / length; };
  const VectorXd v0 = VectorXd::Constant(points, -speed);
  OneSidedWater water(of_modes([&](int n) { return 1000 / wave(n); }));
  models::Oscillators plate(of_modes([&](int) { return plate_mass; }),
                            of_modes([&](int n) { return stiffness * std::pow(wave(n), 4); }),
                            VectorXd::Zero(points), v0, models::Rule::trapezoidal);
  SchemeParameters parameters;
  parameters.convergence = {1e-4, 1e-8, Measure::increment, 1, 20, Unconverged::accept};
  Scheme scheme(water, plate, nearest_neighbour(plate.mesh(), water.mesh()), parameters);
  constexpr int windows = 200;
  Count count;
  for (int w = 0; w < windows; ++w) {
    const WindowReport report = scheme.advance({w * window, window});
    scheme.commit(false);
    count.mean += report.iterations / static_cast<double>(windows);
    count.most = std::max(count.most, report.iterations);
    count.unconverged += report.converged ? 0 : 1;
  }
  return count;
}

// Where the water parts from the plate H has a kink. With columns from both sides of it, 64 of the light
// plate's windows and 2 of the heavy one's do not converge in 20 iterations.
TEST(OneSidedWater, ConvergesInEveryWindowThoughColumnsFromAcrossAKinkMislead) {
  for (const double mass : {156.0, 20.0}) {
    const Count count = plate_on_water(mass);
    fmt::print(
        "plate of {:5.0f} kg/m2 on water that cannot pull: mean {:.2f} iterations, at most {}, {} of 200 "
        "windows unconverged\n",
        mass, count.mean, count.most, count.unconverged);
    EXPECT_EQ(count.unconverged, 0);
  }
}

}  // namespace one_sided_water_test
}  // namespace strake
