#include "fluid/least_squares/film.hpp"

#include "fluid/least_squares/constants.hpp"
#include "fluid/least_squares/moment_inverse.hpp"
#include "fluid/least_squares/scheme.hpp"
#include "fluid/particles/pair_loop.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

// Computes what water in a film, a jet's tip or spray may do. Its neighbours lie nearly on one line (in
// space: in one plane). Across that line ∇·u rests on few pairs, and most of what it says is the particle's
// own motion. The pressure that follows drives the particle on instead of stopping it: −∇p_i points away from
// the wall, and p_i itself is most of ∇p_i. Measured on a wedge of 15° at 5 m/s with steps of 2e-6 s: 0.4
// to 36.8 MPa within 30 µs. So the pressure of such water is bounded by that of firm water beside it, and
// what closes is stopped as in a plastic impact.

namespace strake::fluid {

template <int dim>
double film_share(const Tensor<dim>& b) {
  const LeastSquaresConstants& tuned = least_squares_constants();
  const double mean = b.trace() / dim;
  if (!(mean > 0)) return 0;
  const double even = b.determinant() / (mean * mean * (dim == 3 ? mean : 1.0));
  // The largest det/(tr/d)^d at the ratio ρ is ρ/((1 + ρ)/2)², in the plane and in space.
  const double begins = tuned.film_begins, middle = 0.5 * (1 + begins);
  if (even > begins / (middle * middle)) return 0;
  double ratio = 0;
  if constexpr (dim == 2) {
    const double spread = std::sqrt(std::max(0.0, 1 - even));
    ratio = (1 - spread) / (1 + spread);
  } else {
    Eigen::SelfAdjointEigenSolver<Tensor<dim>> eigen;
    eigen.computeDirect(b, Eigen::EigenvaluesOnly);
    ratio = eigen.eigenvalues()[0] / eigen.eigenvalues()[dim - 1];
  }
  return std::clamp((begins - ratio) / (begins - tuned.film_counts), 0.0, 1.0);
}

/// Lists the particles with φ > 0, in order. Where a body has oblique faces it finds the wide pairs of the
/// own ones too (F86):
///   weight = (w + φ w_L)/r²
/// Within the gradient's radius ∇u of a film rests on few pairs that lie nearly on one line. It changes when
/// one of them comes or goes, and with it the pressure under the whole body.
template <int dim>
void LeastSquaresScheme<dim>::list_films(const Boundary<dim>& boundary, const State<dim>& state,
                                         const Neighbours& far) {
  film_.particles.clear();
  for (Eigen::Index i = 0; i < film_.share.size(); ++i)
    if (film_.share[i] > 0) film_.particles.push_back(i);
  if (!oblique_) return;
  const auto count = static_cast<std::int64_t>(film_.particles.size());
  film_.wide_inverse.assign(film_.particles.size(), Tensor<dim>::Zero());
  film_.wide_start.assign(1, 0);
  for (const std::int64_t i : film_.particles)  // ∇u of others comes from their owners
    film_.wide_start.push_back(film_.wide_start.back() +
                               (ranks_.owns(i) ? water_pairs(far.row(i), boundary.water()) : 0));
  film_.wide.resize(film_.wide_start.back());
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < count; ++k) {
    const auto f = static_cast<std::size_t>(k);
    const std::int64_t i = film_.particles[f];
    const auto columns = far.row(i);
    const std::int64_t first = far.start()[static_cast<std::size_t>(i)];
    Tensor<dim> moments = Tensor<dim>::Zero();
    for (std::size_t e = 0, inner = film_.wide_start[f + 1] - film_.wide_start[f]; e < inner; ++e) {
      const double inverse = far.inverse_of(first + static_cast<std::int64_t>(e));
      const double weight = inverse * inverse *
                            (std::max(0.0, gradient_.radius * inverse - 1) +
                             film_.share[i] * std::max(0.0, laplacian_.radius * inverse - 1));
      const Vector<dim> r =
          boundary.tank().periodic().separation(state.position.col(i), state.position.col(columns[e]));
      moments += weight * r * r.transpose();
      film_.wide[film_.wide_start[f] + e] = {columns[e], weight};
    }
    inverse_where_seen<dim>(moments, film_.wide_inverse[f]);
  }
}

