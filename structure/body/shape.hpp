#pragma once

#include "proto/geometry/polygon.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace strake::structure {

enum class ShapeKind { plate, solid, surface, polygon, wedge, cylinder, sphere };

/// The body's outer form. In the xy-plane a closed polygon walked counter-clockwise, or a circle; in three
/// dimensions the prism over it along z, or a sphere. A plate is kept in Parameters::plate too, and elastic
/// bodies with all their parts in Parameters::solid. A closed surface of triangles is in
/// Parameters::closed_surface.
struct Shape {
  ShapeKind kind = ShapeKind::plate;
  std::vector<Eigen::Vector2d> corner;  // [m] polygon, wedge; a solid of the plane: its outer boundary
  int unseen = 0;     // points of a polygon or wedge that the case gives and the water does not see
  double radius = 0;  // [m] cylinder, sphere
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // [m] cylinder, sphere
  double depth = 0;   // [m] of the prism, along z; 0: two dimensions, all per metre of depth
  double middle = 0;  // [m] z of the prism's middle
};

/// A symmetric wedge with its apex down. It has faces at the deadrise angle up to the chines, vertical sides
/// and a flat deck; no sides if height = draught.
struct Wedge {
  double deadrise = 0;                             // [rad] of a face against the horizontal
  double width = 0;                                // [m] between the chines
  double height = 0;                               // [m] from the apex to the deck
  Eigen::Vector3d apex = Eigen::Vector3d::Zero();  // [m]
};
double draught(const Wedge&);  // [m] of the chines above the apex
std::vector<Eigen::Vector2d> wedge_polygon(const Wedge&);

/// Approximates a circle by a polygon of the same area. Its corners are about `spacing` apart, their number
/// is a multiple of four, and the first lies at the bottom.
std::vector<Eigen::Vector2d> circle_polygon(const Eigen::Vector2d& centre, double radius, double spacing);

/// What is wrong with a polygon as the outline of a body.
struct PolygonFault {
  std::string problem, fix;  // both empty: nothing
};
PolygonFault polygon_fault(const std::vector<Eigen::Vector2d>&);

}  // namespace strake::structure
