#pragma once

#include "proto/interface.hpp"
#include "structure/parameters.hpp"

namespace strake::structure {

/// Outline of the plate as a closed polygon, walked counter-clockwise from the lower left corner, so that the
/// normal (t_y, -t_x) of a segment points into the fluid. Each edge is divided evenly, as near to `spacing`
/// [m] as that goes; the corners are points. It depends on the shape alone, so that a recorded interface
/// replays onto any solver.
InterfaceMesh outline(const Plate&, double spacing);

/// The interface of surface coupling: `outline` of the plate with `surface_spacing`, named "structure".
InterfaceMesh surface(const Parameters&);

/// Half the length of the segments that meet in each point, n [m]: Σ = the perimeter.
Eigen::VectorXd point_lengths(const InterfaceMesh&);

/// The load of [structure.load] on the points of an outline at full value, 3×n [N] (per metre of depth):
/// traction · length on the points of its face (end points carry half a segment), or the point force on the
/// point nearest to `at`. Zero without a load.
Points case_force(const CaseLoad&, const Plate&, const InterfaceMesh& outline);

/// Factor of a ramp: ½(1 − cos(πt/T)) for t < T, else 1; 1 throughout for T = 0.
double ramp_factor(double t, double ramp);

/// Volume of a closed outline by Green's theorem, [m²] per metre of depth; positive when counter-clockwise.
double enclosed_area(const InterfaceMesh& outline);

}  // namespace strake::structure
