#include "fluid/fill.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "proto/error.hpp"

namespace strake::fluid {
namespace {

using std::size_t;
constexpr double lattice_tolerance = 1e-6;  // relative to l0: a box edge this near to a lattice line is on it
constexpr double digit = 1e-12;             // [m] to which a suggested length is rounded
constexpr int fewest_rows = 4;              // of water in depth; fewer have no interior
constexpr std::array axis_name{'x', 'y', 'z'};

/// Range of cell numbers [first, last) of a box along one axis, counted from the tank's corner.
struct Range {
  long first = 0, last = 0;
};

Range cells(const char* name, const Box& box, int axis, double origin, double spacing) {
  const auto on_lattice = [&](double edge) {
    const double cells = (edge - origin) / spacing, nearest = std::round(cells);
    if (std::abs(cells - nearest) > lattice_tolerance)
      throw Error(
          ExitCode::case_file, fmt::format("fluid.{}", name),
          fmt::format("its {} edge at {:.9g} m is not a whole number of spacings ({:.9g} m) from {:.9g} m",
                      axis_name[static_cast<size_t>(axis)], edge, spacing, origin),
          fmt::format("the nearest is {:.9g} m", std::round((origin + nearest * spacing) / digit) * digit));
    return static_cast<long>(nearest);
  };
  return {on_lattice(box.min[axis]), on_lattice(box.max[axis])};
}

}  // namespace

int dummy_rows(const Scheme& scheme) {
  const double largest = std::max(
      {scheme.radius_density, scheme.radius_gradient, scheme.radius_divergence, scheme.radius_laplacian});
  return static_cast<int>(std::ceil(largest)) - 1;
}

template <int dim>
State<dim> fill(const Parameters& parameters) {
  const double l0 = parameters.spacing;
  const Box &tank = parameters.tank, &water = parameters.water;
  std::array<Range, 3> tank_cells{Range{0, 1}, Range{0, 1}, Range{0, 1}}, water_cells = tank_cells;
  for (int d = 0; d < dim; ++d) {
    const auto k = static_cast<size_t>(d);
    if (water.min[d] < tank.min[d] - lattice_tolerance * l0 ||
        water.max[d] > tank.max[d] + lattice_tolerance * l0)
      throw Error(
          ExitCode::case_file, "fluid.water",
          fmt::format("it reaches outside fluid.tank along {}: {:.9g} … {:.9g} m against {:.9g} … {:.9g} m",
                      axis_name[k], water.min[d], water.max[d], tank.min[d], tank.max[d]),
          "shrink fluid.water or enlarge fluid.tank");
    tank_cells[k] = cells("tank", tank, d, tank.min[d], l0);
    water_cells[k] = cells("water", water, d, tank.min[d], l0);
    if (const auto across = water_cells[k].last - water_cells[k].first; across < fewest_rows)
      throw Error(
          ExitCode::case_file, "fluid.spacing",
          fmt::format("{:.9g} m leaves {} particles across the water along {}; at least {} are needed", l0,
                      across, axis_name[k], fewest_rows),
          fmt::format("spacing = {:.3g} or less", (water.max[d] - water.min[d]) / fewest_rows));
  }

  const int behind = dummy_rows(parameters.scheme), layers = 1 + behind;
  std::vector<Vector<dim>> fluid, wall, dummy;
  const auto place = [&](const std::array<long, 3>& cell) {
    Vector<dim> x;
    for (int d = 0; d < dim; ++d)
      x[d] = tank.min[d] + (static_cast<double>(cell[static_cast<size_t>(d)]) + 0.5) * l0;
    return x;
  };
  const auto each = [&](const std::array<Range, 3>& range, auto&& body) {
    for (long z = range[2].first; z < range[2].last; ++z)
      for (long y = range[1].first; y < range[1].last; ++y)
        for (long x = range[0].first; x < range[0].last; ++x) body(std::array<long, 3>{x, y, z});
  };
  each(water_cells, [&](const auto& cell) { fluid.push_back(place(cell)); });

  // The tank box grown by the wall's layers on all sides but the top (y); a cell's layer is how far it is
  // outside.
  auto outer = tank_cells;
  for (int d = 0; d < dim; ++d) {
    outer[static_cast<size_t>(d)].first -= layers;
    if (d != 1) outer[static_cast<size_t>(d)].last += layers;
  }
  each(outer, [&](const auto& cell) {
    long layer = 0;
    for (int d = 0; d < dim; ++d) {
      const auto k = static_cast<size_t>(d);
      layer = std::max({layer, tank_cells[k].first - cell[k], d == 1 ? 0 : cell[k] - tank_cells[k].last + 1});
    }
    if (layer > 0) (layer == 1 ? wall : dummy).push_back(place(cell));
  });

  State<dim> state;
  const auto n = static_cast<Eigen::Index>(fluid.size() + wall.size() + dummy.size());
  state.position.resize(dim, n);
  state.velocity = Vectors<dim>::Zero(dim, n);
  state.pressure = Eigen::VectorXd::Zero(n);
  state.sps_k = Eigen::VectorXd::Zero(n);
  state.surface.assign(static_cast<size_t>(n), 0);
  Eigen::Index i = 0;
  for (const auto& [points, kind] :
       {std::pair{&fluid, Kind::fluid}, std::pair{&wall, Kind::wall}, std::pair{&dummy, Kind::dummy_wall}})
    for (const auto& point : *points) {
      state.position.col(i) = point;
      state.kind.push_back(kind);
      state.id.push_back(i);
      ++i;
    }
  return state;
}

template State<2> fill<2>(const Parameters&);
template State<3> fill<3>(const Parameters&);

}  // namespace strake::fluid
