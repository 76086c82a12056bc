#include "structure/rigid/rigid_body.hpp"

#include "proto/error.hpp"
#include "structure/body/surface.hpp"

#include <fmt/format.h>

#include <cmath>

namespace strake::structure {
namespace {

/// Rotations per window beyond which the mid-point rule means little [rad].
constexpr double largest_turn = 1.0;

/// Σ_jk ε_ijk M_jk.
Eigen::Vector3d axial(const Eigen::Matrix3d& m) {
  return {m(1, 2) - m(2, 1), m(2, 0) - m(0, 2), m(0, 1) - m(1, 0)};
}

}  // namespace

Eigen::Vector3d moment_of(const Wrench& wrench, const Eigen::Matrix3d& R) {
  return axial(R * wrench.moment);
}

RigidBody::RigidBody(const Parameters& p)
    : mass_(mass_of(p)),
      free_(p.free),
      centre_(p.pivot.value_or(mass_.centre)),
      arm_(mass_.centre - centre_),
      inertia_(inertia_about(mass_, arm_)),
      velocity_(p.velocity),
      gravity_(p.gravity),
      gravity_ramp_(p.gravity_ramp),
      angular_velocity_(p.angular_velocity),
      motion_(p.motion) {}

RigidState RigidBody::start() const {
  RigidState state;
  prescribe(state, 0);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    if (!(motion_ && motion_->gives(static_cast<std::size_t>(axis)))) state.velocity[axis] = velocity_[axis];
  if (!(motion_ && motion_->turns())) state.spin = {0, 0, angular_velocity_};
  return state;
}

// Sets the motions that are prescribed at a time. They have constant speeds, or follow the table relative to
// its place at t = 0.
void RigidBody::prescribe(RigidState& state, double time) const {
  RigidMotion place;
  place.displacement = velocity_ * time;
  place.velocity = velocity_;
  place.angle = angular_velocity_ * time;
  place.angular_velocity = angular_velocity_;
  if (motion_) {
    const RigidMotion now = motion_->at(time), first = motion_->at(0);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      if (!motion_->gives(static_cast<std::size_t>(axis))) continue;
      place.displacement[axis] = now.displacement[axis] - first.displacement[axis];
      place.velocity[axis] = now.velocity[axis];
    }
    if (motion_->turns()) {
      place.angle = now.angle - first.angle;
      place.angular_velocity = now.angular_velocity;
    }
  }
  const bool free[3] = {free_.x, free_.y, free_.z};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (free[axis]) continue;
    state.displacement[axis] = place.displacement[axis];
    state.velocity[axis] = place.velocity[axis];
  }
  if (turns_freely()) return;
  state.angle = place.angle;
  state.turn = Eigen::AngleAxisd(place.angle, Eigen::Vector3d::UnitZ());
  state.spin = {0, 0, place.angular_velocity};
}

Eigen::Vector3d RigidBody::velocity_of_gravity_centre(const RigidState& state) const {
  return state.velocity + state.turn * state.spin.cross(arm_);
}

double RigidBody::kinetic_energy(const RigidState& state) const {
  return 0.5 * mass_.mass * velocity_of_gravity_centre(state).squaredNorm() +
         0.5 * state.spin.dot(mass_.inertia * state.spin);
}

RigidState RigidBody::advance(const RigidState& from, double dt, const Wrench& loads) const {
  RigidState to = from;
  to.time = from.time + dt;
  const double ramp = 0.5 * (ramp_factor(from.time, gravity_ramp_) + ramp_factor(to.time, gravity_ramp_));
  Wrench all = loads;
  all.add(arm_, mass_.mass * ramp * gravity_);

  prescribe(to, to.time);
  const bool free[3] = {free_.x, free_.y, free_.z};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!free[axis]) continue;
    to.velocity[axis] = from.velocity[axis] + dt * all.force[axis] / mass_.mass;
    to.displacement[axis] = from.displacement[axis] + 0.5 * dt * (from.velocity[axis] + to.velocity[axis]);
    to.work += all.force[axis] * (to.displacement[axis] - from.displacement[axis]);
  }
  if (turns_freely()) turn(from, to, dt, all);

  // The drive of the prescribed motions does the rest of the work: their kinetic energy.
  if (!free_.any()) {
    to.work += kinetic_energy(to) - kinetic_energy(from);
    return to;
  }
  const Eigen::Vector3d change = velocity_of_gravity_centre(to) - velocity_of_gravity_centre(from);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    if (!free[axis]) to.work += mass_.mass * change[axis] * 0.5 * (from.velocity[axis] + to.velocity[axis]);
  if (!turns_freely())
    to.work += 0.5 * (to.spin.dot(mass_.inertia * to.spin) - from.spin.dot(mass_.inertia * from.spin));
  return to;
}

void RigidBody::turn(const RigidState& from, RigidState& to, double dt, const Wrench& loads) const {
  // A moved pivot: in its frame the inertia force −m a acts at the centre of gravity.
  Wrench all = loads;
  if (arm_.squaredNorm() > 0) all.add(arm_, -mass_.mass / dt * (to.velocity - from.velocity));

  const Eigen::Matrix3d before = from.turn.toRotationMatrix();
  const Eigen::Vector3d momentum = before * (inertia_ * from.spin);
  const Eigen::Matrix3d inverse = inertia_.inverse();
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
  Eigen::Matrix3d mean = before;
  double last = std::numeric_limits<double>::infinity();
  to.spin = from.spin;
  constexpr int most = 200;
  for (int k = 0;; ++k) {
    way = 0.5 * dt * (from.spin + to.spin);
    const Eigen::Vector3d half = 0.5 * way;
    to.turn = (from.turn * Eigen::Quaterniond(1, half.x(), half.y(), half.z())).normalized();
    const Eigen::Matrix3d after = to.turn.toRotationMatrix();
    mean = 0.5 * (before + after);
    const Eigen::Vector3d moment = moment_of(all, mean);
    Eigen::Vector3d spin = from.spin;
    if (free_.rotation)
      spin = inverse * (after.transpose() * (momentum + dt * moment));
    else
      spin.z() += dt * moment.z() / inertia_(2, 2);
    const double change = (spin - to.spin).norm();
    to.spin = spin;
    // Down to round-off: until the change no longer falls.
    if (change == 0 || (k > 1 && change >= last && change <= 1e-12 * spin.norm())) break;
    last = change;
    if (k >= most || !(way.norm() <= largest_turn))
      throw Error(ExitCode::solver_fault, fmt::format("structure, window at t = {:.6g} s", from.time),
                  fmt::format("the body turns by {:.3g} rad in {:.3g} s", way.norm(), dt),
                  "lower coupling.surface.window, or check structure.inertia");
  }
  to.angle = from.angle + 2 * std::atan(0.5 * way.z());
  to.work += (before * way).dot(moment_of(loads, mean));
}

}  // namespace strake::structure
