#pragma once

#include "coupler/attachments/local_attachment.hpp"

#include <vector>

namespace strake {

/// A straight spring with a damper, from each point to an anchor that stays where it is.
struct SpringParameters {
  std::vector<Eigen::Vector3d> anchor;  // [m] one for each point
  double stiffness = 0;                 // [N/m]; 2-D: per metre of depth, [N/m²]
  double damping = 0;                   // [N s/m]; 2-D: [N s/m²]
  std::vector<double> length;           // [m] without a force, one for each point
  bool slack = false;                   // a rope: it pulls, and never presses
};

/// T = k (L − L_0) + c dL/dt along the line from the point to its anchor.
class SpringLaw final : public LineLaw {
 public:
  explicit SpringLaw(SpringParameters parameters) : p_(std::move(parameters)) {}
  LineForce at(std::size_t line, const Eigen::Vector3d& position,
               const Eigen::Vector3d& velocity) const override;

 private:
  SpringParameters p_;
};

}  // namespace strake
