#pragma once

#include "proto/participant.hpp"
#include "structure/body/parameters.hpp"

#include <Eigen/Core>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake::structure {

/// Position and motion of the frame in which a body's supports stand. They are those of its pivot, and its
/// turn about the z axis through the pivot, counter-clockwise.
struct FrameState {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      // [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // [m/s²]
  double angle = 0, angular_velocity = 0;                  // [rad], [rad/s]
};

/// The frame in which the supports of an elastic body stand. Along each axis its motion is prescribed, by a
/// constant speed or a table, or free: a lumped mass M, to which the body is fixed, under its weight and the
/// reaction R of the supports,
///   M dV/dt = R + M g
/// A body without supports needs no frame: it moves by its own inertia.
class SupportFrame {
 public:
  explicit SupportFrame(const Parameters&);
  FrameState start() const;
  /// At a time, were all axes prescribed.
  FrameState prescribed(double time) const;
  bool is_free(Eigen::Index axis) const { return free_[static_cast<std::size_t>(axis)]; }
  bool is_free() const { return free_[0] || free_[1] || free_[2]; }
  /// Removes an axis from the free ones if no support constrains the body along it. The frame has nothing to
  /// move there.
  void stays_out(Eigen::Index axis) { free_[static_cast<std::size_t>(axis)] = false; }
  /// False: nothing holds the body.
  bool holds() const { return holds_; }
  bool by_table() const { return motion_.has_value(); }
  bool turns() const { return motion_ && motion_->turns(); }
  /// Displacement and velocity that the turn adds to a constrained place: (R − 1)(X − pivot) and ω × R (X −
  /// pivot).
  Eigen::Vector3d turned(const FrameState&, const Eigen::Vector3d& X) const;
  Eigen::Vector3d turning(const FrameState&, const Eigen::Vector3d& X) const;
  double mass() const { return mass_; }  // M [kg]

 private:
  bool holds_;
  std::array<bool, 3> free_;
  double mass_;
  Eigen::Vector3d velocity_, pivot_;
  std::optional<MotionTable> motion_;
};

/// Columns of a driven or free frame for history.csv: place, velocity, and the force of the supports on the
/// body. Empty if the frame moves at a constant speed.
std::vector<Column> frame_columns(const SupportFrame&, int dimension);
std::map<std::string, double> frame_monitor(const SupportFrame&, int dimension, const FrameState&,
                                            const Eigen::Vector3d& reaction);
/// What holds the body and how that moves, for the head of a run; empty for supports at a constant speed.
std::string frame_line(const SupportFrame&, int dimension);

/// Velocity [m/s] at t = 0 of an unconstrained place, relative to the supports.
Eigen::Vector3d velocity_at_start(const InitialVelocity&, int part, const Eigen::Vector3d& X);

}  // namespace strake::structure
