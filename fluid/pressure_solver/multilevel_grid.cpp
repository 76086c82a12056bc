#include "fluid/pressure_solver/multilevel.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

// Computes the first grid's equation, from one pass over the particles' rows.

namespace strake::fluid {
namespace {

/// Distance in cells above which neighbours are connected over the seam of a periodic direction.
constexpr float seam = 1.5f;

/// Damping of the particles' sweep. Of 0.9 to 1.2 it has the fewest iterations, with 2.1 and 3.1 l0. A larger
/// one slows films of one layer down.
constexpr double damping = 0.95;

constexpr float square(float x) {
  return x * x;
}

/// Writes half of each sum Σ_j w_ij r_ij r_ijᵀ of one row.
template <std::size_t entries>
void store(std::array<std::vector<float>, entries>& moment, std::size_t row,
           const std::array<float, entries>& sum) {
  for (std::size_t m = 0; m < entries; ++m) moment[m][row] = 0.5f * sum[m];
}

}  // namespace

/// Reads each row once and computes the data of the grid's equation. These are the excess of the diagonal
/// over the row (P = 0 around it, compressibility); the second moments ½ Σ_j w_ij r_ij r_ijᵀ; and the cells
/// that the row touches.
template <int dim>
void Multilevel<dim>::read_rows(const PressureSystem& system, int threads) {
  const std::int64_t n = system.size();
  const auto rows = static_cast<std::size_t>(n);
  for (auto* v : {&diagonal_, &inverse_, &excess_}) unknowns_ ? v->assign(rows, 0) : v->resize(rows);
  for (auto& m : moment_) m.resize(rows);
  exact_row_.assign(rows, -1);
  const float* value = system.value.data();
  const std::int32_t* column = system.column.data();
  std::array<const float*, dim> at;
  for (std::size_t d = 0; d < dim; ++d) at[d] = pieces_.at[d].data();
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (std::int64_t k = 0; k < n; ++k) {
    const auto row = static_cast<std::size_t>(k);
    if (is_copy(k)) continue;
    const std::int64_t begin = system.start[row], end = system.stop[row];
    double sum = 0;
    std::array<float, 3> centre{}, cell{};
    for (std::size_t d = 0; d < dim; ++d) {
      centre[d] = at[d][k];
      cell[d] = std::floor(centre[d]);
    }
    float xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;
    std::uint32_t touched = 0;
    std::int32_t own = 0, far = 0;
#pragma omp simd simdlen(8) reduction(+ : sum, xx, xy, yy, xz, yz, zz, own, far) reduction(| : touched)
    for (std::int64_t e = begin; e < end; ++e) {
      const std::int32_t j = column[e];
      const float w = -value[e];
      sum -= w;
      const float x = at[0][j], y = at[1][j];
      const float dx = x - centre[0], dy = y - centre[1];
      xx += w * dx * dx;
      xy += w * dx * dy;
      yy += w * dy * dy;
      far += std::max(dx * dx, dy * dy) > square(seam) ? 1 : 0;
      int code = static_cast<int>(std::floor(x) - cell[0]) + 3 * static_cast<int>(std::floor(y) - cell[1]);
      if constexpr (dim == 3) {
        const float z = at[dim - 1][j], dz = z - centre[dim - 1];
        xz += w * dx * dz;
        yz += w * dy * dz;
        zz += w * dz * dz;
        far += dz * dz > square(seam) ? 1 : 0;
        code += 9 * static_cast<int>(std::floor(z) - cell[dim - 1]);
      }
      own += code == 0 ? 1 : 0;
      touched |= 1u << ((code + Aggregates<dim>::middle) & 31);
    }
    const double diagonal = system.diagonal[k];
    diagonal_[row] = static_cast<float>(diagonal);
    inverse_[row] = static_cast<float>(damped_inverse(diagonal, -sum, damping));
    excess_[row] = static_cast<float>(std::max(0.0, diagonal + sum));
    if constexpr (dim == 2)
      store<3>(moment_, row, {xx, xy, yy});
    else
      store<6>(moment_, row, {xx, xy, xz, yy, yz, zz});
    pieces_.touched[row] = touched;
    pieces_.own_cell_entries[row] = own;
    if (far > 0 || pieces_.is_near_sparse(k)) read_scattered_row(system, k);
  }
}

/// Whether an entry enters the grid's equation without approximation, as w (P_i − P_j)(P_i − P_j)ᵀ. P are the
/// corners' weights. This is so where unknowns are sparse and over the seam of a periodic direction: a linear
/// pressure around i does not represent p_j there.
template <int dim>
bool Multilevel<dim>::is_exact(std::int64_t i, std::int64_t j) const {
  if (pieces_.is_sparse(i) || pieces_.is_sparse(j)) return true;
  for (const auto& at : pieces_.at)
    if (std::abs(at.data()[i] - at.data()[j]) > seam) return true;
  return false;
}

template <int dim>
void Multilevel<dim>::read_scattered_row(const PressureSystem& system, std::int64_t k) {
  const auto row = static_cast<std::size_t>(k);
  std::array<float, moments> sum{};
  std::uint32_t touched = 0;
  for (std::int64_t e = system.start[row]; e < system.stop[row]; ++e) {
    const std::int64_t j = system.column[static_cast<std::size_t>(e)];
    std::array<float, dim> r;
    int code = 0, scale = 1;
    bool adjacent = true;
    for (std::size_t d = 0; d < dim; ++d, scale *= 3) {
      const float here = pieces_.at[d].data()[k], there = pieces_.at[d].data()[j];
      r[d] = there - here;
      const int step = static_cast<int>(std::floor(there)) - static_cast<int>(std::floor(here));
      adjacent = adjacent && step >= -1 && step <= 1;
      code += scale * (step + 1);
    }
    if (adjacent) touched |= 1u << code;
    if (is_exact(k, j)) {
      exact_row_[row] = 0;  // numbered later
      continue;
    }
    const float w = -system.value[static_cast<std::size_t>(e)];
    std::size_t at = 0;
    for (std::size_t a = 0; a < dim; ++a)
      for (std::size_t b = a; b < dim; ++b) sum[at++] += 0.5f * w * r[a] * r[b];
  }
  for (std::size_t m = 0; m < moments; ++m) moment_[m][row] = sum[m];
  pieces_.touched[row] = touched;
}

template <int dim>
void Multilevel<dim>::read_exact_entries(const PressureSystem& system, int threads) {
  scattered_.clear();
  for (std::size_t k = 0; k < exact_row_.size(); ++k) {
    if (exact_row_[k] < 0 || !pieces_.owns(pieces_.piece_of[k])) continue;
    exact_row_[k] = static_cast<std::int32_t>(scattered_.size());
    scattered_.push_back(static_cast<std::int32_t>(k));
  }
  exact_.clear();
  if (scattered_.empty()) return;
  const auto add = [&](std::int64_t k, double factor, RowGatherer& gatherer) {
    std::array<float, dim> f;
    for (std::size_t d = 0; d < dim; ++d) {
      const float u = pieces_.at[d].data()[k];
      f[d] = u - std::floor(u);
    }
    const auto weight = corner_weights<dim>(f);
    const std::int64_t first = static_cast<std::int64_t>(pieces_.piece_of.data()[k]) * corners;
    for (std::size_t b = 0; b < corners; ++b)
      gatherer.add(pieces_.node.data()[first + static_cast<std::int64_t>(b)], factor * weight[b]);
  };
  parts_.resize(static_cast<std::size_t>(threads));
  for (SparseRows& part : parts_) part.clear();
#pragma omp parallel num_threads(threads) if (threads > 1)
  {
    const Team team{omp_get_thread_num(), omp_get_num_threads(), nullptr};
    RowGatherer gatherer;
    gatherer.resize(vertices());
    const auto [begin, end] = team.share(static_cast<std::int64_t>(scattered_.size()));
    for (std::int64_t s = begin; s < end; ++s) {
      const std::int64_t i = scattered_.data()[s];
      double sum = 0;
      for (std::int64_t e = system.start.data()[i]; e < system.stop.data()[i]; ++e) {
        const std::int64_t j = system.column.data()[e];
        if (!is_exact(i, j)) continue;
        const double w = -system.value.data()[e];
        sum += w;
        add(j, -w, gatherer);
      }
      add(i, sum, gatherer);
      constexpr std::int32_t no_diagonal = -1;
      gatherer.finish(no_diagonal, parts_[static_cast<std::size_t>(team.index)]);
    }
  }
  join(parts_, exact_);
}

/// Adds the exact entries to the row of one corner of a piece: Σ_i N_i Σ_j w_ij (P_i − P_j).
template <int dim>
void Multilevel<dim>::add_exact_entries(std::int32_t piece, std::int32_t corner,
                                        RowGatherer& gatherer) const {
  const auto p = static_cast<std::size_t>(piece);
  for (std::int32_t s = pieces_.piece_start[p]; s < pieces_.piece_start[p + 1]; ++s) {
    const std::int32_t row = exact_row_[static_cast<std::size_t>(pieces_.order[static_cast<std::size_t>(s)])];
    if (row < 0) continue;
    std::array<float, dim> f;
    for (std::size_t d = 0; d < dim; ++d) f[d] = within_[d][static_cast<std::size_t>(s)];
    const double own = corner_weights<dim>(f)[static_cast<std::size_t>(corner)];
    for (std::int32_t e = exact_.start[static_cast<std::size_t>(row)];
         e < exact_.start[static_cast<std::size_t>(row) + 1]; ++e)
      gatherer.add(exact_.column[static_cast<std::size_t>(e)],
                   own * exact_.value[static_cast<std::size_t>(e)]);
  }
}

/// Computes the energy of a pressure p that is interpolated between the corners, ½ pᵀA p with
/// p_i − p_j ≈ −∇p·r_ij:
///   E_ab = Σ_i [ e_i N_a N_b + ∇N_a · (½ Σ_j w_ij r_ij r_ijᵀ) ∇N_b ]
/// over the unknowns i of a piece. N: the corners' weights at i, e: excess of the diagonal.
template <int dim>
typename Multilevel<dim>::Element Multilevel<dim>::element(std::int32_t piece) const {
  std::array<float, static_cast<std::size_t>(corners) * corners> sum{};
  const auto p = static_cast<std::size_t>(piece);
  for (auto s = static_cast<std::size_t>(pieces_.piece_start[p]);
       s < static_cast<std::size_t>(pieces_.piece_start[p + 1]); ++s) {
    const auto k = static_cast<std::size_t>(pieces_.order[s]);
    std::array<float, dim> f;
    for (std::size_t d = 0; d < dim; ++d) f[d] = within_[d][s];
    const auto weight = corner_weights<dim>(f);
    std::array<std::array<float, corners>, dim> gradient, flux;
    for (std::size_t d = 0; d < dim; ++d)
      for (std::size_t a = 0; a < corners; ++a) {
        float g = (a >> d & 1) ? 1.0f : -1.0f;
        for (std::size_t other = 0; other < dim; ++other)
          if (other != d) g *= (a >> other & 1) ? f[other] : 1 - f[other];
        gradient[d][a] = g;
      }
    for (std::size_t a = 0; a < corners; ++a) {
      const float gx = gradient[0][a], gy = gradient[1][a];
      if constexpr (dim == 2) {
        flux[0][a] = moment_[0][k] * gx + moment_[1][k] * gy;
        flux[1][a] = moment_[1][k] * gx + moment_[2][k] * gy;
      } else {
        const float gz = gradient[dim - 1][a];
        flux[0][a] = moment_[0][k] * gx + moment_[1][k] * gy + moment_[2][k] * gz;
        flux[1][a] = moment_[1][k] * gx + moment_[3][k] * gy + moment_[4][k] * gz;
        flux[dim - 1][a] = moment_[2][k] * gx + moment_[4][k] * gy + moment_[5][k] * gz;
      }
    }
    const float excess = excess_[k];
    for (std::size_t a = 0; a < corners; ++a)
      for (std::size_t b = 0; b < corners; ++b) {
        float e = excess * weight[a] * weight[b];
        for (std::size_t d = 0; d < dim; ++d) e += gradient[d][a] * flux[d][b];
        sum[a * corners + b] += e;
      }
  }
  Element out;
  for (std::size_t a = 0; a < corners; ++a)  // the same for ab and ba, whatever the order of the sums above
    for (std::size_t b = 0; b < corners; ++b)
      out[a * corners + b] = 0.5 * (static_cast<double>(sum[a * corners + b]) + sum[b * corners + a]);
  return out;
}

template <int dim>
void Multilevel<dim>::assemble_grid(int threads) {
  CoarseLevel<dim>& grid = grids_.finest();
  const std::int32_t n = grid.unknowns(), count = pieces_.pieces();
  elements_.resize(static_cast<std::size_t>(count));
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (std::int32_t p = 0; p < count; ++p)
    if (pieces_.owns(p)) elements_[static_cast<std::size_t>(p)] = element(p);
  grid.diagonal.resize(static_cast<std::size_t>(n));
  parts_.resize(static_cast<std::size_t>(threads));
  for (SparseRows& part : parts_) part.clear();
#pragma omp parallel num_threads(threads) if (threads > 1)
  {
    const Team team{omp_get_thread_num(), omp_get_num_threads(), nullptr};
    SparseRows& rows = parts_[static_cast<std::size_t>(team.index)];
    RowGatherer gatherer;
    gatherer.resize(vertices());
    const auto [begin, end] = team.share(n);
    for (auto i = static_cast<std::int32_t>(begin); i < end; ++i) {
      for (std::int32_t m = pieces_.meeting_start[static_cast<std::size_t>(i)];
           m < pieces_.meeting_start[static_cast<std::size_t>(i) + 1]; ++m) {
        const std::int32_t meeting = pieces_.meeting[static_cast<std::size_t>(m)];
        const std::int32_t p = meeting / corners, a = meeting % corners;
        if (!pieces_.owns(p)) continue;
        const Element& e = elements_[static_cast<std::size_t>(p)];
        for (std::int32_t b = 0; b < corners; ++b)
          gatherer.add(pieces_.node[static_cast<std::size_t>(p * corners + b)],
                       e[static_cast<std::size_t>(a * corners + b)]);
        add_exact_entries(p, a, gatherer);
      }
      grid.diagonal[static_cast<std::size_t>(i)] = static_cast<float>(gatherer.finish(i, rows));
    }
  }
  join(parts_, grid.matrix);
  if (grid_ranks_ == nullptr) {
    grid.prepare();
    return;
  }
  grid.right.resize(static_cast<std::size_t>(n));
  grid.solution.resize(static_cast<std::size_t>(n));
}

template void Multilevel<2>::read_rows(const PressureSystem&, int);
template void Multilevel<2>::read_exact_entries(const PressureSystem&, int);
template void Multilevel<2>::assemble_grid(int);
template void Multilevel<3>::read_rows(const PressureSystem&, int);
template void Multilevel<3>::read_exact_entries(const PressureSystem&, int);
template void Multilevel<3>::assemble_grid(int);

}  // namespace strake::fluid
