#pragma once

// What bodies on moving supports must do, whatever solver they have: `Body` is FemSolver<2> or
// ParticleSolver<2>.
#include "structure/solver.hpp"
#include "tests/structure/paper_plate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake::structure {

/// The plate clamped to a frame of its own mass, and both fall at 2 m/s. An upward force on its surface, as
/// of water, stops them.
inline Parameters dropped_plate() {
  Parameters p = paper_plate(4);
  p.free.y = true;
  p.body.lumped_mass = 62.4;
  p.velocity = {0, -2, 0};
  p.gravity = {0, -9.81, 0};
  p.fem.refinement = 1;
  return p;
}

inline Load upward(const InterfaceMesh& mesh, double force) {
  Points f = Points::Zero(3, mesh.position.cols());
  f.row(1).setConstant(force / static_cast<double>(f.cols()));
  return Load({Sample{0, {{"force", "N", true, f}}}});
}

// Momentum of body and frame changes by exactly the impulse of force and weight; energy by their work.
template <class Body>
void expect_a_drop_to_keep_momentum_and_energy(const Parameters& p, double energy_tolerance) {
  Body body(p);
  constexpr double dt = 1e-5, force = 3e5, mass = 2 * 62.4;
  const double start = body.momentum().y();
  EXPECT_NEAR(start, -2 * mass, 1e-9);
  const double energy = body.energy().kinetic;
  const Load load = upward(body.interface(), force);
  double drift = 0, bent = 0, impulse = 0;
  for (int k = 0; k < 150; ++k) {
    const bool pushed = k < 100;
    body.advance(k * dt, dt, pushed ? load : Load());
    impulse += dt * ((pushed ? force : 0) - 9.81 * mass);
    EXPECT_NEAR(body.momentum().y() - start, impulse, 1e-10 * 2 * mass);
    const Energy e = body.energy();
    drift = std::max(drift, std::abs(e.kinetic + e.strain - e.external - energy));
    bent = std::max(bent, body.displacement_at({0, 0.01, 0}).y() - body.support_displacement()->y());
  }
  EXPECT_LT(drift, energy_tolerance * energy);
  EXPECT_GT(bent, 1e-5) << "the plate bends against its frame";
  EXPECT_GT(body.monitor().at("support.vy"), -1.8) << "the frame is slowed down";
  EXPECT_LT(body.monitor().at("support.vy"), 2);
}

// Supports that take up an acceleration over many periods bend the body as its weight would.
template <class Body>
void expect_acceleration_to_bend_like_weight(Parameters p) {
  constexpr double g = 1000, rise = 0.012, end = 0.013, dt = 2e-5;
  Parameters held = p;
  held.gravity = {0, -g, 0};
  Body at_rest(held);
  at_rest.solve_static();
  const double expected = at_rest.displacement_at({0, 0.01, 0}).y();
  std::vector<double> time, velocity;
  for (double t = 0; t < end + 2e-4; t += 1e-4) {
    const double s = std::min(t, rise), pi = std::numbers::pi;
    time.push_back(t);
    velocity.push_back(0.5 * g * (s - rise / pi * std::sin(pi * s / rise)) + g * (t - s));
  }
  p.motion.emplace(
      time, std::array{MotionColumn::absent, MotionColumn::rate, MotionColumn::absent, MotionColumn::absent},
      std::array<std::vector<double>, 4>{{{}, velocity, {}, {}}});
  Body body(p);
  double sum = 0;
  int n = 0;
  for (int k = 0; k * dt < end; ++k) {
    body.advance(k * dt, dt, {});
    if ((k + 1) * dt < rise) continue;
    sum += body.displacement_at({0, 0.01, 0}).y() - body.support_displacement()->y();
    ++n;
  }
  EXPECT_NEAR(sum / n / expected, 1, 0.02);
  EXPECT_NEAR(body.monitor().at("support.vy"), p.motion->at(end).velocity.y(), 1e-9);
  EXPECT_NEAR(body.monitor().at("support.fy") / (62.4 * g), 1, 0.1) << "what accelerates the plate";
}

// A body without supports, and without a frame, falls as one.
template <class Body>
void expect_a_free_body_to_fall(Parameters p) {
  p.plate.left = p.plate.right = Support::free;
  p.velocity = {1, 2, 0};
  p.gravity = {0, -9.81, 0};
  Body body(p);
  constexpr double dt = 1e-4;
  for (int k = 0; k < 20; ++k) body.advance(k * dt, dt, {});
  const double t = 20 * dt;
  for (const double x : {-0.2, 0.0, 0.2}) {
    const Eigen::Vector3d u = body.displacement_at({x, 0.01, 0});
    EXPECT_NEAR(u.x(), t, 1e-12);
    EXPECT_NEAR(u.y(), 2 * t - 0.5 * 9.81 * t * t, 1e-12);
  }
}

}  // namespace strake::structure
