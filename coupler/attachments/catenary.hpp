#pragma once

#include "coupler/attachments/local_attachment.hpp"

#include <vector>

namespace strake {

/// An elastic line that hangs under its own weight, from each point to its anchor.
struct CatenaryParameters {
  std::vector<Eigen::Vector3d> anchor;  // [m] one for each point
  double length = 0;                    // [m] without a force
  double weight = 0;                    // [N/m] in water; 2-D: of lines side by side, per metre of depth
  double axial_stiffness = 0;           // [N] EA
  bool bottom = true;                   // a level bottom at the anchor, on which the line may lie
  Eigen::Vector3d down = {0, -1, 0};    // unit vector, direction of gravity
};

/// Force at the upper end of an elastic line in its own vertical plane.
struct CatenaryForce {
  double horizontal = 0, vertical = 0;  // [N] H towards the anchor, V downwards
  double resting = 0;                   // [m] length that lies on the bottom
};

/// Solves the catenary for an upper end at the horizontal distance x >= 0 and the height z above the anchor
/// [m]. Relative error of the place below 1e-10 of the length.
///
/// Hanging free (the lower end is lifted with V − wL >= 0, or there is no bottom):
///   x = H/w (asinh(V/H) − asinh((V − wL)/H)) + H L/EA
///   z = H/w (√(1 + (V/H)²) − √(1 + ((V − wL)/H)²)) + (V L − w L²/2)/EA
/// With the length L − V/w on the bottom, without friction:
///   x = L − V/w + H/w asinh(V/H) + H L/EA
///   z = H/w (√(1 + (V/H)²) − 1) + V²/(2 w EA)
/// Source: H. M. Irvine, Cable Structures, MIT Press 1981, chapter 2; J. M. Jonkman, NREL/TP-500-41958, 2007,
/// equations 2-35 to 2-38.
CatenaryForce catenary(const CatenaryParameters&, double x, double z);

/// Places along the line from its anchor to its upper end: distance and height [m], 2×n with n >= 2.
Eigen::Matrix2Xd catenary_shape(const CatenaryParameters&, double x, double z, int n);

/// The quasi-static force of such lines: weight and stretch, without inertia and drag of the line.
class CatenaryLaw final : public LineLaw {
 public:
  explicit CatenaryLaw(CatenaryParameters parameters) : p_(std::move(parameters)) {}
  LineForce at(std::size_t line, const Eigen::Vector3d& position,
               const Eigen::Vector3d& velocity) const override;

 private:
  CatenaryParameters p_;
};

}  // namespace strake