/// Bounds the pressure of particle i by that of the neighbours that are no film (F69):
///   p_i ≤ (1 − φ_i) p_i + φ_i max_j (1 − φ_j) p_j
template <int dim>
void LeastSquaresScheme<dim>::limit_film(State<dim>& state, const Neighbours& near) {
  const auto count = static_cast<std::int64_t>(film_.particles.size());
  film_.value.resize(count);
#pragma omp parallel for schedule(static)
  for (std::int64_t e = 0; e < count; ++e) {
    const std::int64_t i = film_.particles[static_cast<std::size_t>(e)];
    film_.value[e] = state.pressure[i];
    if (!ranks_.owns(i)) continue;  // its owner sends the pressure
    double firm = 0;
    for (const std::int32_t j : near.row(i)) {
      if (j >= film_.share.size()) break;
      firm = std::max(firm, (1 - film_.share[j]) * state.pressure[j]);
    }
    const double p = state.pressure[i];
    film_.value[e] = p > firm ? p + film_.share[i] * (firm - p) : p;
  }
  for (std::int64_t e = 0; e < count; ++e) {
    const std::int64_t i = film_.particles[static_cast<std::size_t>(e)];
    if (!(film_.value[e] < state.pressure[i])) continue;
    state.pressure[i] = film_.value[e];
    equation_.limited[static_cast<std::size_t>(i)] = Limit::tension;
  }
}

/// Computes λ_i of (F70) from the velocity u' of the step; zero where the film does not close.
template <int dim>
double LeastSquaresScheme<dim>::film_impulse(const Boundary<dim>& boundary, const State<dim>& state,
                                             const Neighbours& near, std::int64_t i) const {
  const auto columns = near.row(i);
  const auto inverses = near.inverses(i);
  const Tensor<dim>& inverse = moments_.b_inverse[static_cast<std::size_t>(i)];
  Vector<dim> own = Vector<dim>::Zero();
  double response = 0, divergence = 0, films = 0;
  for (std::size_t e = 0, inner = water_pairs(columns, boundary.water()); e < inner; ++e) {
    const std::int64_t j = columns[e];
    const double w = (gradient_.radius * inverses[e] - 1) * inverses[e] * inverses[e];
    const Vector<dim> arm =
        w * (inverse * boundary.tank().periodic().separation(state.position.col(i), state.position.col(j)));
    own += arm;
    response += arm.squaredNorm();
    divergence += arm.dot(state.velocity.col(j) - state.velocity.col(i));
    films += film_.share[j];
  }
  response += own.squaredNorm();
  return divergence < 0 && response > 0 ? -film_.share[i] * divergence / (response * (1 + films)) : 0.0;
}

/// Gives λ and B⁻¹ of the films of other ranks, and lists the own neighbours of those that close.
template <int dim>
void LeastSquaresScheme<dim>::share_films(const Boundary<dim>& boundary, const Neighbours& near) {
  film_.ghosts.clear();
  if (!ranks_.several()) return;
  constexpr std::size_t each = sizeof(double) + sizeof(Tensor<dim>);
  const auto number_of = [&](std::int64_t i) {
    return std::ranges::lower_bound(film_.particles, i) - film_.particles.begin();
  };
  ranks_.update_some([&](std::int32_t i) { return film_.share[i] > 0; }, each,
                     [&](std::int32_t i, std::byte* to) {
                       std::memcpy(to, &film_.value[number_of(i)], sizeof(double));
                       std::memcpy(to + sizeof(double),
                                   moments_.b_inverse[static_cast<std::size_t>(i)].data(),
                                   sizeof(Tensor<dim>));
                     },
                     [&](std::int32_t i, const std::byte* from) {
                       std::memcpy(&film_.value[number_of(i)], from, sizeof(double));
                       std::memcpy(moments_.b_inverse[static_cast<std::size_t>(i)].data(),
                                   from + sizeof(double), sizeof(Tensor<dim>));
                     });
  // A ghost has no row. Its own neighbours, which its owner has as ghosts, have it in theirs.
  std::vector<std::uint8_t> closes(static_cast<std::size_t>(boundary.water()), 0);
  bool any = false;
  for (std::size_t f = 0; f < film_.particles.size(); ++f) {
    const std::int64_t i = film_.particles[f];
    if (ranks_.owns(i) || !(film_.value[static_cast<Eigen::Index>(f)] > 0)) continue;
    closes[static_cast<std::size_t>(i)] = 1;
    any = true;
  }
  if (!any) return;
  for (const std::int32_t j : ranks_.water_near_others()) {
    const auto columns = near.row(j);
    for (std::size_t e = 0, inner = water_pairs(columns, boundary.water()); e < inner; ++e)
      if (closes[static_cast<std::size_t>(columns[e])])
        film_.ghosts.push_back({columns[e], j, near.inverses(j)[e]});
  }
  std::ranges::sort(film_.ghosts, {}, [](const FilmPair& pair) { return std::pair(pair.film, pair.other); });
}

