// Elastic particles in time, against beam and wave theory (cases/VALIDATION.md, "Oscillating plate" and "Wave
// in a bar"). Also convergence with the layers.
#include "structure/particle/solver.hpp"
#include "tests/method/structure/decrement.hpp"
#include "tests/structure/notched_cells.hpp"
#include "tests/structure/paper_plate.hpp"
#include "tests/structure/pulled_bar.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace strake::structure {
namespace particle_motion_test {

double order(double coarse, double fine) {
  return std::log2(std::abs(coarse) / std::abs(fine));
}

// cases/VALIDATION.md, "Strips: deflection and frequencies": clamped strip 0.4 × 0.02 m, 4.462e-5 m under 1e5
// Pa and 687.8 Hz. With α = 0.1 the bonds' own error shows (47, 40, 9.3, 2.3 % of the deflection); α = 1
// stiffens by about as much as the lattice softens.
TEST(ParticleConvergence, ClampedStripConvergesWithItsLayers) {
  for (const double hourglass : {0.1, 1.0}) {
    std::vector<double> deflection, frequency;
    for (const int layers : {2, 4, 8, 16}) {
      Parameters p = paper_plate(layers);
      p.particle.hourglass = hourglass;
      p.load.kind = LoadKind::traction;
      p.load.value = {0, -1e5, 0};
      ParticleSolver<2> solver(p);
      frequency.push_back(solver.frequencies(1).at(0) / 687.8 - 1);
      solver.solve_static();
      deflection.push_back(-solver.displacement_at({0, 0.01, 0}).y() / 4.462e-5 - 1);
      const std::string at = std::to_string(layers) + (hourglass < 1 ? "_soft" : "_stiff");
      RecordProperty("deflection_" + at, std::to_string(deflection.back()));
      RecordProperty("frequency_" + at, std::to_string(frequency.back()));
    }
    if (hourglass < 1) {
      EXPECT_GT(order(deflection[1], deflection[2]), 1.5);
      EXPECT_GT(order(deflection[2], deflection[3]), 1.5);
      EXPECT_GT(order(frequency[1], frequency[2]), 1.5);
      EXPECT_GT(order(frequency[2], frequency[3]), 1.5);
    } else {  // 1 % and less from four layers on: no order to be read from
      for (const std::size_t k : {1U, 2U, 3U}) {
        EXPECT_LT(std::abs(deflection[k]), 0.015);
        EXPECT_LT(std::abs(frequency[k]), 0.01);
      }
      EXPECT_LT(std::abs(deflection[3]), 0.003);
    }
  }
}

// cases/VALIDATION.md, "Oscillating plate": 0.2 × 0.02 m clamped at x = 0, K = 3.25 MPa, G = 0.715 MPa, v_y =
// 0.01 c0 f(x)/f(L), f the first mode of a cantilever. Period 0.2552 s of plane strain (thin theory 0.25413),
// no loss.
TEST(ParticleMotion, OscillatingPlateHasItsPeriodAndLosesNothing) {
  constexpr double length = 0.2, kL = 1.875104, k = kL / length, c0 = 57.009;
  Parameters p = paper_plate(4);
  p.plate.length = length;
  p.plate.bottom = {0.5 * length, 0, 0};
  p.plate.right = Support::free;
  p.material.young = 1.99845e6;
  p.material.poisson = 0.39752;
  p.material.density = 1000;
  ParticleSolver<2> solver(p);
  const auto mode = [](double x) {
    return (std::cos(kL) + std::cosh(kL)) * (std::cosh(k * x) - std::cos(k * x)) +
           (std::sin(kL) - std::sinh(kL)) * (std::sinh(k * x) - std::sin(k * x));
  };
  Vectors<2> v = Vectors<2>::Zero(2, solver.lattice().size());
  for (Eigen::Index i = 0; i < v.cols(); ++i)
    v(1, i) = 0.01 * c0 * mode(std::max(0.0, solver.lattice().position(0, i))) / mode(length);
  solver.set_velocity(v);
  std::vector<double> crossing, amplitude;
  double before = 0, peak = 0;
  const double dt = 1e-3;
  for (int n = 0; n < 1500 && crossing.size() < 11; ++n) {
    solver.advance(n * dt, dt, {});
    const double now = solver.displacement_at({length, 0.01, 0}).y();
    peak = std::max(peak, std::abs(now));
    if (n > 0 && before * now < 0) {
      crossing.push_back((n + 1) * dt - dt * now / (now - before));
      amplitude.push_back(peak);
      peak = 0;
    }
    before = now;
  }
  ASSERT_EQ(crossing.size(), 11U);
  const double period = (crossing.back() - crossing.front()) / 5;
  RecordProperty("period", std::to_string(period));
  EXPECT_NEAR(period, 0.2552, 0.02 * 0.2552);  // required: 5 %; measured: -0.4 %
  // 250 samples a period, and higher modes that come and go; a loss would add up.
  EXPECT_GT(amplitude.back(), 0.98 * amplitude[1]);
}

// δ = 2πζ/√(1 − ζ²), ζ = a/(2ω).
TEST(ParticleMotion, DampingByMassTakesItsLogarithmicDecrement) {
  Parameters p;
  p.kind = "particle";
  p.plate = {.length = 0.1,
             .thickness = 0.02,
             .bottom = {0, 0, 0},
             .left = Support::clamped,
             .right = Support::free};
  p.particle.spacing = 0.01;
  const double omega = 2 * std::numbers::pi * ParticleSolver<2>(p).frequencies(1).front();
  constexpr double ratio = 0.02;
  p.damping.mass = 2 * ratio * omega;
  ParticleSolver<2> solver(p);
  Vectors<2> velocity = Vectors<2>::Zero(2, solver.lattice().size());
  for (Eigen::Index i = 0; i < velocity.cols(); ++i)  // about as the first mode
    velocity(1, i) = 1e-3 * std::pow(solver.lattice().position(0, i) + 0.05, 2);
  solver.set_velocity(velocity);
  const double measured = decrement_over_theory(solver, omega, ratio, {0.045, 0.01, 0});
  RecordProperty("decrement_over_theory", std::to_string(measured));
  EXPECT_NEAR(measured, 1, 0.01);
}

// A step of pressure on the end of a steel bar, ν = 0 (cases/VALIDATION.md, "Wave in a bar"). The front runs
// with √(E/ρ); behind it the steel moves with σ/(ρc), and the far end with twice that. Then 1e4 steps under
// that load.
TEST(ParticleMotion, AStepOfPressureRunsThroughABarAndIsReflected) {
  constexpr double length = 0.4, stress = 1e6, dt = 1e-7;
  Parameters p = paper_plate(8);
  p.plate.left = p.plate.right = Support::free;
  p.plate.bottom = {0.5 * length, 0, 0};
  p.material.poisson = 0;
  p.load.kind = LoadKind::traction;
  p.load.face = "left";
  p.load.value = {stress, 0, 0};
  ParticleSolver<2> solver(p);
  const double c = std::sqrt(p.material.young / p.material.density),
               speed = stress / (p.material.density * c);
  const auto v = [&](double x) { return solver.velocity_at({x, 0.01, 0}).x(); };
  const double near = 0.1, far = 0.3;
  double arrival[2] = {0, 0}, before[2] = {0, 0}, plateau = 0, reflected = 0;
  int samples[2] = {0, 0};
  double t = 0;
  for (int n = 0; n < 1000; ++n) {
    solver.advance(t, dt, {});
    t += dt;
    for (const int k : {0, 1}) {
      const double now = v(k == 0 ? near : far);
      if (arrival[k] == 0 && now > 0.5 * speed) arrival[k] = t - dt * (now - 0.5 * speed) / (now - before[k]);
      before[k] = now;
    }
    if (t * c > 0.25 && t * c < 0.35) {  // the front is past 0.1 m, its reflection is not back
      plateau += v(near);
      ++samples[0];
    }
    if (t * c > 0.44 && t * c < 0.5) {
      reflected += v(length);
      ++samples[1];
    }
  }
  const double front = (far - near) / (arrival[1] - arrival[0]);
  RecordProperty("front_over_c", std::to_string(front / c));
  EXPECT_NEAR(front, c, 0.01 * c);
  // Means over the ripple that any lattice leaves behind a sharp front.
  EXPECT_NEAR(plateau / samples[0], speed, 0.01 * speed);
  EXPECT_NEAR(reflected / samples[1], 2 * speed, 0.03 * 2 * speed);
  double worst = 0;
  for (const int start = solver.steps(); solver.steps() < start + 10000;) {
    solver.advance(t, 1e-5, {});
    t += 1e-5;
    const Energy e = solver.energy();
    worst = std::max(worst, std::abs(e.kinetic + e.strain - e.external) / e.external);
  }
  RecordProperty("drift", std::to_string(worst));
  EXPECT_LT(worst, 1e-3);
}

// A notched bar is drawn apart: what its softening dissipates is G_c times the ligament on any lattice.
// Measured 0.97 and 1.00 at 8 and 16 layers, 0.98 and 1.03 at twice the speed of the blocks; at four times it
// the bar softens away from its notch too.
TEST(ParticleMotion, ANotchedBarTakesItsFractureEnergyInOneStraightCrack) {
  for (const int layers : {8, 16})
    for (const double speed : {0.25, 0.5}) {
      const Parameters p = pulled_bar(FailureCriterion::max_principal, layers);
      ParticleSolver<2> solver(p);
      pull_apart(solver, speed);
      const double dt = 2e-5 * 0.25 / speed;
      for (int k = 0; k < 40; ++k) solver.advance(k * dt, dt, {});
      const double ratio = solver.energy().released / (p.failure.fracture_energy * ligament(layers));
      RecordProperty("released_" + std::to_string(layers) + (speed < 0.4 ? "_slow" : "_fast"),
                     std::to_string(ratio));
      EXPECT_NEAR(ratio, 1, 0.10) << layers << " layers, " << speed << " m/s";
      // (1, 0), (1, ±1) and (2, 0) bonds over the ligament's layers: no other broke.
      const int rows = layers - 4;
      EXPECT_EQ(solver.monitor().at("failure.bonds"), rows + 2 * (rows - 1) + 2 * rows);
    }
}

// The pair model has no softening, so that the bar stores three times G_c when its crack runs. Until the bar
// has parted, the crack dissipates G_c (0.95 and 1.05 at 8 and 12 layers). The rest vibrates on, undamped,
// and later damages the faces of the crack at 12 layers.
TEST(ParticleMotion, ThePairModelsCrackTakesItsFractureEnergy) {
  for (const int layers : {8, 12}) {
    const Parameters p = pulled_bar(FailureCriterion::bond_strain, layers);
    ParticleSolver<2> solver(p);
    pull_apart(solver, 0.25);
    for (int k = 0; k < 60 && !solver.monitor().contains("failure.parted.time"); ++k)
      solver.advance(k * 5e-6, 5e-6, {});
    const double ratio = solver.energy().released / (p.failure.fracture_energy * ligament(layers));
    RecordProperty("pair_released_" + std::to_string(layers), std::to_string(ratio));
    EXPECT_NEAR(ratio, 1, 0.10) << layers << " layers";
    EXPECT_NEAR(solver.monitor().at("failure.parted.x"), 0.01, p.particle.spacing);
  }
}

// The lattice is turned against the bar. Energy and largest load stay within 20 % of one another (measured 5
// %), and the crack stays in the notch, 2.5 mm wide. Steps in the sides and notches of the turned bar are the
// lattice's.
TEST(ParticleMotion, ACrackDoesNotCareForTheLatticesOrientation) {
  double least[2] = {1e9, 1e9}, most[2] = {0, 0};
  for (const double degrees : {0.0, 15.0, 30.0, 45.0}) {
    constexpr double d = 0.00125, speed = 0.25, dt = 2e-5;
    const double turn = degrees * std::numbers::pi / 180;
    Parameters p = notched_cells(FailureCriterion::max_principal, 8, 0, turn);
    p.kind = "particle";
    p.solid = squares_in(p.solid, d);
    p.particle.spacing = d;
    const Eigen::Rotation2Dd turned(turn);
    p.shape.corner.clear();  // no load comes from outside: the surface may lie within a block
    for (const auto& [x, y] : {std::pair(-0.015, 0.005), {-0.005, 0.005}, {-0.005, 0.015}, {-0.015, 0.015}})
      p.shape.corner.push_back(turned * Eigen::Vector2d(x, y));
    p.surface_spacing = 0.02;
    ParticleSolver<2> solver(p);
    const Eigen::Vector2d along = turned * Eigen::Vector2d(1, 0);
    Vectors<2> v(2, solver.lattice().size());
    for (Eigen::Index i = 0; i < v.cols(); ++i)
      v.col(i) = pulled(speed, along.dot(solver.lattice().position.col(i))) * along;
    solver.set_velocity(v);
    // What draws on the crack's plane is what the half beyond it loses of its momentum.
    const auto momentum = [&] {
      const Eigen::MatrixXd velocity = solver.frame().point_data.at(1).value;
      double sum = 0;
      for (Eigen::Index i = 0; i < v.cols(); ++i)
        if (along.dot(solver.lattice().position.col(i)) > 0.01)
          sum += solver.lattice().material(i).density * d * d * along.dot(velocity.col(i).head<2>());
      return sum;
    };
    double load = 0, before = momentum();
    for (int k = 0; k < 20; ++k) {
      solver.advance(k * dt, dt, {});
      const double now = momentum();
      load = std::max(load, (before - now) / dt / (p.failure.strength * notched_ligament));
      before = now;
    }
    const double measured[2] = {solver.energy().released / (p.failure.fracture_energy * notched_ligament),
                                load};
    const std::string at = std::to_string(static_cast<int>(degrees));
    RecordProperty("turned_energy_" + at, std::to_string(measured[0]));
    RecordProperty("turned_load_" + at, std::to_string(measured[1]));
    EXPECT_NEAR(measured[0], 1, 0.10) << degrees;
    for (const int k : {0, 1}) {
      least[k] = std::min(least[k], measured[k]);
      most[k] = std::max(most[k], measured[k]);
    }
    const Frame frame = solver.frame();
    for (Eigen::Index i = 0; i < v.cols(); ++i)
      if (frame.point_data.back().value(0, i) == 1) {
        EXPECT_NEAR(along.dot(solver.lattice().position.col(i)), 0.00875, 2 * d) << degrees;
      }
  }
  EXPECT_LT(most[0] / least[0], 1.2);
  EXPECT_LT(most[1] / least[1], 1.2);
}

}  // namespace particle_motion_test
}  // namespace strake::structure
