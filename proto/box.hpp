#pragma once

#include <Eigen/Core>

namespace strake {

/// Axis-aligned box.
struct Box {
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();  // [m]
};

}  // namespace strake
