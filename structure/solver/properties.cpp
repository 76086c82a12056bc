#include "structure/solver/properties.hpp"

#include <fmt/format.h>

#include <cmath>

namespace strake::structure {

std::string properties_line(const std::string& kind, const Properties& p) {
  if (p.mass == 0) return {};
  constexpr double nothing = 1e-12;  // [m] of a body of metres: round-off of its symmetry
  const Eigen::Vector3d centre = p.centre.unaryExpr([](double x) { return std::abs(x) < nothing ? 0.0 : x; });
  std::string frequencies;
  for (const double f : p.frequencies)
    frequencies += fmt::format("{}{:.5g}", frequencies.empty() ? "" : ", ", f);
  return fmt::format("{:<10} {:>12.6g}   ({:.5g}, {:.5g}, {:.5g}) {:>14.6g}   {:<28} {}\n", kind, p.mass,
                     centre.x(), centre.y(), centre.z(), p.inertia, frequencies.empty() ? "-" : frequencies,
                     p.step);
}

}  // namespace strake::structure
