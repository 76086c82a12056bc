#include "proto/error.hpp"
#include "structure/particle/bonds.hpp"
#include "structure/particle/lattice.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace strake::structure {
namespace {

using Eigen::Index;

/// A lattice cell between 2^dim particles from which a place is interpolated, and the position of the place
/// in it.
template <int dim>
struct Block {
  Eigen::Matrix<int, dim, 1> base;
  Eigen::Matrix<double, dim, 1> within;
  int shifted = 0;  // axes along which the place lies beside the block
};

/// True if all corners of a block have particles, and these stand in the middles of their cells.
template <int dim>
bool is_complete(const Lattice<dim>& lattice, const Eigen::Matrix<int, dim, 1>& base) {
  for (int corner = 0; corner < 1 << dim; ++corner) {
    Eigen::Matrix<int, dim, 1> at = base;
    for (int axis = 0; axis < dim; ++axis) at[axis] += (corner >> axis) & 1;
    if (const Index i = lattice.index(at); i < 0 || !lattice.shift.col(i).isZero(0)) return false;
  }
  return true;
}

/// Finds the block of 2^dim lattice sites around a place. If it lacks a particle, finds the blocks beside it
/// that reach the place by half a spacing, shifted along as few axes as possible. At an inner corner of the
/// body there are two, of equal weight.
template <int dim>
std::vector<Block<dim>> blocks_at(const Lattice<dim>& lattice, const Eigen::Matrix<double, dim, 1>& s) {
  using Cell = Eigen::Matrix<int, dim, 1>;
  Cell natural;
  for (int axis = 0; axis < dim; ++axis) natural[axis] = static_cast<int>(std::floor(s[axis]));
  std::vector<Block<dim>> best;
  for_each_cell<dim>(natural - Cell::Ones(), natural + 2 * Cell::Ones(), [&](const Cell& base) {
    Block<dim> block{base, s - base.template cast<double>(), (base - natural).cwiseAbs().sum()};
    const bool in_reach =
        block.within.minCoeff() >= -0.5 - file_decimals && block.within.maxCoeff() <= 1.5 + file_decimals;
    if (!in_reach || (!best.empty() && block.shifted > best.front().shifted)) return;
    if (!is_complete<dim>(lattice, base)) return;
    if (!best.empty() && block.shifted < best.front().shifted) best.clear();
    best.push_back(block);
  });
  return best;
}

template <int dim>
using Cells = std::vector<Eigen::Matrix<int, dim, 1>>;

/// Collects the cells with particles around a place, at most two from it along any axis. They are connected
/// over their sides to the nearest one, so that none belongs to another wall across a slot.
template <int dim>
Cells<dim> cells_around(const Lattice<dim>& lattice, const Eigen::Matrix<double, dim, 1>& s) {
  constexpr int reach = 2;
  using Cell = Eigen::Matrix<int, dim, 1>;
  Cell natural;
  for (int axis = 0; axis < dim; ++axis) natural[axis] = static_cast<int>(std::lround(s[axis]));
  Cells<dim> found;
  double least = std::numeric_limits<double>::infinity();
  for_each_cell<dim>(natural - Cell::Ones(), natural + 2 * Cell::Ones(), [&](const Cell& at) {
    const double distance = (at.template cast<double>() - s).squaredNorm();
    if (lattice.index(at) < 0 || distance >= least) return;
    least = distance;
    found.assign(1, at);
  });
  for (std::size_t k = 0; k < found.size(); ++k)
    for (int axis = 0; axis < dim; ++axis)
      for (const int step : {-1, 1}) {
        Cell at = found[k];
        at[axis] += step;
        if (lattice.index(at) < 0 || (at - found.front()).cwiseAbs().maxCoeff() > reach ||
            std::find(found.begin(), found.end(), at) != found.end())
          continue;
        found.push_back(at);
      }
  return found;
}

/// The particles of some cells from a place on [spacing], one column each.
template <int dim>
Vectors<dim> from_place(const Lattice<dim>& lattice, const Cells<dim>& cells,
                        const Eigen::Matrix<double, dim, 1>& s) {
  Vectors<dim> r(dim, static_cast<Index>(cells.size()));
  for (std::size_t k = 0; k < cells.size(); ++k)
    r.col(static_cast<Index>(k)) =
        cells[k].template cast<double>() + lattice.shift.col(lattice.index(cells[k])) - s;
  return r;
}

/// Weights of particles in a fit at a place, w_k = (1 − |r_k|²/R²)², R from the nearest particle on. That is
/// the first.
template <int dim>
Eigen::VectorXd weights_of_fit(const Vectors<dim>& r) {
  const Eigen::VectorXd distance = r.colwise().norm();
  const double reach = distance[0] + 2.3;  // the nearest, and two of its neighbours on each side
  Eigen::VectorXd weight(r.cols());
  for (Index k = 0; k < r.cols(); ++k)
    weight[k] = std::pow(std::max(0.0, 1 - std::pow(distance[k] / reach, 2)), 2);
  return weight;
}

/// Weights of the least-squares linear field through the values in the cells, at a place:
///   w_k pᵀ_k M⁻¹ p(s),  M = Σ w_k p_k pᵀ_k,  p_k = (1, r_k)
/// The value at the place itself is the first component of the fit.
template <int dim>
Eigen::VectorXd fitted(const Lattice<dim>& lattice, const Cells<dim>& cells,
                       const Eigen::Matrix<double, dim, 1>& s) {
  constexpr int terms = dim + 1;
  if (cells.empty()) return {};
  const Vectors<dim> r = from_place<dim>(lattice, cells, s);
  const Eigen::VectorXd weight = weights_of_fit<dim>(r);
  Eigen::Matrix<double, terms, Eigen::Dynamic> p(terms, r.cols());
  p << Eigen::RowVectorXd::Ones(r.cols()), r;
  const Eigen::Matrix<double, terms, terms> M = p * weight.asDiagonal() * p.transpose();
  const Eigen::FullPivLU<Eigen::Matrix<double, terms, terms>> lu(M);
  if (!lu.isInvertible()) return {};
  return weight.asDiagonal() * (p.transpose() * lu.solve(Eigen::Matrix<double, terms, 1>::Unit(0)));
}

/// A place in spacings from the middle of cell 0.
template <int dim>
Eigen::Matrix<double, dim, 1> in_cells(const Lattice<dim>& lattice, const Eigen::Vector3d& X) {
  const Eigen::Matrix<double, dim, 1> origin =
      lattice.position.col(0) -
      lattice.spacing * (lattice.cell.col(0).template cast<double>() + lattice.shift.col(0));
  Eigen::Matrix<double, dim, 1> s;
  for (int axis = 0; axis < dim; ++axis) s[axis] = (X[axis] - origin[axis]) / lattice.spacing;
  return s;
}

// Of the particles of a flat face 0.43, of the row behind them 0.02; none between. Of oblique faces' cut
// cells 0.2 to 0.5.
constexpr double most_one_sided = 0.15;
// Σ |weight| of a place two spacings from two rows, along which the field is linear, is 4.
constexpr double most_extrapolated = 8;

/// |Σ w⁰ r⁰| / Σ w⁰ |r⁰| over the bonds of a particle: 0 if these lie around it evenly.
template <int dim>
double one_sidedness(const Bonds<dim>& bonds, Index i) {
  Eigen::Matrix<double, dim, 1> sum = Eigen::Matrix<double, dim, 1>::Zero();
  double size = 0;
  for (Index b = bonds.first(i); b < bonds.end(i); ++b) {
    sum += bonds.weight[b] * bonds.r0.col(b);
    size += bonds.weight[b] * bonds.r0.col(b).norm();
  }
  return size > 0 ? sum.norm() / size : 1;
}

}  // namespace

