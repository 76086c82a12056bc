#pragma once

#include "coupler/case/case_view.hpp"
#include "proto/interface.hpp"

#include <string>
#include <vector>

namespace strake {

/// Says in words what the spacings of a case resolve, one line each. They are particle layers across a plate,
/// spacings per half wetted width of a body that enters, and sensors wider than the peak that passes them.
/// The last line says that one spacing alone proves nothing. No line without water of ours. body: the
/// structure's mesh; velocity: of its points at t = 0 (3×n, or empty).
std::vector<std::string> resolution_lines(const CaseView&, const InterfaceMesh& body, const Points& velocity);

/// One of several bodies: its surface, and the velocity of its points at t = 0 (3×n, or empty).
struct MovingBody {
  std::string name;
  InterfaceMesh mesh;
  Points velocity;
};
/// The same for several bodies; the lines on wetted widths begin with the body's name.
std::vector<std::string> resolution_lines(const CaseView&, const std::vector<MovingBody>&);

/// Half the width of the part of a body that a level water surface at height y would wet [m]. It is that
/// along x, of several hulls that of the widest. In space it is the smaller one of those along x and z, which
/// decides the force on a slender body.
double half_width_below(const InterfaceMesh& body, double y);

/// Thickness of the jet of a wedge at half-wetted width `c` [m]: δ = c tan²β/(2π). slope: tan β of the
/// deadrise (Wagner 1932; Howison, Ockendon and Wilson 1991: δ = π c V²/(8 ċ²) with ċ = πV/(2 tan β)).
double jet_thickness(double c, double slope);

/// Width of the pressure peak that passes a place of a wedge at half-wetted width `c` [m], between its half
/// heights: 20.2 δ.
double peak_width(double c, double slope);

}  // namespace strake
