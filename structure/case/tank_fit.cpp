#include "structure/body/surface.hpp"
#include "structure/case/keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace strake::structure {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// How many numbers each corner of fluid.tank has, or of fluid.tank_polygon: in the plane 2 or 3 may be
/// given. 0: cannot be told.
std::size_t per_corner(const std::vector<double>& numbers, bool polygon) {
  const std::size_t n = numbers.size();
  if (!polygon) return n == 4 || n == 6 ? n / 2 : 0;
  bool flat = n % 3 == 0;  // each third number may be a z of 0
  for (std::size_t i = 2; i < n; i += 3) flat = flat && numbers[i] == 0;
  if (n % 2 == 0) return flat ? 0 : 2;
  return flat ? 3 : 0;
}

/// The box around fluid.tank or fluid.tank_polygon, infinite where it may have no wall; none without a tank.
std::optional<Box> tank_box(const CaseFile& file, int dimension) {
  std::vector<double> numbers = file.numbers_at("fluid.tank");
  const bool polygon = numbers.empty();
  if (polygon) numbers = file.numbers_at("fluid.tank_polygon");
  const std::size_t dim = per_corner(numbers, polygon);
  if (static_cast<int>(dim) < dimension) return std::nullopt;
  Box box{Eigen::Vector3d::Constant(infinity), Eigen::Vector3d::Constant(-infinity)};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(i % dim);
    box.min[axis] = std::min(box.min[axis], numbers[i]);
    box.max[axis] = std::max(box.max[axis], numbers[i]);
  }
  const bool lid = file.has("fluid.open_top") && !file.is_true("fluid.open_top");
  if (!lid) box.max.y() = infinity;
  return box;
}

/// "(-1, 0) to (1, 0.5)".
std::string text_of(const Box& box, int dimension) {
  const auto place = [dimension](const Eigen::Vector3d& x) {
    return dimension == 2 ? fmt::format("({:.6g}, {:.6g})", x[0], x[1])
                          : fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0], x[1], x[2]);
  };
  return place(box.min) + " to " + place(box.max);
}

/// The largest length of the box along an axis on which both boxes end [m].
double largest(const Box& box, const Box& both, int dimension) {
  double length = 0;
  for (int d = 0; d < dimension; ++d)
    if (both.max[d] - both.min[d] < infinity) length = std::max(length, box.max[d] - box.min[d]);
  return length;
}

/// The key of [structure] that gives the body its form.
std::string form_key(const CaseTable& structure) {
  constexpr std::array keys = {"mesh", "box", "offsets", "plate", "outline", "wedge", "cylinder", "sphere"};
  for (const char* key : keys)
    if (structure.has(key)) return key;
  return "solver";
}

}  // namespace

void refuse_outside_tank(const CaseFile& file, const CaseTable& structure, const CommonKeys& common,
                         const Parameters& p) {
  constexpr double slack = 0.5;      // [l0]
  constexpr double far_larger = 20;  // lengths: no body and its tank
  if (common.fluid_solver != "mps" || p.interface != "surface" || p.kind == "replay") return;
  const std::optional<Box> tank = tank_box(file, p.dimension);
  if (!tank) return;
  const Box body = bounds(p);
  bool outside = false;
  for (int d = 0; d < p.dimension; ++d)
    outside = outside || body.min[d] < tank->min[d] - slack * p.fluid_spacing ||
              body.max[d] > tank->max[d] + slack * p.fluid_spacing;
  if (!outside) return;
  const std::string key = form_key(structure);
  const bool movable = key != "plate" && key != "cylinder" && key != "sphere" && key != "solver";
  const bool in_mm =
      movable && largest(body, *tank, p.dimension) > far_larger * largest(*tank, *tank, p.dimension);
  throw structure.error(
      key,
      fmt::format("a body inside the tank: it reaches from {} m, the tank from {} m",
                  text_of(body, p.dimension), text_of(*tank, p.dimension)),
      std::string(in_mm     ? "structure.placed.scale = 0.001, if the file is in mm"
                  : movable ? "structure.placed.move = [x, y, z] moves the body; or make "
                              "fluid.tank larger"
                            : "move or shorten the body, or make fluid.tank larger") +
          (file.has("fluid.periodic") ? "; no body goes over the seam of a periodic tank" : ""));
}

}  // namespace strake::structure
