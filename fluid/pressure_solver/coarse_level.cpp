#include "fluid/pressure_solver/coarse_level.hpp"

#include <omp.h>

#include <cmath>

namespace strake::fluid {
namespace {

/// A level with no more unknowns than this is solved by a dense factorisation.
constexpr std::int32_t direct_size = 160;
/// Number of unknowns below which one thread computes a level: waiting would cost more. Building it has one
/// wait, a cycle has seven.
constexpr std::int32_t rows_for_team = 6000, rows_for_making = 600;
/// Number of sweeps on a last level that does not get smaller, one of scattered drops. Jacobi is nearly exact
/// there.
constexpr int last_sweeps = 4;
/// Damping of the sweeps; of 0.9, 1.0 and 1.1 none took fewer iterations.
constexpr double damping = 0.9;

void transpose(const SparseRows& rows, std::int32_t columns, SparseRows& out) {
  out.start.assign(static_cast<std::size_t>(columns) + 1, 0);
  out.column.resize(rows.column.size());
  out.value.resize(rows.value.size());
  for (const std::int32_t c : rows.column) ++out.start[static_cast<std::size_t>(c) + 1];
  for (std::size_t c = 1; c < out.start.size(); ++c) out.start[c] += out.start[c - 1];
  std::vector<std::int32_t> next(out.start.begin(), out.start.end() - 1);
  for (std::int32_t i = 0; i < rows.rows(); ++i)
    for (std::int32_t e = rows.start[static_cast<std::size_t>(i)];
         e < rows.start[static_cast<std::size_t>(i) + 1]; ++e) {
      const auto from = static_cast<std::size_t>(e);
      const auto to = static_cast<std::size_t>(next[static_cast<std::size_t>(rows.column[from])]++);
      out.column[to] = i;
      out.value[to] = rows.value[from];
    }
}

}  // namespace

void join(const std::vector<SparseRows>& parts, SparseRows& whole) {
  whole.clear();
  for (const SparseRows& part : parts) {
    const std::int32_t offset = whole.start.back();
    for (std::size_t i = 1; i < part.start.size(); ++i) whole.start.push_back(offset + part.start[i]);
    whole.column.insert(whole.column.end(), part.column.begin(), part.column.end());
    whole.value.insert(whole.value.end(), part.value.begin(), part.value.end());
  }
}

double RowGatherer::finish(std::int32_t row, SparseRows& rows) {
  double diagonal = 0;
  for (std::size_t e = 0; e < column_.size(); ++e) {
    place_[static_cast<std::size_t>(column_[e])] = -1;
    if (column_[e] == row) {
      diagonal = value_[e];
    } else {
      rows.column.push_back(column_[e]);
      rows.value.push_back(static_cast<float>(value_[e]));
    }
  }
  rows.start.push_back(static_cast<std::int32_t>(rows.column.size()));
  column_.clear();
  value_.clear();
  return diagonal;
}

template <int dim>
void CoarseLevel<dim>::prepare() {
  const auto n = static_cast<std::size_t>(unknowns());
  inverse.resize(n);
  right.resize(n);
  solution.resize(n);
  rest.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    double off = 0;
    for (std::int32_t e = matrix.start[i]; e < matrix.start[i + 1]; ++e)
      off += std::abs(static_cast<double>(matrix.value[static_cast<std::size_t>(e)]));
    inverse[i] = static_cast<float>(damped_inverse(diagonal[i], off, damping));
  }
}

