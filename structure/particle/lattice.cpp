#include "structure/particle/lattice.hpp"

#include "structure/body/wall.hpp"
#include "structure/particle/sites.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::structure {
namespace {

using Eigen::Index;

/// Planes of a body in spacings from the first one along each axis.
struct Grid {
  const Solid& solid;
  double spacing;
  double steps(double coordinate, int axis) const {
    return (coordinate - solid.plane[static_cast<std::size_t>(axis)].front()) / spacing;
  }
  int at(int node, int axis) const {
    return static_cast<int>(std::lround(steps(solid.node(axis, node), axis)));
  }
  /// Lattice cells of a box-shaped cell: [first, last) along an axis.
  std::pair<int, int> range(Index c, int axis) const {
    return {at(solid.cell(0, c), axis), at(solid.cell(solid.cell.rows() - 1, c), axis)};
  }
};

/// Sites of a union of boxes whose planes lie between lattice cells.
template <int dim>
Placement<dim> filled(const Solid& solid, double spacing) {
  using Cell = Eigen::Matrix<int, dim, 1>;
  const Grid grid{solid, spacing};
  Placement<dim> placement;
  for (int axis = 0; axis < dim; ++axis)
    placement.origin[axis] = solid.plane[static_cast<std::size_t>(axis)].front();
  for (Index c = 0; c < solid.cell.cols(); ++c) {
    Cell first, end;
    for (int axis = 0; axis < dim; ++axis) std::tie(first[axis], end[axis]) = grid.range(c, axis);
    const int part = solid.part_of[static_cast<std::size_t>(c)];
    const bool constrained = solid.parts[static_cast<std::size_t>(part)].constrained;
    for_each_cell<dim>(first, end, [&](const Cell& at) {
      placement.sites[at] = {.part = part, .fixed = constrained, .inside = true, .share = 1};
    });
  }
  return placement;
}

/// Applies the clamp rule of structure/THEORY.md, section 5.3, to one facet. Along each line of cells that
/// crosses it, it fixes the last cell inside and `beyond` cells in front of that.
template <int dim>
void clamp_facet(const Solid& solid, int facet, double spacing, int beyond, bool hold_inside,
                 Placement<dim>& placement) {
  using Cell = Eigen::Matrix<int, dim, 1>;
  const Eigen::Vector3d normal = facet_normal(solid, facet);
  Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const int direction = normal[axis] > 0 ? 1 : -1;
  auto& sites = placement.sites;
  for_each_line<dim>(
      solid, facet, static_cast<int>(axis), placement.origin, spacing, [&](Cell at, double crossing) {
        const auto inside = [&] {
          const auto found = sites.find(at);
          return found == sites.end() || !found->second.inside ? nullptr : &found->second;
        };
        // Behind the face. An oblique face cuts a cell, which may have its particle or not.
        at[axis] = static_cast<int>(std::lround(crossing)) - (direction > 0 ? 1 : 0);
        const bool cuts_next =
            direction * (crossing - static_cast<double>(std::lround(crossing))) > file_decimals;
        if (cuts_next) at[axis] += direction;
        Site* last = inside();
        for (int k = 0; last == nullptr && k < (cuts_next ? 3 : 2); ++k) {
          at[axis] -= direction;
          last = inside();
        }
        if (last == nullptr) return;
        if (hold_inside) last->fixed = true;
        const int part = last->part;
        for (int k = 0; k < beyond; ++k) {
          at[axis] += direction;
          // Another part of the body stands in the way; further clamps may have been there already.
          if (const auto [found, fresh] =
                  sites.emplace(at, Site{.part = part, .fixed = true, .inside = false, .share = 1});
              !fresh && found->second.inside)
            return;
        }
      });
}

}  // namespace

