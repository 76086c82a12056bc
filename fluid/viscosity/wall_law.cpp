#include "fluid/viscosity/wall_law.hpp"

#include <algorithm>
#include <cmath>

namespace strake::fluid {
namespace {

constexpr double kappa = 0.41, offset = 5.0;  // von Kármán's constant; B of u⁺ = ln(y⁺)/κ + B, smooth faces

}  // namespace

// Solves u⁺ y⁺(u⁺) = Re, Re = u y/ν, by Newton's method. The left side is convex, and both starting values
// lie above the solution, so every step comes down towards it.
double WallLaw::friction_velocity(double speed, double distance) const {
  if (!(speed > 0) || !(distance > 0) || !(kinematic_viscosity > 0)) return 0;
  const double reynolds = speed * distance / kinematic_viscosity;
  if (!(reynolds < 1e300)) return 0;
  double u = std::min(std::sqrt(reynolds), std::log(std::max(1.0, reynolds)) / kappa + offset + 1);
  const double scale = std::exp(-kappa * offset);
  for (int step = 0; step < 50; ++step) {
    const double a = kappa * u;
    const double y = u + scale * (std::expm1(a) - a - a * a / 2 - a * a * a / 6);
    const double slope = 1 + scale * kappa * (std::expm1(a) - a - a * a / 2);
    const double change = (u * y - reynolds) / (y + u * slope);
    u -= change;
    if (std::abs(change) < 1e-10 * u) break;
  }
  return speed / u;
}

}  // namespace strake::fluid
