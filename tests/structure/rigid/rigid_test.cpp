#include "structure/rigid/rigid.hpp"

#include "proto/error.hpp"
#include "structure/body/mass.hpp"
#include "structure/body/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace strake::structure {
namespace rigid_test {

using Eigen::Vector3d;

/// A polygon that is symmetric to nothing, as a rigid body.
Parameters crooked() {
  Parameters p;
  p.kind = "rigid";
  p.shape.kind = ShapeKind::polygon;
  p.shape.corner = {{0, 0}, {0.4, 0.05}, {0.5, 0.3}, {0.1, 0.2}};
  p.surface_spacing = 0.05;
  return p;
}

Parameters crooked_solid() {
  Parameters p = crooked();
  p.dimension = 3;
  p.shape.depth = 0.3;
  p.shape.middle = 0.1;
  p.surface_spacing = 0.1;
  return p;
}

/// A load on the interface points that has a sum and a moment, constant over the window.
Load push(const InterfaceMesh& mesh, double size, double t = 0) {
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3, mesh.position.cols());
  for (Eigen::Index k = 0; k < force.cols(); ++k) {
    force(0, k) = size * std::sin(1.0 + static_cast<double>(k));
    force(1, k) = size * std::cos(2.0 * static_cast<double>(k) + 30 * t);
    if (mesh.dimension == 3) force(2, k) = size * std::sin(3.0 * static_cast<double>(k) + 0.5);
  }
  return Load({Sample{t, {{"force", "N", true, force}}}});
}

TEST(Rigid, FallsFreelyAsGalileoSays) {
  Parameters p = crooked();
  p.free.y = true;
  p.velocity = {0.5, -1, 0};
  p.gravity = {0, -9.81, 0};
  Rigid body(p);
  for (int k = 0; k < 100; ++k) body.advance(k * 0.01, 0.01, {});
  EXPECT_NEAR(body.displacement()(1, 2), -1 - 0.5 * 9.81, 1e-13);  // round-off of 100 steps
  EXPECT_NEAR(body.velocity()(1, 2), -1 - 9.81, 1e-13);
  EXPECT_NEAR(body.displacement()(0, 2), 0.5, 1e-15);  // prescribed
  const Energy energy = body.energy();
  const Rigid at_rest(p);
  EXPECT_NEAR(energy.kinetic - at_rest.energy().kinetic, energy.external, 1e-12 * energy.kinetic);
}

TEST(Rigid, SpinsFreelyAtAConstantRateAboutItsCentreOfGravity) {
  Parameters p = crooked();
  p.free = {.x = true, .y = true, .z = false, .angle = true, .rotation = false};
  p.angular_velocity = 2;
  Rigid body(p);
  const Vector3d centre = mass_of(p).centre;
  for (int k = 0; k < 1000; ++k) body.advance(k * 1e-3, 1e-3, {});
  // Cayley's map turns by 2 atan(ωΔt/2): a share (ωΔt)²/12 less than ωΔt.
  EXPECT_NEAR(body.monitor().at("body.angle"), 2 * 180 / std::numbers::pi, 1e-4);
  EXPECT_LT(body.displacement_at(centre).norm(), 1e-15);
  EXPECT_NEAR(body.velocity_at(centre + Vector3d(0, 0.1, 0)).norm(), 0.2, 1e-14);
}

TEST(Rigid, DrivenRotationIsFollowedExactlyByEveryInterfacePoint) {
  Parameters p = crooked();
  p.angular_velocity = 3;
  p.velocity = {0.2, -0.4, 0};
  p.pivot = Vector3d(-0.2, 0.1, 0);
  Rigid body(p);
  body.advance(0.5, 0.01, {});
  const double t = 0.51, angle = 3 * t;
  const Points X = body.interface().position, u = body.displacement(), v = body.velocity();
  for (Eigen::Index k = 0; k < X.cols(); ++k) {
    const Vector3d r = X.col(k) - *p.pivot;
    const Vector3d turned(std::cos(angle) * r.x() - std::sin(angle) * r.y(),
                          std::sin(angle) * r.x() + std::cos(angle) * r.y(), 0);
    EXPECT_LT((u.col(k) - (p.velocity * t + turned - r)).norm(), 1e-15);
    EXPECT_LT((v.col(k) - (p.velocity + Vector3d(-3 * turned.y(), 3 * turned.x(), 0))).norm(), 1e-14);
  }
}

TEST(Rigid, ABodyThatTurnsAsItIsDrivenHasNoDeflection) {
  Parameters p = crooked();
  p.angular_velocity = 3;
  p.velocity = {0.2, -0.4, 0};
  Rigid body(p);
  body.advance(0.5, 0.01, {});
  const Vector3d X(0.1, 0.05, 0);
  EXPECT_TRUE(body.prescribed());
  ASSERT_TRUE(body.support_displacement(X));
  EXPECT_EQ(*body.support_displacement(X), body.displacement_at(X));
  p.free.y = true;
  p.velocity.y() = 0;
  EXPECT_FALSE(Rigid(p).support_displacement(X));
  EXPECT_FALSE(Rigid(p).prescribed());
}

