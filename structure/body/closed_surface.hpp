#pragma once

#include "proto/interface.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace strake::structure {

/// A rigid body by the triangles of its surface. The surface is closed: each edge has two triangles, which
/// walk it in opposite directions.
struct ClosedSurface {
  Points point;                         // 3×n [m]
  Eigen::Matrix3Xi triangle;            // 3×m, counter-clockwise seen from outside the material
  Eigen::Index outer = 0;               // the first triangles, which meet the water; the others bound hollows
  std::vector<std::string> lines = {};  // for the console and `check`: where it is from
};

/// Volume [m³] inside, hollows left out, by the divergence theorem.
double volume_of(const ClosedSurface&);
/// Area [m²] of the triangles that meet the water.
double outer_area(const ClosedSurface&);

/// How often triangles walk around X: 1 inside a closed piece with its normals outside, 0 outside of it, in
/// between on the surface. It is the sum of their solid angles over 4π (Van Oosterom and Strackee 1983).
double winding_number(const Points& point, const Eigen::Matrix3Xi& triangle, const Eigen::Vector3d& X);
/// Whether X lies in the material or within `slack` [m] of its surface.
bool is_inside(const ClosedSurface&, const Eigen::Vector3d& X, double slack);

/// Longest edge of the interface mesh, as a multiple of its spacing. A square that is as wide as the spacing
/// keeps its diagonal.
inline constexpr double longest_edge = 1.5;

/// The triangles that meet the water as an interface mesh. Edges are halved, in both their triangles, until
/// none is longer than `longest_edge` spacings [m]. Smaller triangles stay as they are.
InterfaceMesh refined_surface(const ClosedSurface&, double spacing);
/// About how many points that mesh has. No integer: there may be too many for one.
double refined_count(const ClosedSurface&, double spacing);

}  // namespace strake::structure
