#pragma once

#include "proto/motion.hpp"

#include <filesystem>

namespace strake {

/// Reads a motion table: a column file whose header names `t [s]` and any of
///   x, y, z [m]       angle [deg] or [rad]              (places)
///   vx, vy, vz [m/s]  rate [deg/s] or [rad/s]           (their rates; one or the other for each)
/// Angles are about the z axis, counter-clockwise. Throws Error(case_file) with file and line.
MotionTable read_motion(const std::filesystem::path&);

}  // namespace strake