template <int dim>
void CoarseLevel<dim>::add_vertex(const std::array<std::int32_t, 3>& vertex, CoarseLevel& next,
                                  Search& search) {
  auto& [slot, reached, part] = search;
  const std::array<std::int32_t, 3> centre{2 * vertex[0], 2 * vertex[1], dim == 3 ? 2 * vertex[2] : 0};
  std::array<std::int32_t, 3> low{}, high{};
  for (std::size_t d = 0; d < 3; ++d) {
    low[d] = std::max(centre[d] - 1, 0);
    high[d] = std::min(centre[d] + 1, size[d] - 1);
  }
  reached.clear();
  for (std::int32_t k = low[2]; k <= high[2]; ++k)
    for (std::int32_t j = low[1]; j <= high[1]; ++j) {
      const std::size_t row = static_cast<std::size_t>((k * size[1] + j) * size[0]);
      for (std::int32_t i = first[row + static_cast<std::size_t>(low[0])];
           low[0] <= high[0] && i < first[row + static_cast<std::size_t>(high[0]) + 1]; ++i)
        reached.push_back(i);
    }
  for (const std::int32_t i : reached) slot[static_cast<std::size_t>(i)] = 0;
  for (const std::int32_t seed : reached) {
    if (slot[static_cast<std::size_t>(seed)] != 0) continue;
    part.assign(1, seed);
    slot[static_cast<std::size_t>(seed)] = 1;
    for (std::size_t at = 0; at < part.size(); ++at) {
      const auto i = static_cast<std::size_t>(part[at]);
      for (std::int32_t e = matrix.start[i]; e < matrix.start[i + 1]; ++e) {
        const std::int32_t j = matrix.column[static_cast<std::size_t>(e)];
        if (slot[static_cast<std::size_t>(j)] != 0) continue;
        slot[static_cast<std::size_t>(j)] = 1;
        part.push_back(j);
      }
    }
    Place at{};
    for (std::size_t d = 0; d < dim; ++d) at[d] = vertex[d];
    next.place.push_back(at);
    for (const std::int32_t i : part) {
      float weight = 1;
      for (std::size_t d = 0; d < dim; ++d)
        if (place[static_cast<std::size_t>(i)][d] != centre[d]) weight *= 0.5f;
      restriction.column.push_back(i);
      restriction.value.push_back(weight);
    }
    restriction.start.push_back(static_cast<std::int32_t>(restriction.column.size()));
  }
  for (const std::int32_t i : reached) slot[static_cast<std::size_t>(i)] = -1;
  next.first.push_back(next.unknowns());
}

template <int dim>
void CoarseLevel<dim>::multiply_out(CoarseLevel& next, int threads) const {
  const std::int32_t n = next.unknowns();
  next.diagonal.resize(static_cast<std::size_t>(n));
  std::vector<SparseRows> parts(static_cast<std::size_t>(threads));
#pragma omp parallel num_threads(threads) if (threads > 1)
  {
    const Team team{omp_get_thread_num(), omp_get_num_threads(), nullptr};
    SparseRows& rows = parts[static_cast<std::size_t>(team.index)];
    RowGatherer gatherer;
    gatherer.resize(n);
    const auto [begin, end] = team.share(n);
    const auto spread = [&](std::int32_t i, double value) {
      const auto row = static_cast<std::size_t>(i);
      for (std::int32_t e = prolongation.start[row]; e < prolongation.start[row + 1]; ++e)
        gatherer.add(prolongation.column[static_cast<std::size_t>(e)],
                     value * prolongation.value[static_cast<std::size_t>(e)]);
    };
    for (auto c = static_cast<std::int32_t>(begin); c < end; ++c) {
      for (std::int32_t e = restriction.start[static_cast<std::size_t>(c)];
           e < restriction.start[static_cast<std::size_t>(c) + 1]; ++e) {
        const auto i = static_cast<std::size_t>(restriction.column[static_cast<std::size_t>(e)]);
        const double weight = restriction.value[static_cast<std::size_t>(e)];
        spread(static_cast<std::int32_t>(i), weight * diagonal[i]);
        for (std::int32_t f = matrix.start[i]; f < matrix.start[i + 1]; ++f)
          spread(matrix.column[static_cast<std::size_t>(f)],
                 weight * matrix.value[static_cast<std::size_t>(f)]);
      }
      next.diagonal[static_cast<std::size_t>(c)] = static_cast<float>(gatherer.finish(c, rows));
    }
  }
  join(parts, next.matrix);
}

template <int dim>
bool CoarseLevel<dim>::coarsen(CoarseLevel& next, int threads) {
  next.place.clear();
  next.first.assign(1, 0);
  for (std::size_t d = 0; d < 3; ++d) next.size[d] = d < dim ? size[d] / 2 + 1 : 1;
  restriction.clear();
  Search search{.slot = std::vector<std::int32_t>(place.size(), -1)};
  for (std::int32_t z = 0; z < next.size[2]; ++z)
    for (std::int32_t y = 0; y < next.size[1]; ++y)
      for (std::int32_t x = 0; x < next.size[0]; ++x) add_vertex({x, y, z}, next, search);
  if (next.unknowns() > 0.8 * unknowns()) return false;
  transpose(restriction, unknowns(), prolongation);
  multiply_out(next, threads);
  next.prepare();
  return true;
}

