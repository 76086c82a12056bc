#pragma once

#include "proto/geometry/corner.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <vector>

namespace strake::fluid {

/// Returns the closed chains of a plane mesh's segments, as lists of point indices. Throws Error(case_file)
/// when one is open, or more than two segments meet.
std::vector<std::vector<int>> loops_of(const InterfaceMesh& partner);

/// A closed outline of plane points, walked counter-clockwise.
struct Outline {
  Eigen::Matrix2Xd place;
  std::vector<double> turn;  // at each point [rad], positive where the body is convex
  std::vector<Bend> bend;    // at each point

  /// Details that the water does not see are left out (`without_details`).
  Outline(const InterfaceMesh& partner, const std::vector<int>& loop, double spacing, const Knuckles&);
  std::size_t size() const { return turn.size(); }
  /// Point k, counted on around the outline.
  Eigen::Vector2d at(std::size_t k) const { return place.col(static_cast<Eigen::Index>(k % size())); }
  /// Unit normal of the segment from point k to the next one, into the fluid.
  Eigen::Vector2d normal(std::size_t k) const {
    const Eigen::Vector2d along = (at(k + 1) - at(k)).normalized();
    return {along.y(), -along.x()};
  }
};

}  // namespace strake::fluid