TEST(Rigid, FollowsATableInPlaceAndAngle) {
  Parameters p = crooked();
  std::vector<double> t, y, angle;
  for (int i = 0; i <= 40; ++i) {
    t.push_back(0.05 * i);
    y.push_back(0.3 + t.back() * t.back());  // counted from its place at t = 0
    angle.push_back(0.5 * t.back());
  }
  p.motion =
      MotionTable(t, {MotionColumn::absent, MotionColumn::place, MotionColumn::absent, MotionColumn::place},
                  {{{}, y, {}, angle}});
  p.velocity = {2, 0, 0};
  Rigid body(p);
  EXPECT_EQ(body.displacement().norm(), 0);
  body.advance(0.99, 0.01, {});
  const Vector3d centre = mass_of(p).centre;
  EXPECT_LT((body.displacement_at(centre) - Vector3d(2, 1, 0)).norm(), 1e-12);
  EXPECT_LT((body.velocity_at(centre) - Vector3d(2, 2, 0)).norm(), 1e-11);
  EXPECT_NEAR(body.monitor().at("body.angle"), 0.5 * 180 / std::numbers::pi, 1e-10);
  EXPECT_NEAR(body.monitor().at("body.rate"), 0.5 * 180 / std::numbers::pi, 1e-9);
}

/// Work of a constant load on a body's points, from their motion.
struct Account {
  double work = 0;
  Vector3d impulse = Vector3d::Zero();
};

Account run(Rigid& body, const Parameters& p, int steps, double dt, double size) {
  Account account;
  const double mass = mass_of(p).mass;
  for (int k = 0; k < steps; ++k) {
    const Load load = push(body.interface(), size, k * dt);
    const Points before = body.displacement(), force = load.at(k * dt, before.cols());
    const Vector3d fallen = body.displacement_at(mass_of(p).centre);
    body.advance(k * dt, dt, load);
    account.work += (body.displacement() - before).reshaped().dot(force.reshaped());
    account.work += mass * p.gravity.dot(body.displacement_at(mass_of(p).centre) - fallen);
    account.impulse += dt * (force.rowwise().sum() + mass * p.gravity);
  }
  return account;
}

TEST(Rigid, LoadsChangeEnergyByTheirWorkAndMomentumByTheirImpulse) {
  for (const bool solid : {false, true}) {
    Parameters p = solid ? crooked_solid() : crooked();
    p.free = {.x = true, .y = true, .z = solid, .angle = !solid, .rotation = solid};
    p.gravity = {0, -9.81, 0};
    p.velocity = {0.3, -1, 0};
    p.angular_velocity = 4;
    Rigid body(p);
    const double before = body.energy().kinetic;
    const Vector3d v0 = body.velocity_at(mass_of(p).centre);
    const Account account = run(body, p, 200, 2e-3, solid ? 300 : 3000);
    const double gained = body.energy().kinetic - before;
    EXPECT_GT(std::abs(gained), 0.1 * before);
    EXPECT_NEAR(gained, account.work, 1e-11 * body.energy().kinetic) << solid;
    EXPECT_NEAR(gained, body.energy().external, 1e-11 * body.energy().kinetic) << solid;
    const Vector3d change = mass_of(p).mass * (body.velocity_at(mass_of(p).centre) - v0);
    EXPECT_LT((change - account.impulse).norm(), 1e-11 * change.norm());
  }
}

TEST(Rigid, ATumblingBodyKeepsAngularMomentumAndEnergyToRoundOff) {
  Parameters p = crooked_solid();
  p.free = {.x = true, .y = true, .z = true, .angle = false, .rotation = true};
  p.body.inertia_axes = Vector3d(1, 2, 2.5);
  RigidBody body(p);
  RigidState state = body.start();
  state.spin = {0.1, 3, 0.2};  // about the middle axis: it tumbles
  const double energy = body.kinetic_energy(state);
  const Eigen::Matrix3d J = body.mass().inertia;
  const Vector3d momentum = state.turn * (J * state.spin);
  double lowest = 3;
  for (int k = 0; k < 4000; ++k) {
    state = body.advance(state, 2e-3, {});
    lowest = std::min(lowest, state.spin.y());
  }
  EXPECT_LT(lowest, -2.5);  // has turned over
  EXPECT_NEAR(body.kinetic_energy(state) / energy, 1, 1e-12);
  EXPECT_LT((state.turn * (J * state.spin) - momentum).norm(), 1e-12 * momentum.norm());
}

