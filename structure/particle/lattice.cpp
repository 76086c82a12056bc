#include "structure/particle/lattice.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace strake::structure {
namespace {

using Eigen::Index;

constexpr double near = 1e-6;  // [spacing] decimals of a case file, not physics

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

struct Site {
  int part = 0;
  bool fixed = false, inside = true;
};

/// Cells in the order of their numbers: x slowest.
struct Before {
  template <class Cell>
  bool operator()(const Cell& a, const Cell& b) const {
    return std::lexicographical_compare(a.data(), a.data() + a.size(), b.data(), b.data() + b.size());
  }
};
template <int dim>
using Sites = std::map<Eigen::Matrix<int, dim, 1>, Site, Before>;

/// The clamp rule of PHYSICS §6 on one facet: the cells behind it, and `beyond` cells in front of it.
template <int dim>
void clamp_facet(const Grid& grid, Index facet, int beyond, bool hold_inside, Sites<dim>& sites) {
  using Cell = Eigen::Matrix<int, dim, 1>;
  const Solid& solid = grid.solid;
  const int c = solid.facet_cell[static_cast<std::size_t>(facet)];
  Cell first, end;
  int normal = 0, direction = 0;
  for (int axis = 0; axis < dim; ++axis) {
    std::tie(first[axis], end[axis]) = grid.range(c, axis);
    const int plane = grid.at(solid.facet(0, facet), axis);
    bool flat = true;
    for (Index k = 1; k < solid.facet.rows(); ++k)
      flat = flat && grid.at(solid.facet(k, facet), axis) == plane;
    if (!flat) continue;
    normal = axis;
    direction = plane == first[axis] ? -1 : 1;
  }
  (direction < 0 ? end[normal] : first[normal]) = direction < 0 ? first[normal] + 1 : end[normal] - 1;
  for_each_cell<dim>(first, end, [&](Cell at) {
    Site& behind = sites.at(at);
    if (hold_inside) behind.fixed = true;
    for (int k = 0; k < beyond; ++k) {
      at[normal] += direction;
      // Another part of the body stands in the way; further clamps may have been there already.
      if (const auto [found, fresh] = sites.emplace(at, Site{behind.part, true, false});
          !fresh && found->second.inside)
        return;
    }
  });
}

}  // namespace

