#include "coupler/attachments/spring.hpp"

#include <algorithm>

namespace strake {

LineForce SpringLaw::at(std::size_t line, const Eigen::Vector3d& position,
                        const Eigen::Vector3d& velocity) const {
  const Eigen::Vector3d to_anchor = p_.anchor[line] - position;
  const double length = to_anchor.norm();
  // A spring of length zero pulls with −k x in every direction, and has no line where x = 0.
  if (p_.length[line] == 0 && !p_.slack)
    return {p_.stiffness * to_anchor - p_.damping * velocity, p_.stiffness * length};
  if (length == 0) return {};
  const Eigen::Vector3d line_of_action = to_anchor / length;
  const double rate = -line_of_action.dot(velocity);  // dL/dt
  double tension = p_.stiffness * (length - p_.length[line]) + p_.damping * rate;
  if (p_.slack) tension = length > p_.length[line] ? std::max(0.0, tension) : 0.0;
  return {tension * line_of_action, tension};
}

}  // namespace strake