template <int dim>
Lattice<dim> make_lattice(const Solid& solid, double spacing, double radius, ClampColumn clamp,
                          Places places) {
  using Cell = typename Lattice<dim>::Cell;
  Placement<dim> placement =
      solid.along_axes() ? filled<dim>(solid, spacing) : sampled<dim>(solid, spacing, places);
  // Two beyond a clamp at least, else the reach of a bond.
  const int beyond = std::max(2, static_cast<int>(std::floor(radius)));
  for (const SupportedFace& face : solid.supported)
    if (face.support == Support::clamped)
      for (const int f : face.facet)
        clamp_facet<dim>(solid, f, spacing, beyond, clamp == ClampColumn::inside, placement);

  const Sites<dim>& sites = placement.sites;
  Cell low = sites.begin()->first, high = low;
  for (const auto& [at, site] : sites) {
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  Lattice<dim> lattice;
  lattice.spacing = spacing;
  lattice.extent = high - low + Cell::Ones();
  lattice.layers = std::max(1, static_cast<int>(std::lround(wall_thickness(solid) / spacing)));
  lattice.parts = solid.parts;
  const auto n = static_cast<Index>(sites.size());
  lattice.cell.resize(dim, n);
  lattice.position.resize(dim, n);
  lattice.shift.resize(dim, n);
  lattice.share.resize(n);
  lattice.number.assign(static_cast<std::size_t>(lattice.extent.template cast<long>().prod()), -1);
  Index i = 0;
  for (const auto& [at, site] : sites) {
    lattice.cell.col(i) = at - low;
    std::size_t k = 0;
    for (int axis = 0; axis < dim; ++axis) {
      k = k * static_cast<std::size_t>(lattice.extent[axis]) + static_cast<std::size_t>(at[axis] - low[axis]);
      lattice.shift(axis, i) = site.shift[axis];
      lattice.position(axis, i) = placement.origin[axis] + (at[axis] + 0.5 + site.shift[axis]) * spacing;
    }
    lattice.share[i] = site.share;
    lattice.number[k] = static_cast<int>(i++);
    lattice.fixed.push_back(site.fixed);
    lattice.inside.push_back(site.inside);
    lattice.part.push_back(site.part);
  }
  return lattice;
}

template <int dim>
MassProperties mass_of(const Lattice<dim>& lattice) {
  MassProperties body;
  const double own = lattice.spacing * lattice.spacing / 12;  // ∫x² of a unit volume about its centre
  const Eigen::Vector3d origin = lattice.place(0);
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (Index i = 0; i < lattice.size(); ++i) {
    if (!lattice.inside[static_cast<std::size_t>(i)]) continue;
    const double m = lattice.material(i).density * lattice.volume(i);
    const Eigen::Vector3d x = lattice.place(i) - origin;
    body.mass += m;
    first += m * x;
    second += m * x * x.transpose();
    for (int axis = 0; axis < dim; ++axis) second(axis, axis) += m * own;
  }
  const Eigen::Vector3d centre = first / body.mass;
  body.centre = origin + centre;
  second -= body.mass * centre * centre.transpose();
  body.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return body;
}

namespace {

/// The part that ends at a plane, for planes cut other parts too.
std::string part_at_plane(const Solid& solid, int axis, double coordinate) {
  for (std::size_t p = 0; p < solid.parts.size(); ++p) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (Index c = 0; c < solid.cell.cols(); ++c) {
      if (solid.part_of[static_cast<std::size_t>(c)] != static_cast<int>(p)) continue;
      low = std::min(low, solid.node(axis, solid.cell(0, c)));
      high = std::max(high, solid.node(axis, solid.cell(solid.cell.rows() - 1, c)));
    }
    if (low == coordinate || high == coordinate) return solid.parts[p].name;
  }
  return "boxes";  // the part that ends there is covered by others
}

}  // namespace

