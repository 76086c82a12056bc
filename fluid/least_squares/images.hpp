#pragma once

#include "fluid/least_squares/scheme.hpp"
#include "fluid/particles/pair_loop.hpp"

#include <cmath>

namespace strake::fluid {

/// Calls visit(e, w_m, r, n, slope) for each pair of row i that is mirrored in a face (F72):
///   w_m = f (1−τ_i) (1−τ_k) part_i part_k (1 − |n·r|/(l0/2)) (R/d − 1) ,  d² = r² + 4 h_i h_k < R² ,  |n·r|
///   < l0/2 ,  τ = σ (1 − e max(0, n·N))
/// e is 0 in the plane; `end` of the face in space.
/// The faces of i and k must have nearly one normal n and one plane: |n·r − (h_k − h_i)| < `one_plane` l0.
/// Row k gets the same weights, to the last bit.
template <int dim>
template <class Visit>
void LeastSquaresScheme<dim>::for_each_image(const Boundary<dim>& boundary, const State<dim>& state,
                                             const Neighbours& far, std::int64_t i,
                                             const Visit& visit) const {
  const auto own = static_cast<std::size_t>(i);
  if (images_.count[own] == 0) return;
  const LeastSquaresConstants& tuned = least_squares_constants();
  const double reach = laplacian_.radius, row = tuned.first_row * p_.spacing;
  const auto columns = far.row(i);
  for (std::size_t e = 0; e < columns.size() && columns[e] < boundary.water(); ++e) {
    const auto k = static_cast<std::size_t>(columns[e]);
    if (images_.count[k] == 0) continue;
    const Vector<dim> r =
        boundary.tank().periodic().separation(state.position.col(i), state.position.col(columns[e]));
    for (std::uint8_t a = 0; a < images_.count[own]; ++a)
      for (std::uint8_t b = 0; b < images_.count[k]; ++b) {
        const auto &one = images_.faces[own][a], &other = images_.faces[k][b];
        const double square = r.squaredNorm() + 4 * (one.height * other.height);
        if (!(square < reach * reach)) continue;
        const Vector<dim> n1 = walls_.normal(one.layer), n2 = walls_.normal(other.layer);
        if (n1.dot(n2) < tuned.alike) continue;
        const Vector<dim> n = (n1 + n2).normalized();
        if (std::abs(n.dot(r) - (other.height - one.height)) > tuned.one_plane * p_.spacing) continue;
        const double level = 1 - std::abs(n.dot(r)) / row;
        if (!(level > 0)) continue;
        const float inner = (1 - open_share(i, one, n)) * (1 - open_share(columns[e], other, n));
        if (!(inner > 0)) continue;
        const double w =
            images_.factor * inner * level * (one.part * other.part) * (reach / std::sqrt(square) - 1);
        visit(e, w, r, n, 0.5 * (one.normal_velocity + other.normal_velocity));
      }
  }
}

}  // namespace strake::fluid
