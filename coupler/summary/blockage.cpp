#include "coupler/summary/blockage.hpp"

#include "proto/lookup.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace strake {
namespace {

constexpr double worth_a_line = 0.1;  // twice the 5 % to which fine spacings keep the mean force
constexpr double no_wall = std::numeric_limits<double>::infinity();

double by_walls(double half, double distance) {
  if (!std::isfinite(distance)) return 0;
  const double x = 0.5 * std::numbers::pi * half / distance;
  return distance > half ? -2 * std::log(std::cos(x)) / (x * x) - 1 : no_wall;
}

/// ∫ artanh(u)/u du from 0 to s, Legendre's chi function of order 2: Σ s^(2k+1)/(2k+1)². s < 1.
double legendre_chi(double s) {
  constexpr int terms = 2000;
  double sum = 0, power = s;
  for (int k = 0; k < terms; ++k) {
    const double odd = 2.0 * k + 1;
    sum += power / (odd * odd);
    power *= s * s;
  }
  return sum;
}

/// Shares of two walls at one distance: (B1) to (B3) of the header.
Blockage of_entry_by_walls(double half, double distance) {
  if (!std::isfinite(distance)) return {};
  constexpr double pi = std::numbers::pi, smallest = 1e-3, at_the_wall = 0.9999;
  const double x0 = 0.5 * pi * half / distance;
  if (x0 < smallest) return {};
  if (!(x0 < legendre_chi(at_the_wall))) return {no_wall, no_wall};
  double low = 0, high = 1;
  constexpr int halvings = 50;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (legendre_chi(middle) < x0 ? low : high) = middle;
  }
  const double x = std::asin(low), tangent = std::tan(x);
  return {-2 * std::log(std::cos(x)) / (x0 * x0) - 1, tangent * tangent / (x0 * std::atanh(low)) - 1};
}

}  // namespace

Blockage blockage_of_entry(double half, double left, double right, double depth) {
  constexpr double pi = std::numbers::pi, impulse = 5 * pi * pi / 144, force = 2 * impulse;
  const Blockage l = of_entry_by_walls(half, left), r = of_entry_by_walls(half, right);
  const double h = half / depth, square = h * h;
  return {0.5 * (l.impulse + r.impulse) + impulse * square / std::sqrt(1 + 0.21 * square),
          0.5 * (l.force + r.force) + force * square / std::sqrt(1 + square / 3)};
}

double blockage(double half, double left, double right, double depth) {
  using std::numbers::pi;
  const double r = half / depth, floor = std::min(pi * pi / 48 * r * r, 4 / (3 * pi) * r);
  return 0.5 * (by_walls(half, left) + by_walls(half, right)) + floor;
}

std::optional<std::string> blockage_line(const CaseView& view, const InterfaceMesh& body, double half,
                                         double level, bool grows) {
  const std::vector<double> tank = numbers_in(at_or(view.value, "fluid.tank"));
  if (!(half > 0) || body.dimension != 2 || (tank.size() != 4 && tank.size() != 6)) return std::nullopt;
  const bool repeats = at_or(view.value, "fluid.periodic").find("\"x\"") != std::string::npos;
  const double middle = 0.5 * (body.position.row(0).minCoeff() + body.position.row(0).maxCoeff());
  // An echo that comes back after the run does not count: c end_time is the way there and back.
  const double heard = 0.5 * view.number("fluid.sound_speed").value_or(no_wall) * view.common.end_time;
  const auto wall = [&](double distance) { return repeats || distance - half > heard ? no_wall : distance; };
  const double left = wall(middle - tank[0]), right = wall(tank[tank.size() / 2] - middle),
               depth = level - tank[1] > heard ? no_wall : level - tank[1];
  const Blockage entry = blockage_of_entry(half, left, right, depth);
  const double share = grows ? entry.impulse : blockage(half, left, right, depth);
  if (!(share >= worth_a_line)) return std::nullopt;
  std::vector<std::string> near;
  if (const double nearer = std::min(left, right); std::isfinite(nearer))
    near.push_back(fmt::format("walls {:.2g}", nearer / half));
  if (std::isfinite(depth)) near.push_back(fmt::format("floor {:.2g}", depth / half));
  const auto by = [](double part) {
    return part < 1 ? fmt::format("by some {:.0f} %", 100 * part) : std::string("to more than twice");
  };
  const std::string away = joined(near, " and ") + " half wetted widths away: they raise the impulse ";
  if (!grows) return away + by(share) + ", by 4 % where each is 4 away";
  return away + by(share) +
         fmt::format(" and the force at the end {}, by 7 and 14 % where each is 4 away", by(entry.force));
}

}  // namespace strake
