#pragma once

#include <Eigen/Core>

// Nearest points on segments and triangles in space [m].

namespace strake {

/// Distance from x to the segment from a to b [m].
double distance_to_segment(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& x);

/// Weights of a triangle's corners (the columns) at its point nearest to x. Inside they follow from the
/// normal equations of x ≈ a + s (b − a) + t (c − a), otherwise from the nearest edge.
Eigen::Vector3d nearest_in_triangle(const Eigen::Matrix3d& corner, const Eigen::Vector3d& x);

}  // namespace strake