namespace {

SolidFault fault_of_boxes(const Solid& solid, double spacing) {
  constexpr int layers = 2;  // through each part: below that a bond sees no bending
  const double thin = thinnest(solid), measure = common_measure(solid);
  const double fitting =
      measure / std::ceil(std::max(measure / spacing, layers * measure / thin) * (1 - file_decimals));
  // Planes without a practical common measure: no lattice of a feasible size fits them.
  const std::string fix = fitting > 0.02 * thin
                              ? fmt::format("spacing = {:.6g}", fitting)
                              : fmt::format("move the planes to whole multiples of {:.6g}", thin / 4);
  for (int axis = 0; axis < solid.dimension; ++axis)
    for (const double plane : solid.plane[static_cast<std::size_t>(axis)]) {
      const double n = (plane - solid.plane[static_cast<std::size_t>(axis)].front()) / spacing;
      if (std::abs(n - std::round(n)) < file_decimals * std::max(1.0, n)) continue;
      return {fmt::format(
                  "box \"{}\" has a side at {} = {:.6g} m, {:.6g} spacings of {:.6g} m from the body's first "
                  "side, and not a whole number",
                  part_at_plane(solid, axis, plane), "xyz"[axis], plane, n, spacing),
              fix};
    }
  for (std::size_t p = 0; p < solid.parts.size(); ++p) {
    Solid part = solid;
    part.parts = {solid.parts[p]};
    Index kept = 0;
    for (Index c = 0; c < solid.cell.cols(); ++c)
      if (solid.part_of[static_cast<std::size_t>(c)] == static_cast<int>(p))
        part.cell.col(kept++) = solid.cell.col(c);
    part.cell.conservativeResize(Eigen::NoChange, kept);
    part.part_of.assign(static_cast<std::size_t>(kept), 0);
    const double across = thinnest(part);
    if (across < (layers - file_decimals) * spacing)
      return {fmt::format("box \"{}\" is {:.6g} m thin, {:.6g} layers of {:.6g} m: at least {}",
                          solid.parts[p].name, across, across / spacing, spacing, layers),
              fix};
  }
  return {};
}

template <int dim>
SolidFault fault_of_samples(const Solid& solid, double spacing) {
  constexpr double gate = 0.01;
  const double thin = thinnest(solid);
  if (thin < 2 * spacing * (1 - file_decimals))
    return {fmt::format("a part is {:.6g} m thin, {:.3g} layers of {:.6g} m: at least 2", thin,
                        thin / spacing, spacing),
            fmt::format("spacing = {:.6g}", thin / 4)};
  const MassProperties body = mass_of(solid);
  const Lattice<dim> lattice = make_lattice<dim>(solid, spacing, 1.5, ClampColumn::inside, Places::cells);
  if (lattice.size() == 0) return {"no lattice cell lies in it", fmt::format("spacing = {:.6g}", thin / 4)};
  const MassProperties particles = mass_of(lattice);
  const double mass = particles.mass / body.mass - 1,
               inertia = particles.inertia(2, 2) / body.inertia(2, 2) - 1;
  if (std::abs(mass) <= gate && std::abs(inertia) <= gate) return {};
  return {
      fmt::format("particles of {:.6g} m have {:+.2f} % of its mass and {:+.2f} % of its moment of inertia "
                  "too much: at most 1 %",
                  spacing, 100 * mass, 100 * inertia),
      fmt::format("spacing = {:.6g}", spacing / 2)};
}

}  // namespace

SolidFault lattice_fault(const Solid& solid, double spacing) {
  if (solid.along_axes()) return fault_of_boxes(solid, spacing);
  return solid.dimension == 2 ? fault_of_samples<2>(solid, spacing) : fault_of_samples<3>(solid, spacing);
}

template Lattice<2> make_lattice<2>(const Solid&, double, double, ClampColumn, Places);
template Lattice<3> make_lattice<3>(const Solid&, double, double, ClampColumn, Places);
template MassProperties mass_of<2>(const Lattice<2>&);
template MassProperties mass_of<3>(const Lattice<3>&);

}  // namespace strake::structure
