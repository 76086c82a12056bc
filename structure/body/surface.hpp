#pragma once

#include "proto/box.hpp"
#include "proto/interface.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// Divides a polygon into a closed chain of segments, counter-clockwise from its first corner. The normal
/// (t_y, -t_x) of a segment then points into the fluid. Each edge is divided evenly, as near to `spacing` [m]
/// as that goes; the corners are points. The chain depends on the shape alone, so that a recorded interface
/// replays onto any solver.
InterfaceMesh outline(const std::vector<Eigen::Vector2d>& polygon, double spacing);
/// That of the plate, from its lower left corner.
InterfaceMesh outline(const Plate&, double spacing);

/// The cross-section in the xy-plane; of a circle a polygon with corners about `spacing` apart (0: a
/// hundred). A sphere and a closed surface have none.
std::vector<Eigen::Vector2d> polygon_of(const Shape&, const Plate&, double spacing);

/// The interface of surface coupling with `surface_spacing`, named "structure". In two dimensions it is the
/// `outline` of the shape, in three a closed surface of triangles (solid_surface.hpp).
InterfaceMesh surface(const Parameters&);

/// Whether a place belongs to the body, its surface included, to within a millionth of its size.
bool is_in_body(const Parameters&, const Eigen::Vector3d& X);
/// The smallest box around the body.
Box bounds(const Parameters&);

/// Length or area of surface that belongs to each point, n values. It is half the segments [m], or a third of
/// the triangles [m²], that meet in the point. The sum is the perimeter or the surface.
Eigen::VectorXd point_sizes(const InterfaceMesh&);

/// The load of [structure.load] on the points of a body's surface at full value, 3×n [N]. In two dimensions
/// it is per metre of depth. Zero without a load. A traction acts on each segment or triangle of the named
/// face; its force, traction times size, is shared evenly by the corners. A point force acts on the point
/// nearest to `at`.
Points case_force(const CaseLoad&, const Solid&, const InterfaceMesh& surface);

/// Which part of a body's outer surface the water loads, structure.loaded_faces. The fluid needs the whole
/// surface, to know inside from outside: it flows around the other faces too, and they keep it out, but what
/// presses on them is not felt.
struct LoadedFaces {
  Eigen::VectorXd share;       // n: of each point's size that lies in loaded faces; empty: all of it does
  double size = 0, whole = 0;  // [m] or [m²] of the loaded faces, and of all
  std::string line;            // for the console and `check`
};

/// Throws nothing: `read_loaded_faces` has refused what there is not.
LoadedFaces loaded_faces(const Parameters&, const InterfaceMesh&);

/// Factor of a ramp: ½(1 − cos(πt/T)) for t < T, else 1; 1 throughout for T = 0.
double ramp_factor(double t, double ramp);

}  // namespace strake::structure