template <int dim>
void GridCycle<dim>::build(int threads) {
  used_ = 1;
  for (;;) {
    if (levels_.size() == static_cast<std::size_t>(used_)) levels_.emplace_back();
    CoarseLevel<dim>& last = levels_[static_cast<std::size_t>(used_) - 1];
    if (last.unknowns() <= direct_size) break;
    if (!last.coarsen(levels_[static_cast<std::size_t>(used_)],
                      last.unknowns() >= rows_for_making ? threads : 1))
      break;
    ++used_;
  }
  const CoarseLevel<dim>& last = levels_[static_cast<std::size_t>(used_) - 1];
  const std::int32_t n = last.unknowns();
  direct_ = n <= direct_size;
  if (!direct_) return;
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(n, n);
  for (std::int32_t i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    // A small addition to the diagonal keeps the factor positive where nothing else does. One case is an
    // unknown without particles (all its weights are nil). Another is a connected set with neither P = 0 nor
    // compressibility.
    const double d = last.diagonal[row];
    full(i, i) = d > 0 ? d * (1 + 1e-6) : 1;
    for (std::int32_t e = last.matrix.start[row]; e < last.matrix.start[row + 1]; ++e)
      full(i, last.matrix.column[static_cast<std::size_t>(e)]) =
          last.matrix.value[static_cast<std::size_t>(e)];
  }
  factor_.compute(full);
  direct_ = factor_.info() == Eigen::Success;
}

template <int dim>
void GridCycle<dim>::solve_last() {
  CoarseLevel<dim>& last = levels_[static_cast<std::size_t>(used_) - 1];
  const std::int32_t n = last.unknowns();
  if (direct_) {
    dense_ = Eigen::Map<const Eigen::VectorXf>(last.right.data(), n).cast<double>();
    factor_.solveInPlace(dense_);
    Eigen::Map<Eigen::VectorXf>(last.solution.data(), n) = dense_.cast<float>();
    return;
  }
  const float *b = last.right.data(), *inverse = last.inverse.data(), *diagonal = last.diagonal.data();
  float *x = last.solution.data(), *r = last.rest.data();
  for (std::int32_t i = 0; i < n; ++i) x[i] = inverse[i] * b[i];
  for (int sweep = 1; sweep < last_sweeps; ++sweep) {
    for (std::int32_t i = 0; i < n; ++i) r[i] = b[i] - diagonal[i] * x[i] - last.matrix.times(x, i);
    for (std::int32_t i = 0; i < n; ++i) x[i] += inverse[i] * r[i];
  }
}

/// Computes one cycle from this level down:
///   x = D⁻¹b; x += P A_c⁻¹ Pᵀ(b − A x); x += D⁻¹(b − A x).
/// The two sweeps are equal, so that the whole is symmetric.
template <int dim>
void GridCycle<dim>::descend(std::size_t level, const Team& team) {
  if (level + 1 == static_cast<std::size_t>(used_)) {
    if (team.first()) solve_last();
    return;
  }
  CoarseLevel<dim>& here = levels_[level];
  CoarseLevel<dim>& next = levels_[level + 1];
  if (team.count > 1 && here.unknowns() < rows_for_team) {
    if (team.first()) descend(level, Team{});
    return;
  }
  const auto [begin, end] = team.share(here.unknowns());
  const auto [next_begin, next_end] = team.share(next.unknowns());
  const float *b = here.right.data(), *inverse = here.inverse.data(), *diagonal = here.diagonal.data();
  float *x = here.solution.data(), *r = here.rest.data();
  for (std::int64_t i = begin; i < end; ++i) x[i] = inverse[i] * b[i];
  team.wait();
  for (std::int64_t i = begin; i < end; ++i) r[i] = b[i] - diagonal[i] * x[i] - here.matrix.times(x, i);
  team.wait();
  for (std::int64_t c = next_begin; c < next_end; ++c)
    next.right[static_cast<std::size_t>(c)] = here.restriction.times(r, c);
  team.wait();
  descend(level + 1, team);
  team.wait();
  const float* coarse = next.solution.data();
  for (std::int64_t i = begin; i < end; ++i) x[i] += here.prolongation.times(coarse, i);
  team.wait();
  for (std::int64_t i = begin; i < end; ++i) r[i] = b[i] - diagonal[i] * x[i] - here.matrix.times(x, i);
  team.wait();
  for (std::int64_t i = begin; i < end; ++i) x[i] += inverse[i] * r[i];
}

template <int dim>
std::size_t GridCycle<dim>::bytes() const {
  const auto of = [](const SparseRows& rows) {
    return 4 * (rows.start.capacity() + rows.column.capacity() + rows.value.capacity());
  };
  std::size_t sum = 0;
  for (const CoarseLevel<dim>& level : levels_)
    sum += of(level.matrix) + of(level.restriction) + of(level.prolongation) +
           4 * (dim * level.place.capacity() + level.first.capacity() + 5 * level.right.capacity());
  return sum + (direct_ ? 8 * static_cast<std::size_t>(dense_.size() * dense_.size()) : 0);
}

template struct CoarseLevel<2>;
template struct CoarseLevel<3>;
template class GridCycle<2>;
template class GridCycle<3>;

}  // namespace strake::fluid
