#include "proto/error.hpp"
#include "structure/particle/lattice.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

template <int dim>
bool is_complete(const Lattice<dim>& lattice, const Eigen::Matrix<int, dim, 1>& base) {
  for (int corner = 0; corner < 1 << dim; ++corner) {
    Eigen::Matrix<int, dim, 1> at = base;
    for (int axis = 0; axis < dim; ++axis) at[axis] += (corner >> axis) & 1;
    if (lattice.index(at) < 0) return false;
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

/// Weights of the least-squares linear field through the values in the cells, at a place; w_k decreases with
/// distance:
///   w_k pᵀ_k M⁻¹ p(s),  M = Σ w_k p_k pᵀ_k,  p_k = (1, s_k − s),  w_k = (1 − |s_k − s|²/R²)²
/// The value at the place itself is the first component of the fit.
template <int dim>
Eigen::VectorXd fitted(const Cells<dim>& cells, const Eigen::Matrix<double, dim, 1>& s) {
  constexpr int terms = dim + 1;
  if (cells.empty()) return {};
  const auto n = static_cast<Index>(cells.size());
  Eigen::Matrix<double, terms, Eigen::Dynamic> p(terms, n);
  Eigen::VectorXd weight(n);
  for (Index k = 0; k < n; ++k) p.col(k) << 1, cells[static_cast<std::size_t>(k)].template cast<double>() - s;
  const Eigen::VectorXd distance = p.bottomRows(dim).colwise().norm();
  const double reach = distance[0] + 2.3;  // the nearest, and two of its neighbours on each side
  for (Index k = 0; k < n; ++k) weight[k] = std::pow(std::max(0.0, 1 - std::pow(distance[k] / reach, 2)), 2);
  const Eigen::Matrix<double, terms, terms> M = p * weight.asDiagonal() * p.transpose();
  const Eigen::FullPivLU<Eigen::Matrix<double, terms, terms>> lu(M);
  if (!lu.isInvertible()) return {};
  return weight.asDiagonal() * (p.transpose() * lu.solve(Eigen::Matrix<double, terms, 1>::Unit(0)));
}

}  // namespace

template <int dim>
SparseRows interpolation(const Lattice<dim>& lattice, const Points& at) {
  const Eigen::Matrix<double, dim, 1> origin =
      lattice.position.col(0) - lattice.spacing * lattice.cell.col(0).template cast<double>();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index p = 0; p < at.cols(); ++p) {
    const auto add = [&](const Eigen::Matrix<int, dim, 1>& cell, double weight) {
      if (weight != 0)
        entries.emplace_back(static_cast<int>(p), static_cast<int>(lattice.index(cell)), weight);
    };
    Eigen::Matrix<double, dim, 1> s;
    for (int axis = 0; axis < dim; ++axis) s[axis] = (at(axis, p) - origin[axis]) / lattice.spacing;
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
    const Eigen::VectorXd weight = fitted<dim>(cells, s);
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

template SparseRows interpolation<2>(const Lattice<2>&, const Points&);
template SparseRows interpolation<3>(const Lattice<3>&, const Points&);

}  // namespace strake::structure
