#include "fluid/fill.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
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

Range cells(const Box& box, const Box& tank, int axis, double spacing) {
  return {std::lround((box.min[axis] - tank.min[axis]) / spacing),
          std::lround((box.max[axis] - tank.min[axis]) / spacing)};
}

/// The edge, if it is off the lattice that starts at the tank's corner.
std::optional<BoxFault> off_lattice(const char* key, double edge, double origin, int axis, double spacing) {
  const double nearest = origin + std::round((edge - origin) / spacing) * spacing;
  if (std::abs(edge - nearest) <= lattice_tolerance * spacing) return {};
  return BoxFault{
      key,
      fmt::format("edges a whole number of spacings ({:.9g} m) from the tank's corner: {} = {:.9g} m is not",
                  spacing, axis_name[static_cast<size_t>(axis)], edge),
      fmt::format("the nearest is {:.9g} m", std::round(nearest / digit) * digit)};
}

}  // namespace

std::optional<BoxFault> find_box_fault(const Parameters& parameters) {
  const double l0 = parameters.spacing;
  const Box &tank = parameters.tank, &water = parameters.water;
  for (int d = 0; d < parameters.dimension; ++d) {
    const char name = axis_name[static_cast<size_t>(d)];
    if (auto fault = off_lattice("tank", tank.max[d], tank.min[d], d, l0)) return fault;
    if (water.min[d] < tank.min[d] - lattice_tolerance * l0 ||
        water.max[d] > tank.max[d] + lattice_tolerance * l0)
      return BoxFault{
          "water",
          fmt::format("a box inside fluid.tank, {} from {:.9g} to {:.9g} m", name, tank.min[d], tank.max[d]),
          "shrink fluid.water or enlarge fluid.tank"};
    for (const double edge : {water.min[d], water.max[d]})
      if (auto fault = off_lattice("water", edge, tank.min[d], d, l0)) return fault;
    if (const Range range = cells(water, tank, d, l0); range.last - range.first < fewest_rows)
      return BoxFault{"spacing",
                      fmt::format("at least {} particles across the water along {}, not {}", fewest_rows,
                                  name, range.last - range.first),
                      fmt::format("spacing = {:.3g} or less", (water.max[d] - water.min[d]) / fewest_rows)};
  }
  return {};
}

int dummy_rows(const Scheme& scheme) {
  const double largest = std::max(
      {scheme.radius_density, scheme.radius_gradient, scheme.radius_divergence, scheme.radius_laplacian});
  return static_cast<int>(std::ceil(largest)) - 1;
}

template <int dim>
State<dim> fill(const Parameters& parameters) {
  assert(parameters.dimension == dim);
  if (const auto fault = find_box_fault(parameters))
    throw Error(ExitCode::case_file, "fluid." + fault->key, "expected " + fault->expected, fault->fix);
  const double l0 = parameters.spacing;
  const Box& tank = parameters.tank;
  std::array<Range, 3> tank_cells{Range{0, 1}, Range{0, 1}, Range{0, 1}}, water_cells = tank_cells;
  for (int d = 0; d < dim; ++d) {
    tank_cells[static_cast<size_t>(d)] = cells(tank, tank, d, l0);
    water_cells[static_cast<size_t>(d)] = cells(parameters.water, tank, d, l0);
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