TEST(Rigid, APendulumKeepsItsEnergyAndSwingsInItsPeriod) {
  Parameters p = crooked();
  p.free.angle = true;
  p.gravity = {0, -9.81, 0};
  const MassProperties mass = mass_of(p);
  p.pivot = mass.centre + Vector3d(0.02, 0.5, 0);  // hung a little aside
  Rigid body(p);
  const double arm = std::hypot(0.02, 0.5), amplitude = std::atan2(0.02, 0.5);
  const double inertia = mass.inertia(2, 2) + mass.mass * arm * arm;
  // T = 2π √(J/(m g a)) (1 + φ²/16) for small amplitudes φ
  const double period =
      2 * std::numbers::pi * std::sqrt(inertia / (mass.mass * 9.81 * arm)) * (1 + amplitude * amplitude / 16);
  double t = 0, worst = 0;
  const double dt = period / 2000;
  std::vector<double> crossings;
  double last = 0;
  for (int k = 0; k < 6000; ++k) {
    body.advance(t, dt, {});
    t += dt;
    const Energy e = body.energy();
    worst = std::max(worst, std::abs(e.kinetic - e.external));
    const double angle = body.monitor().at("body.angle") * std::numbers::pi / 180 - amplitude;
    if (last < 0 && angle >= 0) crossings.push_back(t - dt * angle / (angle - last));
    last = angle;
  }
  ASSERT_GE(crossings.size(), 2u);
  EXPECT_NEAR((crossings[1] - crossings[0]) / period, 1, 1e-5);  // rule and interpolation are of second order
  EXPECT_LT(worst, 1e-11 * mass.mass * 9.81 * arm);
}

TEST(Rigid, RewindAndCheckpointGoOnBitEqual) {
  for (const bool solid : {false, true}) {
    Parameters p = solid ? crooked_solid() : crooked();
    p.free = {.x = true, .y = true, .z = solid, .angle = !solid, .rotation = solid};
    p.gravity = {0, -9.81, 0};
    p.angular_velocity = 1;
    Rigid first(p), second(p);
    first.advance(0, 1e-3, push(first.interface(), 1e4));
    first.save();
    Archive archive;
    first.write(archive);
    first.advance(1e-3, 1e-3, push(first.interface(), 2e4));
    const Points once = first.displacement();
    const auto monitor = first.monitor();
    first.restore();
    first.advance(1e-3, 1e-3, push(first.interface(), -7e4));
    first.restore();
    first.advance(1e-3, 1e-3, push(first.interface(), 2e4));
    EXPECT_EQ(first.displacement(), once);
    second.read(archive);
    second.advance(1e-3, 1e-3, push(second.interface(), 2e4));
    EXPECT_EQ(second.displacement(), once);
    EXPECT_EQ(second.velocity(), first.velocity());
    EXPECT_EQ(second.monitor(), monitor);
    EXPECT_EQ(second.energy().external, first.energy().external);
    EXPECT_EQ(second.steps(), first.steps());
  }
}

TEST(Rigid, ABodyThatTurnsTooFarInOneWindowIsAnErrorWithARemedy) {
  Parameters p = crooked();
  p.free.angle = true;
  p.body.inertia = 1e-9;
  Rigid body(p);
  try {
    body.advance(0, 0.1, push(body.interface(), 1e6));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::solver_fault);
    EXPECT_NE(to_text(e).find("coupling.surface.window"), std::string::npos);
  }
}

TEST(Rigid, SaysItsMassAndHowHardItIsToCouple) {
  Parameters p = crooked();
  p.free.y = true;
  p.body.mass = 50;
  const auto lines = Rigid(p).lines();
  EXPECT_NE(lines.at(0).find("free in y"), std::string::npos);
  EXPECT_NE(lines.at(1).find("mass 50 kg per metre of depth"), std::string::npos);
  EXPECT_NE(lines.at(2).find("added-mass ratio 1.96"), std::string::npos) << lines.at(2);  // ½π ρ 0.25²/50
  p.body.mass = 0;  // solid steel, which a hull is not
  EXPECT_NE(Rigid(p).lines().at(2).find("structure.mass is not given"), std::string::npos);
}

TEST(Rigid, SaysTheSpeedOfItsTable) {
  Parameters p = crooked();
  p.velocity = Vector3d::Zero();
  p.end_time = 1;
  p.motion = MotionTable(
      {0, 1}, {MotionColumn::absent, MotionColumn::rate, MotionColumn::absent, MotionColumn::absent},
      {{{}, {-5, -5}, {}, {}}});
  EXPECT_NE(Rigid(p).lines().at(0).find("driven by a table from 0 to 1 s   speed up to 5 m/s"),
            std::string::npos)
      << Rigid(p).lines().at(0);
}

}  // namespace rigid_test
}  // namespace strake::structure
