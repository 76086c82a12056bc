#include "fluid/boundary/fill.hpp"

#include "fluid/boundary/packing.hpp"
#include "fluid/geometry/tank_polygon.hpp"
#include "fluid/geometry/tank_shape.hpp"
#include "fluid/particles/columns.hpp"
#include "fluid/ranks/ranks.hpp"
#include "proto/error.hpp"
#include "proto/geometry/polygon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <span>

namespace strake::fluid {
namespace {

using std::size_t;
constexpr double lattice_tolerance = 1e-6;  // relative to l0: a box edge this near to a lattice line is on it
constexpr double digit = 1e-12;             // [m] to which a suggested length is rounded
constexpr int fewest_rows = 4;              // layers of water in depth; fewer have no interior
constexpr std::array axis_name{'x', 'y', 'z'};

/// An edge of a box [m], across an axis.
struct Edge {
  int axis;
  double at;
};

/// Returns a fault that names all edges which are off the lattice that starts at the tank's corner.
std::optional<BoxFault> off_lattice(const char* key, const std::vector<Edge>& edges,
                                    const Eigen::Vector3d& corner, double spacing) {
  std::string off, nearest;
  double last = 0;  // [m] where the last of them should be
  int n = 0;
  for (const auto& [axis, at] : edges) {
    const double on = corner[axis] + std::round((at - corner[axis]) / spacing) * spacing;
    if (std::abs(at - on) <= lattice_tolerance * spacing) continue;
    const char name = axis_name[static_cast<size_t>(axis)];
    last = std::round(on / digit) * digit;
    off += fmt::format("{}{} = {:.9g} m", n > 0 ? ", " : "", name, at);
    nearest += fmt::format("{}{} = {:.9g} m", n > 0 ? ", " : "", name, last);
    ++n;
  }
  if (n == 0) return {};
  return BoxFault{key,
                  fmt::format("edges a whole number of spacings ({:.9g} m) from the tank's corner: {} {} not",
                              spacing, off, n == 1 ? "is" : "are"),
                  n == 1 ? fmt::format("the nearest is {:.9g} m", last) : "the nearest are " + nearest};
}

}  // namespace

Box bounds(const std::vector<Eigen::Vector3d>& points) {
  Box box{points.front(), points.front()};
  for (const auto& point : points) {
    box.min = box.min.cwiseMin(point);
    box.max = box.max.cwiseMax(point);
  }
  return box;
}

namespace {

std::optional<BoxFault> water_fault(const std::vector<Eigen::Vector3d>& shape, const Box& tank,
                                    const Parameters& p) {
  const double l0 = p.spacing;
  const Box water = bounds(shape);
  const char* key = shape.size() > 2                                       ? "water_polygon"
                    : shape[0] == p.water.min || p.water_shapes.size() < 2 ? "water"
                                                                           : "more_water";
  for (int d = 0; d < p.dimension; ++d) {
    const char name = axis_name[static_cast<size_t>(d)];
    if (water.min[d] < tank.min[d] - lattice_tolerance * l0 ||
        water.max[d] > tank.max[d] + lattice_tolerance * l0)
      return BoxFault{
          key,
          fmt::format("water inside fluid.tank, {} from {:.9g} to {:.9g} m", name, tank.min[d], tank.max[d]),
          "shrink the water or enlarge fluid.tank"};
    if (shape.size() == 2) {
      std::vector<Edge> edges;
      for (int e = d; e < p.dimension; ++e) edges.insert(edges.end(), {{e, water.min[e]}, {e, water.max[e]}});
      if (auto fault = off_lattice(key, edges, tank.min, l0)) return fault;
    }
    if (!(water.max[d] > water.min[d]))
      return BoxFault{key,
                      fmt::format("water with a length along {}: fluid.dimension is {}", name, p.dimension),
                      p.dimension == 3 ? "corners with three numbers that differ, or fluid.dimension = 2"
                                       : "corners that differ"};
    if (const long rows = std::lround((water.max[d] - water.min[d]) / l0); rows < fewest_rows)
      return BoxFault{
          "spacing",
          fmt::format("at least {} particles across the water along {}, not {}", fewest_rows, name, rows),
          fmt::format("spacing = {:.3g} or less", (water.max[d] - water.min[d]) / fewest_rows)};
  }
  return {};
}

double largest_radius(const Scheme& scheme) {
  return std::max(
      {scheme.radius_density, scheme.radius_gradient, scheme.radius_divergence, scheme.radius_laplacian});
}

}  // namespace

std::optional<BoxFault> find_box_fault(const Parameters& p) {
  const double l0 = p.spacing, reach = largest_radius(p.scheme) * l0;
  Box tank = p.tank;
  if (!p.tank_polygon.empty()) {
    if (const std::string expected = polygon_fault(p, reach); !expected.empty())
      return BoxFault{"tank_polygon", expected, "look at fluid.tank_polygon beside a sketch of the tank"};
    tank = bounds(p.tank_polygon);
  }
  for (int d = 0; d < p.dimension; ++d) {
    const bool periodic = p.periodic[static_cast<size_t>(d)];
    if (p.tank_polygon.empty()) {
      std::vector<Edge> edges;
      for (int e = d; e < p.dimension; ++e) edges.push_back({e, tank.max[e]});
      if (auto fault = off_lattice("tank", edges, tank.min, l0)) return fault;
    }
    // A particle must not meet another and its image at once.
    if (const double least = 2 * (reach + l0); periodic && tank.max[d] - tank.min[d] < least)
      return BoxFault{"periodic",
                      fmt::format("a period of at least {:.3g} m along {}, not {:.3g} m", least,
                                  axis_name[static_cast<size_t>(d)], tank.max[d] - tank.min[d]),
                      "widen fluid.tank, or refine fluid.spacing"};
  }
  for (const auto& shape : water_shapes(p))
    if (auto fault = water_fault(shape, tank, p)) return fault;
  return {};
}

int dummy_rows(const Scheme& scheme) {
  return static_cast<int>(std::ceil(largest_radius(scheme))) - 1;
}

namespace {

/// Whether the middle of a cell lies in that shape of the water. A shape is two corners of a box, or a
/// polygon. One that lies on an edge of the polygon counts as a little above and to the right of it, so that
/// round-off decides nothing.
template <int dim>
bool holds(std::span<const Eigen::Vector3d> shape, Vector<dim> x, double spacing) {
  if (shape.size() == 2)
    return (x.array() > shape[0].head<dim>().array()).all() &&
           (x.array() < shape[1].head<dim>().array()).all();
  x[1] += lattice_tolerance * spacing;
  x[0] += 0.1 * lattice_tolerance * spacing;
  bool odd = false;
  for (size_t k = 0; k < shape.size(); ++k)
    if (ray_crosses(shape[k].head<2>(), shape[(k + 1) % shape.size()].head<2>(), x.template head<2>()))
      odd = !odd;
  return odd;
}

}  // namespace

template <int dim>
bool is_water_at(const Parameters& p, const Vector<dim>& x) {
  if (p.water_shapes.empty()) return holds<dim>(std::array{p.water.min, p.water.max}, x, p.spacing);
  return std::any_of(p.water_shapes.begin(), p.water_shapes.end(),
                     [&](const auto& shape) { return holds<dim>(shape, x, p.spacing); });
}

template bool is_water_at<2>(const Parameters&, const Vector<2>&);
template bool is_water_at<3>(const Parameters&, const Vector<3>&);

namespace {

/// Returns the middle of a cell. One copy of the code for `fill` and `fill_share`: the compiler may round
/// inlined copies in different ways, and the water of several ranks is that of one to the last bit.
template <int dim>
[[gnu::noinline]] Vector<dim> cell_middle(const TankShape<dim>& tank, const std::array<long, 3>& cell,
                                          double spacing) {
  Vector<dim> x;
  for (int d = 0; d < dim; ++d)
    x[d] = tank.low()[d] + (static_cast<double>(cell[static_cast<size_t>(d)]) + 0.5) * spacing;
  return x;
}

/// Calls visit(x) for the middles of all cells between the tank's corners.
template <int dim, class Visit>
void for_each_cell(const Parameters& p, const TankShape<dim>& tank, const Visit& visit) {
  std::array<long, 3> cells{1, 1, 1}, c{};
  for (int d = 0; d < dim; ++d)
    cells[static_cast<size_t>(d)] = std::lround((tank.high()[d] - tank.low()[d]) / p.spacing);
  for (c[2] = 0; c[2] < cells[2]; ++c[2])
    for (c[1] = 0; c[1] < cells[1]; ++c[1])
      for (c[0] = 0; c[0] < cells[0]; ++c[0]) visit(cell_middle<dim>(tank, c, p.spacing));
}

/// Returns the middles of the cells between the tank's walls that are filled with water. Packing also needs
/// the cells of the air, which are removed afterwards. A cell whose middle lies on a slanted wall is half
/// water: every other one of each wall is filled.
template <int dim>
std::vector<Vector<dim>> water_places(const Parameters& p, const TankShape<dim>& tank,
                                      const WallParticles<dim>& walls) {
  const auto is_water = [&](const Vector<dim>& x) { return is_water_at<dim>(p, x); };
  const bool packed = !tank.on_lattice();
  std::vector<Vector<dim>> places;
  std::map<size_t, int> halved;  // by the wall's edge
  for_each_cell<dim>(p, tank, [&](const Vector<dim>& x) {
    if (!packed && !is_water(x)) return;
    const auto edge = packed ? tank.slanted_edge_at(x) : std::nullopt;
    if (edge ? halved[*edge]++ % 2 == 0 : tank.contains(x)) places.push_back(x);
  });
  if (!packed) return places;
  if constexpr (dim == 2) pack(places, tank, walls, p.spacing, p.water.max[1]);
  std::erase_if(places, [&](const Vector<dim>& x) { return !is_water(x); });
  return places;
}

}  // namespace

std::vector<std::vector<Eigen::Vector3d>> water_shapes(const Parameters& p) {
  if (!p.water_shapes.empty()) return p.water_shapes;
  return {{p.water.min, p.water.max}};
}

namespace {

void check_boxes(const Parameters& p) {
  if (const auto fault = find_box_fault(p))
    throw Error(ExitCode::case_file, "fluid." + fault->key, "expected " + fault->expected, fault->fix);
}

template <int dim>
void add_initial_velocity(const Parameters& p, Eigen::Index water, State<dim>& state) {
  if (p.initial_velocity.is_zero()) return;
  for (Eigen::Index k = 0; k < water; ++k) {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    x.head<dim>() = state.position.col(k);
    state.velocity.col(k) += p.initial_velocity.at(x).template head<dim>();
  }
}

}  // namespace

template <int dim>
State<dim> fill(const Parameters& parameters) {
  assert(parameters.dimension == dim);
  check_boxes(parameters);
  const TankShape<dim> tank(parameters);
  const WallParticles<dim> walls = tank.particles(dummy_rows(parameters.scheme));
  const std::vector<Vector<dim>> water = water_places<dim>(parameters, tank, walls);

  State<dim> state;
  const auto n = static_cast<Eigen::Index>(water.size() + walls.wall.size() + walls.dummy.size());
  resize_particles(state, n);
  state.air_connected.assign(static_cast<size_t>(n), 1);
  std::iota(state.id.begin(), state.id.end(), 0);
  Eigen::Index i = 0;
  const auto add = [&](const Vector<dim>& place, Kind kind) {
    state.kind[static_cast<size_t>(i)] = kind;
    state.position.col(i++) = place;
  };
  for (const auto& place : water) add(place, Kind::fluid);
  for (const auto& particle : walls.wall) add(particle.position, Kind::wall);
  for (const auto& particle : walls.dummy) add(particle.position, Kind::dummy_wall);
  if (const RigidMotion start = parameters.motion.at(0); parameters.motion.moves())
    for (Eigen::Index k = 0; k < n; ++k) {
      const Vector<dim> r = state.position.col(k) - parameters.motion.pivot.head<dim>();
      state.velocity.col(k) = start.velocity.head<dim>();
      state.velocity(0, k) -= start.angular_velocity * r[1];
      state.velocity(1, k) += start.angular_velocity * r[0];
    }
  add_initial_velocity<dim>(parameters, static_cast<Eigen::Index>(water.size()), state);
  return state;
}

template <int dim>
WaterShare<dim> fill_share(const Parameters& p, int rank, int ranks) {
  check_boxes(p);
  const TankShape<dim> tank(p);
  assert(tank.on_lattice() && !p.motion.moves());
  const auto for_each_water = [&](const auto& visit) {
    for_each_cell<dim>(p, tank, [&](const Vector<dim>& x) {
      if (is_water_at<dim>(p, x) && tank.contains(x)) visit(x);
    });
  };
  WaterShare<dim> share{{}, 0};
  for_each_water([&](const Vector<dim>&) { ++share.water_of_whole; });
  const std::int64_t begin = begin_of_share(share.water_of_whole, ranks, rank),
                     n = begin_of_share(share.water_of_whole, ranks, rank + 1) - begin;
  State<dim>& state = share.state;
  resize_particles(state, n);
  state.kind.assign(static_cast<size_t>(n), Kind::fluid);
  state.air_connected.assign(static_cast<size_t>(n), 1);
  std::iota(state.id.begin(), state.id.end(), begin);
  std::int64_t i = -begin;
  for_each_water([&](const Vector<dim>& x) {
    if (i >= 0 && i < n) state.position.col(i) = x;
    ++i;
  });
  add_initial_velocity<dim>(p, n, state);
  return share;
}

template State<2> fill<2>(const Parameters&);
template State<3> fill<3>(const Parameters&);
template WaterShare<2> fill_share<2>(const Parameters&, int, int);
template WaterShare<3> fill_share<3>(const Parameters&, int, int);

}  // namespace strake::fluid
