#include "fluid/least_squares/scheme.hpp"
#include "fluid/particles/pair_loop.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace strake::fluid {

/// Computes the pressure gradient (F47):
///   ∇p_i = A_i⁻¹ (Σ_water w (p_j − p_i) r/r² + Σ_layers w q P r/r² + (b/D) p_i N).
/// q is that of wall_pressure_increment with the factor χ, A_i is of the same positions. So ∇p is exact for a
/// linear p with the slope (F34) at the walls and p = 0 at the depth D above a surface particle.
template <int dim>
template <bool seams>
void LeastSquaresScheme<dim>::find_pressure_gradient(const Boundary<dim>& boundary, const State<dim>& state,
                                                     const Neighbours& near, double dt) {
  const auto& periodic = boundary.tank().periodic();
  const std::int64_t water = boundary.water();
  if (now_.deferred > 0) wall_.deferred_velocity.resize(dim, water);
  const double share = slope_share(dt), whole = p_.density / dt;
  const double *const place = state.position.data(), *const pressure = state.pressure.data();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (!ranks_.owns(i)) continue;
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    const Vector<dim> x = state.position.col(i);
    const double here = state.pressure[i];
    const double slope = whole * (1 - compressible(boundary, x) * (1 - share));
    const std::size_t inner = water_pairs(columns, water);
    const auto middle = vec_at<dim>(place + dim * i);
    VecD<dim> differences{};
    for (std::size_t e = 0; e < inner; ++e) {
      const std::int64_t j = columns[e];
      auto r = vec_at<dim>(place + dim * j) - middle;
      if constexpr (seams) over_seams<dim>(periodic, r);
      const double w = (gradient_.radius * inverses[e] - 1) * inverses[e] * inverses[e];
      differences += r * (w * (pressure[j] - here));
    }
    Vector<dim> sum =
        surface_.slope_weight[i] * (here - air_->above(i)) * surface_.normal.col(i).template cast<double>();
    sum += Eigen::Map<const Vector<dim>>(reinterpret_cast<const double*>(&differences));
    FaceSums faces;
    for (std::size_t e = inner; e < columns.size(); ++e) {
      const std::int64_t j = columns[e];
      if (!walls_.wet(j)) continue;
      const double share_of_face = share_of(boundary, state, i, j);
      if (!(share_of_face > 0)) continue;
      const double weight = share_of_face * walls_.weight(j, gradient_.radius, inverses[e]),
                   w = weight * inverses[e] * inverses[e];
      const Vector<dim> projected = walls_.projection(j, periodic.separation(x, state.position.col(j)));
      faces.q_moment += w * wall_pressure_increment(boundary, state, i, j, projected, slope) * projected;
      faces.a.noalias() += w * projected * projected.transpose();
      if (boundary.master_of(j) < 0 && !walls_.corner(j)) faces.weights += std::max(0.0, weight);
    }
    pressure_gradient_.col(i).noalias() =
        moments_.a_inverse[static_cast<std::size_t>(i)] * (sum + faces.q_moment);
    if (now_.deferred > 0)
      wall_.deferred_velocity.col(i) =
          (now_.deferred * equation_.incompressible[i] *
           (residual_wall_velocity(boundary, state, near, i) - now_.gravity_velocity))
              .template cast<float>();
    if (inner < columns.size()) wall_.force.col(i) = wall_force(i, faces).template cast<float>();
  }
}

template <int dim>
const Vectors<dim>& LeastSquaresScheme<dim>::pressure_gradient(const Boundary<dim>& boundary,
                                                               const State<dim>& state,
                                                               const Neighbours& near, double dt) {
  if (boundary.tank().periodic().any())
    find_pressure_gradient<true>(boundary, state, near, dt);
  else
    find_pressure_gradient<false>(boundary, state, near, dt);
  return pressure_gradient_;
}

template const Vectors<2>& LeastSquaresScheme<2>::pressure_gradient(const Boundary<2>&, const State<2>&,
                                                                    const Neighbours&, double);
template const Vectors<3>& LeastSquaresScheme<3>::pressure_gradient(const Boundary<3>&, const State<3>&,
                                                                    const Neighbours&, double);

}  // namespace strake::fluid
