#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

#include <Eigen/Core>

#include <string>

namespace strake::structure {

/// x ↦ R (s x) + move: R turns about the axis through the origin.
struct Placing {
  double scale = 1, angle = 0;  // angle in degrees
  Eigen::Vector3d axis = {0, 0, 1}, move = {0, 0, 0};
  Eigen::Matrix3d turn() const;                           // R
  Eigen::Matrix3d map() const { return scale * turn(); }  // s R
};

/// A key for a turn of at most `most` degrees to either side.
NumberKey turn_key(double most, const std::string& help);

/// Reads [structure.placed]. Throws Error(case_file) where the body's shape is not placed, or where the axis
/// would turn a body out of its plane.
Placing read_placing(CaseTable structure, const Parameters&, bool only_declares);

/// The turn of a plate by structure.plate.angle, about the middle of its lower face.
Placing tilt_of(const Plate&);

void place(Solid&, const Placing&);

/// Places the corners of structure.offsets, structure.outline or structure.wedge; nothing else. Throws
/// Error(case_file) where they are no outline of a body then.
void place_section(CaseTable structure, Parameters&, const Placing&);

}  // namespace strake::structure