template <int dim>
Lattice<dim> make_lattice(const Solid& solid, double spacing, double radius, ClampColumn clamp) {
  using Cell = typename Lattice<dim>::Cell;
  const Grid grid{solid, spacing};
  Sites<dim> sites;
  for (Index c = 0; c < solid.cell.cols(); ++c) {
    Cell first, end;
    for (int axis = 0; axis < dim; ++axis) std::tie(first[axis], end[axis]) = grid.range(c, axis);
    const int part = solid.part_of[static_cast<std::size_t>(c)];
    const bool held = solid.parts[static_cast<std::size_t>(part)].held;
    for_each_cell<dim>(first, end, [&](const Cell& at) { sites[at] = {part, held, true}; });
  }
  // Two beyond a clamp at least, else the reach of a bond.
  const int beyond = std::max(2, static_cast<int>(std::floor(radius)));
  for (const SupportedFace& face : solid.supported)
    if (face.support == Support::clamped)
      for (const int f : face.facet) clamp_facet<dim>(grid, f, beyond, clamp == ClampColumn::inside, sites);

  Cell low = sites.begin()->first, high = low;
  for (const auto& [at, site] : sites) {
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  Lattice<dim> lattice;
  lattice.spacing = spacing;
  lattice.extent = high - low + Cell::Ones();
  lattice.layers = static_cast<int>(std::lround(thinnest(solid) / spacing));
  lattice.parts = solid.parts;
  const auto n = static_cast<Index>(sites.size());
  lattice.cell.resize(dim, n);
  lattice.position.resize(dim, n);
  lattice.number.assign(static_cast<std::size_t>(lattice.extent.template cast<long>().prod()), -1);
  Index i = 0;
  for (const auto& [at, site] : sites) {
    lattice.cell.col(i) = at - low;
    std::size_t k = 0;
    for (int axis = 0; axis < dim; ++axis) {
      k = k * static_cast<std::size_t>(lattice.extent[axis]) + static_cast<std::size_t>(at[axis] - low[axis]);
      lattice.position(axis, i) =
          solid.plane[static_cast<std::size_t>(axis)].front() + (at[axis] + 0.5) * spacing;
    }
    lattice.number[k] = static_cast<int>(i++);
    lattice.fixed.push_back(site.fixed);
    lattice.inside.push_back(site.inside);
    lattice.part.push_back(site.part);
  }
  return lattice;
}

namespace {

/// The largest length that all distances between planes are whole multiples of [m].
double common_measure(const Solid& solid) {
  double measure = 0;
  for (const std::vector<double>& plane : solid.plane)
    for (std::size_t k = 1; k < plane.size(); ++k) {
      double a = plane[k] - plane[k - 1], b = measure;
      const double round_off = 1e-7 * a;
      while (b > round_off) {  // Euclid
        const double rest = a - b * std::floor(a / b + 1e-7);
        a = b;
        b = std::max(rest, 0.0);
      }
      measure = a;
    }
  return measure;
}

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

SolidFault lattice_fault(const Solid& solid, double spacing) {
  constexpr int layers = 2;  // through each part: below that a bond sees no bending
  const double thin = thinnest(solid), measure = common_measure(solid);
  const double fitting =
      measure / std::ceil(std::max(measure / spacing, layers * measure / thin) * (1 - near));
  // Planes without a common measure to speak of: no lattice of a size that can be run fits them.
  const std::string fix = fitting > 0.02 * thin
                              ? fmt::format("spacing = {:.6g}", fitting)
                              : fmt::format("move the planes to whole multiples of {:.6g}", thin / 4);
  for (int axis = 0; axis < solid.dimension; ++axis)
    for (const double plane : solid.plane[static_cast<std::size_t>(axis)]) {
      const double n = (plane - solid.plane[static_cast<std::size_t>(axis)].front()) / spacing;
      if (std::abs(n - std::round(n)) < near * std::max(1.0, n)) continue;
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
    if (across < (layers - near) * spacing)
      return {fmt::format("box \"{}\" is {:.6g} m thin, {:.6g} layers of {:.6g} m: at least {}",
                          solid.parts[p].name, across, across / spacing, spacing, layers),
              fix};
  }
  return {};
}

namespace {

/// A lattice cell between 2^dim particles that a place is told from, and where in it the place lies.
template <int dim>
struct Block {
  Eigen::Matrix<int, dim, 1> base;
  Eigen::Matrix<double, dim, 1> within;
  int shifted = 0;  // axes along which the place lies beside the block
};

template <int dim>
bool is_complete(const Lattice<dim>& lattice, const Eigen::Matrix<int, dim, 1>& base) {
  for (int corner = 0; corner < 1 << dim; ++corner) {
    Eigen::Matrix<int, dim, 1> at = base;
    for (int axis = 0; axis < dim; ++axis) at[axis] += (corner >> axis) & 1;
    if (lattice.index(at) < 0) return false;
  }
  return true;
}

/// The block that holds the place; if it misses a particle, those beside it that reach the place by half a
/// spacing, along as few axes as that goes. At an inner corner of the body these are two of equal right.
template <int dim>
std::vector<Block<dim>> blocks_at(const Lattice<dim>& lattice, const Eigen::Matrix<double, dim, 1>& s) {
  using Cell = Eigen::Matrix<int, dim, 1>;
  Cell natural;
  for (int axis = 0; axis < dim; ++axis) natural[axis] = static_cast<int>(std::floor(s[axis]));
  std::vector<Block<dim>> best;
  for_each_cell<dim>(natural - Cell::Ones(), natural + 2 * Cell::Ones(), [&](const Cell& base) {
    Block<dim> block{base, s - base.template cast<double>(), (base - natural).cwiseAbs().sum()};
    const bool in_reach = block.within.minCoeff() >= -0.5 - near && block.within.maxCoeff() <= 1.5 + near;
    if (!in_reach || (!best.empty() && block.shifted > best.front().shifted)) return;
    if (!is_complete<dim>(lattice, base)) return;
    if (!best.empty() && block.shifted < best.front().shifted) best.clear();
    best.push_back(block);
  });
  return best;
}

}  // namespace

template <int dim>
SparseRows interpolation(const Lattice<dim>& lattice, const Points& at) {
  const Eigen::Matrix<double, dim, 1> origin =
      lattice.position.col(0) - lattice.spacing * lattice.cell.col(0).template cast<double>();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index p = 0; p < at.cols(); ++p) {
    Eigen::Matrix<double, dim, 1> s;
    for (int axis = 0; axis < dim; ++axis) s[axis] = (at(axis, p) - origin[axis]) / lattice.spacing;
    const auto blocks = blocks_at<dim>(lattice, s);
    if (blocks.empty())
      throw Error(ExitCode::case_file, "structure, particle",
                  fmt::format("the place ({:.6g}, {:.6g}, {:.6g}) m has no particles around it", at(0, p),
                              at(1, p), at(2, p)),
                  "choose a place in the body");
    for (const Block<dim>& block : blocks)
      for (int corner = 0; corner < 1 << dim; ++corner) {
        double weight = 1 / static_cast<double>(blocks.size());
        Eigen::Matrix<int, dim, 1> cell = block.base;
        for (int axis = 0; axis < dim; ++axis) {
          const int far = (corner >> axis) & 1;
          weight *= far ? block.within[axis] : 1 - block.within[axis];
          cell[axis] += far;
        }
        if (weight != 0)
          entries.emplace_back(static_cast<int>(p), static_cast<int>(lattice.index(cell)), weight);
      }
  }
  SparseRows N(at.cols(), lattice.size());
  N.setFromTriplets(entries.begin(), entries.end());
  return N;
}

template Lattice<2> make_lattice<2>(const Solid&, double, double, ClampColumn);
template Lattice<3> make_lattice<3>(const Solid&, double, double, ClampColumn);
template SparseRows interpolation<2>(const Lattice<2>&, const Points&);
template SparseRows interpolation<3>(const Lattice<3>&, const Points&);

}  // namespace strake::structure
