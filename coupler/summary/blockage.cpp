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

}  // namespace

double blockage(double half, double left, double right, double depth) {
  using std::numbers::pi;
  const double r = half / depth, floor = std::min(pi * pi / 48 * r * r, 4 / (3 * pi) * r);
  return 0.5 * (by_walls(half, left) + by_walls(half, right)) + floor;
}

std::optional<std::string> blockage_line(const CaseView& view, const InterfaceMesh& body, double half,
                                         double level) {
  const std::vector<double> tank = numbers_in(at_or(view.value, "fluid.tank"));
  if (!(half > 0) || body.dimension != 2 || (tank.size() != 4 && tank.size() != 6)) return std::nullopt;
  const bool repeats = at_or(view.value, "fluid.periodic").find("\"x\"") != std::string::npos;
  const double middle = 0.5 * (body.position.row(0).minCoeff() + body.position.row(0).maxCoeff());
  // An echo that comes back after the run does not count: c end_time is the way there and back.
  const double heard = 0.5 * view.number("fluid.sound_speed").value_or(no_wall) * view.common.end_time;
  const auto wall = [&](double distance) { return repeats || distance - half > heard ? no_wall : distance; };
  const double left = wall(middle - tank[0]), right = wall(tank[tank.size() / 2] - middle),
               depth = level - tank[1] > heard ? no_wall : level - tank[1];
  const double share = blockage(half, left, right, depth);
  if (!(share >= worth_a_line)) return std::nullopt;
  std::vector<std::string> near;
  if (const double nearer = std::min(left, right); std::isfinite(nearer))
    near.push_back(fmt::format("walls {:.2g}", nearer / half));
  if (std::isfinite(depth)) near.push_back(fmt::format("floor {:.2g}", depth / half));
  return fmt::format(
      "{} half wetted widths away: they raise the force {}, by 4 % where each is 4 away",
      joined(near, " and "),
      share < 1 ? fmt::format("by some {:.0f} %", 100 * share) : std::string("to more than twice"));
}

}  // namespace strake
