#pragma once

#include "structure/body/parameters.hpp"

#include <Eigen/Core>

#include <string>

namespace strake::structure {

/// The part of a body's outer surface that the water loads, structure.wet. The fluid needs the whole surface
/// to tell inside from outside. It flows around the other faces too, but its pressure on them does not load
/// the structure.
struct WetSurface {
  Eigen::VectorXd share;       // n: share of each point's size that lies in loaded faces; empty: all of it
  double size = 0, whole = 0;  // [m] or [m²] of the loaded faces, and of all
  std::string line;            // for the console and `check`
};

/// Throws nothing: `read_wet` has refused what there is not.
WetSurface wet_surface(const Parameters&, const InterfaceMesh&);

}  // namespace strake::structure