/// Stops what closes in a film (F70). With a_j = w B_i⁻¹ r_ij/r² the divergence is ∇·u_i = Σ a_j·(u_j − u_i),
/// and
///   u_j += λ_i a_j ,  u_i −= λ_i Σ a_j ,  λ_i = −φ_i ∇·u_i/(Σ|a_j|² + |Σ a_j|²)/(1 + Σ φ_j)
/// is the smallest change that ends it. It keeps momentum and never adds energy. The last factor holds for
/// films beside one another, which all change at once.
template <int dim>
void LeastSquaresScheme<dim>::stop_films(const Boundary<dim>& boundary, State<dim>& state,
                                         const Neighbours& near) {
  const auto count = static_cast<std::int64_t>(film_.particles.size());
  film_.value.setZero(count);
#pragma omp parallel for schedule(static)
  for (std::int64_t e = 0; e < count; ++e)
    if (const std::int64_t i = film_.particles[static_cast<std::size_t>(e)]; ranks_.owns(i))
      film_.value[e] = film_impulse(boundary, state, near, i);
  share_films(boundary, near);
  auto of_ghost = film_.ghosts.cbegin();
  for (std::int64_t f = 0; f < count; ++f) {
    if (!(film_.value[f] > 0)) continue;
    const std::int64_t i = film_.particles[static_cast<std::size_t>(f)];
    const Tensor<dim>& inverse = moments_.b_inverse[static_cast<std::size_t>(i)];
    const auto stop = [&](std::int64_t j, double inverse_length) {
      const double w = (gradient_.radius * inverse_length - 1) * inverse_length * inverse_length;
      const Vector<dim> change =
          film_.value[f] * w *
          (inverse * boundary.tank().periodic().separation(state.position.col(i), state.position.col(j)));
      state.velocity.col(j) += change;
      state.velocity.col(i) -= change;
    };
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    for (std::size_t e = 0, inner = water_pairs(columns, boundary.water()); e < inner; ++e)
      stop(columns[e], inverses[e]);
    for (; of_ghost != film_.ghosts.cend() && of_ghost->film == i; ++of_ghost)
      stop(of_ghost->other, of_ghost->inverse);
  }
}

#define STRAKE_INSTANTIATE(dim)                                                                            \
  template double film_share<dim>(const Tensor<dim>&);                                                     \
  template void LeastSquaresScheme<dim>::list_films(const Boundary<dim>&, const State<dim>&,               \
                                                    const Neighbours&);                                    \
  template void LeastSquaresScheme<dim>::limit_film(State<dim>&, const Neighbours&);                       \
  template void LeastSquaresScheme<dim>::share_films(const Boundary<dim>&, const Neighbours&);             \
  template void LeastSquaresScheme<dim>::stop_films(const Boundary<dim>&, State<dim>&, const Neighbours&); \
  template double LeastSquaresScheme<dim>::film_impulse(const Boundary<dim>&, const State<dim>&,           \
                                                        const Neighbours&, std::int64_t) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
