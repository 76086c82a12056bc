#pragma once

#include "proto/box.hpp"
#include "proto/interface.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// A polygon as a closed chain of segments, walked counter-clockwise from its first corner, so that the
/// normal (t_y, -t_x) of a segment points into the fluid. Each edge is divided evenly, as near to `spacing`
/// [m] as that goes; the corners are points. It depends on the shape alone, so that a recorded interface
/// replays onto any solver.
InterfaceMesh outline(const std::vector<Eigen::Vector2d>& polygon, double spacing);
/// That of the plate, from its lower left corner.
InterfaceMesh outline(const Plate&, double spacing);

/// The cross-section in the xy-plane; of a circle a polygon with corners about `spacing` apart (0: a
/// hundred). A sphere has none.
std::vector<Eigen::Vector2d> polygon_of(const Shape&, const Plate&, double spacing);

/// The interface of surface coupling with `surface_spacing`, named "structure": in two dimensions `outline`
/// of the shape; in three a closed surface of triangles, see solid_surface.hpp.
InterfaceMesh surface(const Parameters&);

/// Whether a place belongs to the body, its surface included, to within a millionth of its size.
bool is_in_body(const Parameters&, const Eigen::Vector3d& X);
/// The smallest box around the body.
Box bounds(const Parameters&);

/// The size of surface that each point stands for, n: half the segments [m] or a third of the triangles [m²]
/// that meet in it. Σ = the perimeter or the surface.
Eigen::VectorXd point_sizes(const InterfaceMesh&);

/// The load of [structure.load] on the points of a body's surface at full value, 3×n [N] (per metre of depth
/// in two dimensions): traction times the size of each segment or triangle that lies in the named face,
/// shared evenly by its corners; or the point force on the point nearest to `at`. Zero without a load.
Points case_force(const CaseLoad&, const Solid&, const InterfaceMesh& surface);

/// Factor of a ramp: ½(1 − cos(πt/T)) for t < T, else 1; 1 throughout for T = 0.
double ramp_factor(double t, double ramp);

/// What a closed surface encloses by Green's theorem, [m²] per metre of depth or [m³]; positive when its
/// normals point into the fluid.
double enclosed_volume(const InterfaceMesh&);

}  // namespace strake::structure
