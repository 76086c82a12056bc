#include "coupler/attachments/catenary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake {
namespace {

/// A line whose weight is less than this part of its axial stiffness per length is computed with it: a
/// straight elastic line is the limit.
constexpr double least_weight = 1e-9;

/// The root of an increasing function in [low, high], where f(low) <= 0 <= f(high), to the last digits: the
/// secant through both ends, or their middle where that closes in slowly.
template <class Function>
double root_of(const Function& f, double low, double high) {
  double f_low = f(low), f_high = f(high);
  constexpr int most = 200;
  for (int k = 0; k < most && f_low < 0 && f_high > 0; ++k) {
    const double width = high - low;
    if (width <= 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(low), std::abs(high))) break;
    double at = low + width * (-f_low / (f_high - f_low));
    if (k % 3 == 2 || !(at > low && at < high)) at = low + 0.5 * width;
    const double value = f(at);
    (value <= 0 ? low : high) = at;
    (value <= 0 ? f_low : f_high) = value;
  }
  return f_low == 0 || -f_low < f_high ? low : high;
}

/// The equations of one line (catenary.hpp) at given forces at its upper end.
struct Line {
  double length, weight, stiffness;  // [m] [N/m] [N]
  bool bottom;

  bool rests(double vertical) const { return bottom && vertical < weight * length; }

  /// z(H, V), increasing in V. H = 0: the line hangs down, and turns where V is less than its weight.
  double height(double H, double V) const {
    if (rests(V)) return arc(H, V) / weight + V * V / (2 * weight * stiffness);
    const double lower = V - weight * length;
    return (arc(H, V) - arc(H, lower)) / weight + (V - 0.5 * weight * length) * length / stiffness;
  }

  /// x(H, V).
  double distance(double H, double V) const {
    if (H == 0) return rests(V) ? length - V / weight : 0;
    const double stretch = H * length / stiffness, parameter = H / weight;
    if (rests(V)) return length - V / weight + parameter * std::asinh(V / H) + stretch;
    return parameter * (std::asinh(V / H) - std::asinh((V - weight * length) / H)) + stretch;
  }

  /// √(H² + V²) − H without cancellation, as differences of it alone are needed.
  static double arc(double H, double V) {
    const double tension = std::hypot(H, V);
    return tension == 0 ? 0 : V * V / (tension + H);
  }

  /// V at which the upper end has the height z.
  double vertical(double H, double z) const {
    double step = weight * length + H;
    double low = bottom ? 0 : -step, high = step;
    while (height(H, high) < z) high += (step *= 2);
    step = high;
    while (!bottom && height(H, low) > z) low -= (step *= 2);
    return root_of([&](double V) { return height(H, V) - z; }, low, high);
  }
};

Line line_of(const CatenaryParameters& p, double z) {
  return {p.length, std::max(p.weight, least_weight * p.axial_stiffness / p.length), p.axial_stiffness,
          p.bottom && z >= 0};
}

}  // namespace

CatenaryForce catenary(const CatenaryParameters& p, double x, double z) {
  const Line line = line_of(p, z);
  const auto answer = [&](double H) {
    const double V = line.vertical(H, z);
    return CatenaryForce{H, V, line.rests(V) ? line.length - V / line.weight : 0};
  };
  const auto too_far = [&](double H) { return line.distance(H, line.vertical(H, z)) - x; };
  if (too_far(0) >= 0) return answer(0);  // it hangs straight down
  double high = line.weight * line.length;
  while (too_far(high) < 0) high *= 2;
  return answer(root_of(too_far, 0, high));
}

// The part of the line up to the unstretched length s from the anchor is a line of length s itself, with the
// force (H, V − w (L − s)) at its upper end.
Eigen::Matrix2Xd catenary_shape(const CatenaryParameters& p, double x, double z, int n) {
  const CatenaryForce force = catenary(p, x, z);
  const Line line = line_of(p, z);
  Eigen::Matrix2Xd shape(2, n);
  for (int k = 0; k < n; ++k) {
    const double s = p.length * k / (n - 1), V = force.vertical - line.weight * (p.length - s);
    if (s <= force.resting) {
      shape.col(k) = Eigen::Vector2d(s * (1 + force.horizontal / p.axial_stiffness), 0);
      continue;
    }
    Line part = line;
    part.length = s;
    shape.col(k) = Eigen::Vector2d(part.distance(force.horizontal, V), part.height(force.horizontal, V));
  }
  shape.col(n - 1) = Eigen::Vector2d(x, z);
  return shape;
}

LineForce CatenaryLaw::at(std::size_t line, const Eigen::Vector3d& position,
                          const Eigen::Vector3d& /*velocity*/) const {
  const Eigen::Vector3d to_anchor = p_.anchor[line] - position;
  const double z = to_anchor.dot(p_.down);
  const Eigen::Vector3d level = to_anchor - z * p_.down;
  const double x = level.norm();
  const CatenaryForce force = catenary(p_, x, z);
  Eigen::Vector3d pull = force.vertical * p_.down;
  if (x > 0) pull += force.horizontal / x * level;
  return {pull, pull.norm()};
}

}  // namespace strake
