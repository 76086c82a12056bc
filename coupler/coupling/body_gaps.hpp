#pragma once

#include "proto/interface.hpp"

#include <optional>
#include <string>

namespace strake {

/// Two bodies of a mesh that are close to each other.
struct BodyGap {
  std::string one, other;
  double distance = 0;                           // [m] between a point of `one` and a face of `other`
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // [m] that point
  bool inside = false;                           // it lies in the other body
};

/// The smallest distance between two of the mesh's bodies, if it is below `limit` [m]; nothing otherwise.
/// displacement: 3×n [m] of the mesh's points.
std::optional<BodyGap> closest_bodies(const InterfaceMesh&, const Points& displacement, double limit);

/// The first body with its first point inside another one, which is closed. Only the start of a run needs it:
/// later a body cannot come into another without touching it.
std::optional<BodyGap> body_inside_another(const InterfaceMesh&, const Points& displacement);

}  // namespace strake
