#include "structure/particle/sites.hpp"

#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace strake::structure {
namespace {

using Eigen::Index;

/// Position of the lattice along an axis. It is the plane that has most of the boundary, so that flat faces
/// are met exactly. Without such a plane it is the middle of the body.
double plane_of_lattice(const Solid& solid, int axis, double spacing) {
  constexpr double flat = 1e-9;  // 1 − cosine of the angle to the axis
  const double low = solid.node.row(axis).minCoeff(), high = solid.node.row(axis).maxCoeff();
  const double near = 1e-9 * (high - low);
  std::map<long long, double> size;  // of the facets in each plane
  for (int f = 0; f < solid.facet.cols(); ++f) {
    const Eigen::Vector3d normal = facet_normal(solid, f);
    if (std::abs(normal[axis]) > (1 - flat) * normal.norm())
      size[std::llround((solid.node(axis, solid.facet(0, f)) - low) / near)] += normal.norm();
  }
  double most = 0, plane = 0.5 * (low + high) - 0.5 * spacing * std::round((high - low) / spacing);
  for (const auto& [at, area] : size)
    if (area > most * (1 + 1e-6)) {
      most = area;
      plane = low + static_cast<double>(at) * near;
    }
  return plane;
}

/// Samples a body's volume on a lattice `fineness` times as fine as that of the particles. Each sample has
/// the index of its part, or -1 outside.
template <int dim>
class Samples {
 public:
  using Cell = Eigen::Matrix<int, dim, 1>;
  using Place = Eigen::Matrix<double, dim, 1>;

  Samples(const Solid& solid, const Place& origin, double spacing) {
    const double round_off = 1e-9 * spacing;
    for (int axis = 0; axis < dim; ++axis) {
      first[axis] = static_cast<int>(std::floor((solid.node.row(axis).minCoeff() - origin[axis]) / spacing));
      end[axis] = static_cast<int>(std::ceil((solid.node.row(axis).maxCoeff() - origin[axis]) / spacing));
    }
    const double fine = spacing / fineness;
    part_.assign(static_cast<std::size_t>(((end - first) * fineness).template cast<long>().prod()), -1);
    const Place lowest = origin + spacing * first.template cast<double>();
    for (int c = 0; c < solid.cell.cols(); ++c) {
      const Eigen::Matrix4Xd planes = half_spaces(solid, c);
      Place low = solid.node.col(solid.cell(0, c)).template head<dim>(), high = low;
      for (Index k = 1; k < solid.cell.rows(); ++k) {
        low = low.cwiseMin(solid.node.col(solid.cell(k, c)).template head<dim>());
        high = high.cwiseMax(solid.node.col(solid.cell(k, c)).template head<dim>());
      }
      Cell from, to;
      for (int axis = 0; axis < dim; ++axis) {
        from[axis] = std::max(0, static_cast<int>(std::floor((low[axis] - lowest[axis]) / fine)));
        to[axis] = std::min((end[axis] - first[axis]) * fineness,
                            static_cast<int>(std::ceil((high[axis] - lowest[axis]) / fine)));
      }
      for_each_cell<dim>(from, to, [&](const Cell& at) {
        Eigen::Vector3d X = Eigen::Vector3d::Zero();
        X.head<dim>() = lowest + fine * (at.template cast<double>().array() + 0.5).matrix();
        if ((X.transpose() * planes.topRows<3>() - planes.row(3)).maxCoeff() <= round_off)
          part_[index(at)] = static_cast<std::int16_t>(solid.part_of[static_cast<std::size_t>(c)]);
      });
    }
  }

  /// How many samples of a lattice cell lie in each part, over all of them.
  std::map<int, double> shares(const Cell& cell) const {
    std::map<int, double> share;
    const Cell from = (cell - first) * fineness;
    for_each_cell<dim>(from, from + Cell::Constant(fineness), [&](const Cell& at) {
      if (const int part = part_[index(at)]; part >= 0) share[part] += 1;
    });
    for (auto& [part, value] : share) value /= std::pow(fineness, dim);
    return share;
  }