template <int dim>
SparseRows interpolation(const Lattice<dim>& lattice, const Points& at) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index p = 0; p < at.cols(); ++p) {
    const auto add = [&](const Eigen::Matrix<int, dim, 1>& cell, double weight) {
      if (weight != 0)
        entries.emplace_back(static_cast<int>(p), static_cast<int>(lattice.index(cell)), weight);
    };
    const Eigen::Matrix<double, dim, 1> s = in_cells<dim>(lattice, at.col(p));
    const auto blocks = blocks_at<dim>(lattice, s);
    for (const Block<dim>& block : blocks)
      for (int corner = 0; corner < 1 << dim; ++corner) {
        double weight = 1 / static_cast<double>(blocks.size());
        Eigen::Matrix<int, dim, 1> cell = block.base;
        for (int axis = 0; axis < dim; ++axis) {
          const int far = (corner >> axis) & 1;
          weight *= far ? block.within[axis] : 1 - block.within[axis];
          cell[axis] += far;
        }
        add(cell, weight);
      }
    if (!blocks.empty()) continue;
    const Cells<dim> cells = cells_around<dim>(lattice, s);
    const Eigen::VectorXd weight = fitted<dim>(lattice, cells, s);
    if (weight.size() == 0)
      throw Error(
          ExitCode::case_file, "structure, particle",
          fmt::format("the place ({:.6g}, {:.6g}, {:.6g}) m has too few particles around it: the body is "
                      "too thin there for particles {:.4g} m apart",
                      at(0, p), at(1, p), at(2, p), lattice.spacing),
          fmt::format("structure.particle.spacing = {:.3g}, or smaller: four layers across the "
                      "thickness (where coupling.interface = \"volume\" it is fluid.spacing)",
                      0.5 * lattice.spacing));
    for (std::size_t k = 0; k < cells.size(); ++k) add(cells[k], weight[static_cast<Index>(k)]);
  }
  SparseRows N(at.cols(), lattice.size());
  N.setFromTriplets(entries.begin(), entries.end());
  return N;
}

template <int dim>
std::optional<Eigen::VectorXd> extrapolation(const Lattice<dim>& lattice, const Bonds<dim>& bonds,
                                             const Eigen::Vector3d& X) {
  const Eigen::Matrix<double, dim, 1> s = in_cells<dim>(lattice, X);
  Cells<dim> cells = cells_around<dim>(lattice, s);
  const auto particle = [&](const auto& cell) { return lattice.index(cell); };
  const auto part = [&](const auto& cell) { return lattice.part[static_cast<std::size_t>(particle(cell))]; };
  const int own = cells.empty() ? 0 : part(cells.front());
  std::erase_if(cells, [&](const auto& cell) {
    return part(cell) != own || one_sidedness<dim>(bonds, particle(cell)) > most_one_sided;
  });
  const Eigen::VectorXd weight = fitted<dim>(lattice, cells, s);
  if (weight.size() == 0 || weight.cwiseAbs().sum() > most_extrapolated) return std::nullopt;
  Eigen::VectorXd row = Eigen::VectorXd::Zero(lattice.size());
  for (std::size_t k = 0; k < cells.size(); ++k) row[particle(cells[k])] = weight[static_cast<Index>(k)];
  return row;
}

template std::optional<Eigen::VectorXd> extrapolation<2>(const Lattice<2>&, const Bonds<2>&,
                                                         const Eigen::Vector3d&);
template std::optional<Eigen::VectorXd> extrapolation<3>(const Lattice<3>&, const Bonds<3>&,
                                                         const Eigen::Vector3d&);
template SparseRows interpolation<2>(const Lattice<2>&, const Points&);
template SparseRows interpolation<3>(const Lattice<3>&, const Points&);

}  // namespace strake::structure
