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

/// Where the frame is that a body's supports stand in, and how it moves: of its pivot, and its turn about the
/// z axis through that, counter-clockwise.
struct FrameState {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      // [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // [m/s²]
  double angle = 0, angular_velocity = 0;                  // [rad], [rad/s]
};

/// What the supports of an elastic body stand in. Along each axis its motion is prescribed, by a constant
/// speed or a table, or free: a lumped mass M, to which the body is fixed, under its weight and the reaction
/// R of the supports,
///   M dV/dt = R + M g
/// A body without supports has no frame to speak of: it moves by its own inertia.
class SupportFrame {
 public:
  explicit SupportFrame(const Parameters&);
  FrameState start() const;
  /// At a time, were all axes prescribed.
  FrameState prescribed(double time) const;
  bool is_free(Eigen::Index axis) const { return free_[static_cast<std::size_t>(axis)]; }
  bool is_free() const { return free_[0] || free_[1] || free_[2]; }
  /// Along an axis in which no support holds the body there is nothing to move.
  void stays_out(Eigen::Index axis) { free_[static_cast<std::size_t>(axis)] = false; }
  bool by_table() const { return motion_.has_value(); }
  bool turns() const { return motion_ && motion_->turns(); }
  /// What the turn adds to the displacement and the velocity of a held place: (R − 1)(X − pivot), ω × R (X −
  /// pivot).
  Eigen::Vector3d turned(const FrameState&, const Eigen::Vector3d& X) const;
  Eigen::Vector3d turning(const FrameState&, const Eigen::Vector3d& X) const;
  double mass() const { return mass_; }  // M [kg]

 private:
  std::array<bool, 3> free_;
  double mass_;
  Eigen::Vector3d velocity_, pivot_;
  std::optional<MotionTable> motion_;
};

/// What a driven or free frame tells: place, velocity, and the force of the supports on the body, columns for
/// history.csv; nothing where it moves at a constant speed.
std::vector<Column> frame_columns(const SupportFrame&, int dimension);
std::map<std::string, double> frame_monitor(const SupportFrame&, int dimension, const FrameState&,
                                            const Eigen::Vector3d& reaction);
std::string frame_line(const SupportFrame&, int dimension);

/// Velocity [m/s] at t = 0 of a place that is not held, relative to the supports.
Eigen::Vector3d velocity_at_start(const InitialVelocity&, int part, const Eigen::Vector3d& X);

}  // namespace strake::structure