  /// First moment of the samples of a lattice cell that lie in the body, about the cell's middle [spacing],
  /// over the number of all samples.
  Eigen::Vector3d moment(const Cell& cell) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const Cell from = (cell - first) * fineness;
    for_each_cell<dim>(from, from + Cell::Constant(fineness), [&](const Cell& at) {
      if (part_[index(at)] >= 0)
        sum.head<dim>() += (((at - from).template cast<double>().array() + 0.5) / fineness - 0.5).matrix();
    });
    return sum / std::pow(fineness, dim);
  }

  Cell first, end;  // lattice cells around the body

 private:
  static constexpr int fineness = dim == 2 ? 8 : 4;
  std::size_t index(const Cell& at) const {
    std::size_t k = 0;
    for (int axis = 0; axis < dim; ++axis)
      k = k * static_cast<std::size_t>((end[axis] - first[axis]) * fineness) +
          static_cast<std::size_t>(at[axis]);
    return k;
  }
  std::vector<std::int16_t> part_;
};

/// What a piece of the body in a lattice cell has: its volume over that of a cell, and its first moment about
/// the cell's middle [spacing].
struct Piece {
  double share = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
};

/// Adds the piece in a cell without a particle to its neighbours. These are the ones over a side, or else
/// those over a corner. The sites' shift is their moment until all have received theirs.
template <int dim>
void give_away(const Eigen::Matrix<int, dim, 1>& cell, const Piece& piece, Sites<dim>& sites) {
  using Cell = Eigen::Matrix<int, dim, 1>;
  using Taker = std::pair<Site*, Cell>;
  std::vector<Taker> beside, further;
  for_each_cell<dim>(cell - Cell::Ones(), cell + 2 * Cell::Ones(), [&](const Cell& at) {
    const auto found = sites.find(at);
    if (found == sites.end()) return;
    ((at - cell).cwiseAbs().sum() == 1 ? beside : further).emplace_back(&found->second, at);
  });
  const std::vector<Taker>& takers = beside.empty() ? further : beside;
  for (const auto& [site, at] : takers) {
    const auto part = static_cast<double>(takers.size());
    site->share += piece.share / part;
    Eigen::Vector3d moment = piece.moment;
    moment.head<dim>() += piece.share * (cell - at).template cast<double>();
    site->shift += moment / part;
  }
}

}  // namespace

template <int dim>
Placement<dim> sampled(const Solid& solid, double spacing, Places places) {
  using Cell = Eigen::Matrix<int, dim, 1>;
  Placement<dim> placement;
  for (int axis = 0; axis < dim; ++axis) placement.origin[axis] = plane_of_lattice(solid, axis, spacing);
  const Samples<dim> samples(solid, placement.origin, spacing);
  std::map<Cell, Piece, Before> rest;
  for_each_cell<dim>(samples.first, samples.end, [&](const Cell& at) {
    double whole = 0, most = 0;
    Site site;
    for (const auto& [part, share] : samples.shares(at)) {
      whole += share;
      if (share <= most) continue;
      most = share;
      site.part = part;
    }
    if (whole == 0) return;
    site.share = whole;
    if (whole < 1) site.shift = samples.moment(at);
    site.fixed = solid.parts[static_cast<std::size_t>(site.part)].constrained;
    if (whole >= 0.5)
      placement.sites.emplace(at, site);
    else
      rest.emplace(at, Piece{whole, site.shift});
  });
  // Only cells that have a particle before this loop receive a rest, so that the order has no influence.
  for (const auto& [at, piece] : rest) give_away<dim>(at, piece, placement.sites);
  for (auto& [at, site] : placement.sites) {
    site.shift /= site.share;
    if (places == Places::cells) site.shift.setZero();
  }
  return placement;
}

template Placement<2> sampled<2>(const Solid&, double, Places);
template Placement<3> sampled<3>(const Solid&, double, Places);

}  // namespace strake::structure
