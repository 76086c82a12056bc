#pragma once

#include "proto/motion.hpp"

#include <filesystem>

namespace strake {

/// Reads a motion table: a column file whose header names `t [s]` and any of
///   x, y, z [m]       angle [deg] or [rad]              (places)
///   vx, vy, vz [m/s]  rate [deg/s] or [rad/s]           (their rates; one or the other for each)
/// Angles are about the z axis, counter-clockwise. Throws Error(case_file) with file and line.
MotionTable read_motion(const std::filesystem::path&);

/// Velocities over a coordinate: a motion table in which the coordinate [m] stands in the place of time, and
/// velocities [m/s] in that of places.
struct VelocityProfile {
  MotionTable velocity;
  Eigen::Index axis;  // of the coordinate: 0 x, 1 y, 2 z
};

/// Reads one: a column file whose header names one of x, y, z [m], strictly increasing, and any of
/// vx, vy, vz [m/s]. Throws Error(case_file) with the file.
VelocityProfile read_velocity_profile(const std::filesystem::path&);

}  // namespace strake
