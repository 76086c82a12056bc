#include "fluid/pressure_solver/multilevel.hpp"

#include "fluid/pressure_solver/sparse_row.hpp"

#include <cmath>

namespace strake::fluid {
namespace {

/// Returns (A x)_k without the diagonal, in single precision.
inline float row_times(const PressureSystem& system, const float* x, std::int64_t k) {
  return row_sum(system.value.data(), system.column.data(), x, system.start.data()[k], system.stop.data()[k]);
}

}  // namespace

template <int dim>
void Multilevel<dim>::build(const PressureSystem& system, const Vectors<dim>& position, double radius,
                            double reach, int threads) {
  // Cells are 0.1 % wider than the reach: rounding must not let a row reach beyond the adjacent cells.
  pieces_.sort(system, position, 1.001 * radius, std::pow(reach, dim));
  unknowns_ = nullptr;
  grid_ranks_ = nullptr;
  make_grid(system, threads);
  grids_.build(threads);
}

template <int dim>
void Multilevel<dim>::build(const PressureSystem& system, const RankedUnknowns<dim>& unknowns,
                            GridRanks<dim>& grid_ranks, double full, int threads) {
  pieces_.sort(unknowns, full);
  unknowns_ = &unknowns;
  grid_ranks_ = &grid_ranks;
  make_grid(system, threads);
  grid_ranks.build(grids_.finest());
}

/// Makes the first grid and its equation, once the unknowns are sorted into cells.
template <int dim>
void Multilevel<dim>::make_grid(const PressureSystem& system, int threads) {
  read_rows(system, threads);
  pieces_.split(system, grids_.finest());
  if (grid_ranks_) grid_ranks_->number(*unknowns_, pieces_);
  const auto n = static_cast<std::size_t>(system.size());
  for (std::size_t d = 0; d < dim; ++d) {
    within_[d].resize(pieces_.order.size());
    for (std::size_t s = 0; s < pieces_.order.size(); ++s) {
      const float u = pieces_.at[d][static_cast<std::size_t>(pieces_.order[s])];
      within_[d][s] = u - std::floor(u);
    }
  }
  read_exact_entries(system, threads);
  assemble_grid(threads);
  right_.resize(n);
  swept_.resize(n);
  solution_.resize(n);
  corner_sum_.assign(static_cast<std::size_t>(pieces_.pieces()) * corners, 0);
}

template <int dim>
void Multilevel<dim>::solve_grid(const Team& team) {
  if (grid_ranks_ == nullptr)
    grids_.cycle(team);
  else if (team.first())
    grid_ranks_->solve(grids_.finest());
}

/// Gives the copies of other ranks' unknowns the values of x.
template <int dim>
void Multilevel<dim>::update_copies(const Team& team) {
  if (unknowns_ == nullptr) return;
  if (team.first()) unknowns_->halo->update(*unknowns_->communicator, swept_.data());
  team.wait();
}

template <int dim>
void Multilevel<dim>::apply(const PressureSystem& system, const Team& team) {
  const auto [begin, end] = team.share(system.size());
  const auto [piece_begin, piece_end] = team.share(pieces_.pieces());
  CoarseLevel<dim>& grid = grids_.finest();
  const auto [node_begin, node_end] = team.share(grid.unknowns());
  const float *diagonal = diagonal_.data(), *inverse = inverse_.data();
  const float* b = right_.data();
  float *x = swept_.data(), *r = solution_.data();
  const std::int32_t *order = pieces_.order.data(), *start = pieces_.piece_start.data();
  std::array<const float*, dim> within;
  for (std::size_t d = 0; d < dim; ++d) within[d] = within_[d].data();
  const auto weights_of = [&](std::int32_t s) {
    std::array<float, dim> f;
    for (std::size_t d = 0; d < dim; ++d) f[d] = within[d][s];
    return corner_weights<dim>(f);
  };

  update_copies(team);
  for (std::int64_t k = begin; k < end; ++k) r[k] = b[k] - diagonal[k] * x[k] - row_times(system, x, k);
  team.wait();
  for (std::int64_t p = piece_begin; p < piece_end; ++p) {
    if (!pieces_.owns(static_cast<std::int32_t>(p))) continue;
    std::array<float, corners> sum{};
    for (std::int32_t s = start[p]; s < start[p + 1]; ++s) {
      const auto w = weights_of(s);
      const float rest = r[order[s]];
      for (std::size_t a = 0; a < corners; ++a) sum[a] += w[a] * rest;
    }
    for (std::size_t a = 0; a < corners; ++a) corner_sum_[static_cast<std::size_t>(p) * corners + a] = sum[a];
  }
  team.wait();
  for (std::int64_t i = node_begin; i < node_end; ++i) {
    float sum = 0;
    for (std::int32_t m = pieces_.meeting_start[static_cast<std::size_t>(i)];
         m < pieces_.meeting_start[static_cast<std::size_t>(i) + 1]; ++m)
      sum += corner_sum_[static_cast<std::size_t>(pieces_.meeting[static_cast<std::size_t>(m)])];
    grid.right[static_cast<std::size_t>(i)] = sum;
  }
  team.wait();
  solve_grid(team);
  team.wait();
  const float* coarse = grid.solution.data();
  for (std::int64_t p = piece_begin; p < piece_end; ++p) {
    if (!pieces_.owns(static_cast<std::int32_t>(p))) continue;
    std::array<float, corners> corner;
    for (std::size_t a = 0; a < corners; ++a)
      corner[a] = coarse[pieces_.node[static_cast<std::size_t>(p) * corners + a]];
    for (std::int32_t s = start[p]; s < start[p + 1]; ++s) {
      const auto w = weights_of(s);
      float sum = 0;
      for (std::size_t a = 0; a < corners; ++a) sum += w[a] * corner[a];
      x[order[s]] += sum;
    }
  }
  team.wait();
  update_copies(team);
  for (std::int64_t k = begin; k < end; ++k)
    r[k] = x[k] + inverse[k] * (b[k] - diagonal[k] * x[k] - row_times(system, x, k));
}

template <int dim>
std::size_t Multilevel<dim>::bytes() const {
  std::size_t numbers = diagonal_.capacity() + inverse_.capacity() + excess_.capacity() + right_.capacity() +
                        swept_.capacity() + solution_.capacity() + corner_sum_.capacity();
  for (const auto& m : moment_) numbers += m.capacity();
  for (const auto& w : within_) numbers += w.capacity();
  return 4 * numbers + sizeof(Element) * elements_.capacity() + pieces_.bytes() + grids_.bytes();
}

template class Multilevel<2>;
template class Multilevel<3>;

}  // namespace strake::fluid
