#pragma once

#include "structure/body/parameters.hpp"

#include <Eigen/Core>

#include <string>

namespace strake::structure {

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

}  // namespace strake::structure
