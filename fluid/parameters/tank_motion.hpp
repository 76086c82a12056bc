#pragma once

#include "proto/motion.hpp"

#include <Eigen/Core>

#include <optional>

namespace strake::fluid {

/// The tank's motion, [fluid.motion]: a table, or a sine of translation and roll. It is a pure function of
/// time, so that rewind and restart need no data. The turn is about the z axis through the pivot, which moves
/// with the translation.
struct TankMotion {
  std::optional<MotionTable> table;                     // the sine's numbers are not used where it is given
  Eigen::Vector3d amplitude = Eigen::Vector3d::Zero();  // [m]
  double roll = 0;                                      // [rad] amplitude of the turn
  double frequency = 0;                                 // [Hz]
  double ramp = 0;                                      // [s] the amplitudes grow from 0 over this time
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();      // [m] in the tank as the case gives it

  bool moves() const { return table || roll != 0 || amplitude.squaredNorm() > 0; }
  bool turns() const { return table ? table->turns() : roll != 0; }
  RigidMotion at(double t) const;
  /// Returns the largest displacement of the pivot along each axis from t = 0 to `end` [m]. A table is
  /// sampled 1000 times.
  Eigen::Vector3d reach(double end) const;
};

}  // namespace strake::fluid
