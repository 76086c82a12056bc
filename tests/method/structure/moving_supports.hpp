#pragma once

// What bodies on moving supports must do, whatever solver they have: `Body` is FemSolver<2> or
// ParticleSolver<2>.
#include "structure/solver/solver.hpp"
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
    bent =
        std::max(bent, body.displacement_at({0, 0.01, 0}).y() - body.support_displacement({0, 0.01, 0})->y());
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
    sum += body.displacement_at({0, 0.01, 0}).y() - body.support_displacement({0, 0.01, 0})->y();
    ++n;
  }
  EXPECT_NEAR(sum / n / expected, 1, 0.02);
  EXPECT_NEAR(body.monitor().at("support.vy"), p.motion->at(end).velocity.y(), 1e-9);
  EXPECT_NEAR(body.monitor().at("support.fy") / (62.4 * g), 1, 0.1) << "what accelerates the plate";
}

// A strip that is clamped to a hub and spun up stretches by centrifugal forces, ρω²L³/(3E'). The work of the
// hub is the strip's gain of energy, and a resumed run is bit-equal.
template <class Body>
void expect_a_turning_clamp_to_stretch_the_strip(Parameters p, double energy_tolerance, double tolerance) {
  constexpr double rate = 200, rise = 0.03, end = 0.042, dt = 5e-5, length = 0.4;
  p.plate.right = Support::free;
  p.pivot = Eigen::Vector3d(-0.2, 0.01, 0);
  std::vector<double> time, speed;
  for (double t = 0; t < end + 1e-3; t += 5e-4) {
    const double s = std::min(1.0, t / rise);
    time.push_back(t);
    speed.push_back(rate * s * s * s * (10 - 15 * s + 6 * s * s));
  }
  p.motion.emplace(
      time, std::array{MotionColumn::absent, MotionColumn::absent, MotionColumn::absent, MotionColumn::rate},
      std::array<std::vector<double>, 4>{{{}, {}, {}, speed}});
  Body body(p), other(p);
  const Eigen::Vector3d tip(0.2, 0.01, 0);
  double sum = 0, drift = 0, largest = 0, beside = 0;
  int n = 0;
  for (int k = 0; k * dt < end; ++k) {
    if (k == 200) {
      Archive archive;
      body.save();
      body.write(archive);
      other.read(archive);
    }
    body.advance(k * dt, dt, {});
    if (k == 200) {
      other.advance(k * dt, dt, {});
      EXPECT_EQ(body.displacement(), other.displacement());
      EXPECT_EQ(body.velocity(), other.velocity());
    }
    const Energy e = body.energy();
    largest = std::max(largest, e.kinetic);
    drift = std::max(drift, std::abs(e.kinetic + e.strain - e.external));
    if ((k + 1) * dt < rise) continue;
    const Eigen::Vector3d u = body.displacement_at(tip);
    sum += (tip + u - *p.pivot).norm() - length;
    beside = std::max(beside, (u - *body.support_displacement(tip)).norm());
    ++n;
  }
  const double modulus = p.material.young / (1 - p.material.poisson * p.material.poisson);
  EXPECT_NEAR(sum / n / (p.material.density * rate * rate * std::pow(length, 3) / (3 * modulus)), 1,
              tolerance);
  EXPECT_LT(beside, 5e-3) << "it turns as its clamp does";
  EXPECT_GT(largest, 0.9 * p.material.density * 0.02 * rate * rate * std::pow(length, 3) / 6);
  EXPECT_LT(drift, energy_tolerance * largest);
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

/// A step that is taken again after a rewind, or by another solver after a checkpoint, has the same bits.
template <class Body>
void expect_checkpoints_and_rewinds_to_be_bit_equal(const Parameters& p) {
  Body first(p), second(p);
  const Load load = upward(first.interface(), 1e5);
  first.advance(0, 1e-5, load);
  first.save();
  Archive archive;
  first.write(archive);
  second.read(archive);
  first.advance(1e-5, 1e-5, load);
  const Points once = first.displacement();
  first.restore();
  first.advance(1e-5, 1e-5, load);
  second.advance(1e-5, 1e-5, load);
  EXPECT_EQ(first.displacement(), once);
  EXPECT_EQ(second.displacement(), once);
  EXPECT_EQ(second.momentum(), first.momentum());
}

}  // namespace strake::structure
