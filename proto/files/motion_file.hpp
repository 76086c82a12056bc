#pragma once

#include "proto/motion.hpp"

#include <filesystem>

namespace strake {

/// Reads a motion table: a column file whose header names `t [s]` and any of
///   x, y, z [m]       angle [deg] or [rad]              (places)
///   vx, vy, vz [m/s]  rate [deg/s] or [rad/s]           (their rates; one or the other for each)
/// Angles are about the z axis, counter-clockwise. Throws Error(case_file) with file and line.
MotionTable read_motion(const std::filesystem::path&);

/// Velocities over a coordinate. It is stored as a motion table: the coordinate [m] replaces the time, and
/// the velocities [m/s] replace the places.
struct VelocityProfile {
  MotionTable velocity;
  Eigen::Index axis;  // of the coordinate: 0 x, 1 y, 2 z
};

/// Reads a velocity profile from a column file. Its header names one of x, y, z [m], strictly increasing, and
/// any of vx, vy, vz [m/s]. Throws Error(case_file) with the file.
VelocityProfile read_velocity_profile(const std::filesystem::path&);

}  // namespace strake
