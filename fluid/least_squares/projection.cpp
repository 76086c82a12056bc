#include "fluid/least_squares/scheme.hpp"

#include <algorithm>

// Computes the velocity with which the pressure equation is assembled (F74):
//   Δt_p = max(Δt, l0/c) where a body has oblique faces, else Δt ,
//   u** = u* + (Δt_p − Δt) ∇pⁿ/ρ .
// The matrix of (F40) resists pressures that change from particle to particle. The divergence of the gradient
// hardly does. The difference of the two, times the length of the projection, damps such pressures. A step
// much shorter than l0/c does not damp them, and water about a jet's root then bursts. So the equation has
// u** and Δt_p in the place of u* and Δt. Where ∇p does not change, u** − (Δt_p/ρ) ∇p is u. The gradient at
// walls and u = u* − (Δt/ρ) ∇p keep Δt: with Δt_p the force would lag behind the motion of a wall.

namespace strake::fluid {

/// Sets Δt_p. Where it is longer than dt, the state's velocity becomes u**, and u* is kept.
template <int dim>
void LeastSquaresScheme<dim>::begin_projection(const Boundary<dim>& boundary, State<dim>& state,
                                               const Neighbours& far, const Neighbours& near, double dt) {
  now_.projection = oblique_ ? std::max(dt, p_.spacing / p_.sound_speed) : dt;
  const double longer = now_.projection - dt;
  velocity_.start.clear();
  if (!(longer > 0)) return;
  velocity_.start.assign(velocity_.motion.begin(), velocity_.motion.end());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    velocity_.start[static_cast<std::size_t>(i)].velocity = vec_at<dim>(state.velocity.col(i).data());
    state.velocity.col(i) -= longer * state.pressure_acceleration.col(i);
  }
  fit_velocity(boundary, state, near);
  average_wall_velocity(boundary, state, far);
}

template <int dim>
void LeastSquaresScheme<dim>::end_projection(const Boundary<dim>& boundary, State<dim>& state,
                                             const Neighbours& far) {
  if (velocity_.start.empty()) return;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    const Motion& start = velocity_.start[static_cast<std::size_t>(i)];
    velocity_.motion[static_cast<std::size_t>(i)] = start;
    for (int d = 0; d < dim; ++d) state.velocity(d, i) = start.velocity[d];
  }
  average_wall_velocity(boundary, state, far);
}

/// Notes −∇p/ρ of the step for the next one, where (F74) may need it.
template <int dim>
void LeastSquaresScheme<dim>::note_acceleration(const Boundary<dim>& boundary, State<dim>& state) const {
  if (!oblique_) return;  // the gradient of ghosts is that of their owners
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i)
    if (boundary.is_removed(state, i))
      state.pressure_acceleration.col(i).setZero();
    else
      state.pressure_acceleration.col(i) = pressure_gradient_.col(i) / -p_.density;
}

#define STRAKE_INSTANTIATE(dim)                                                                          \
  template void LeastSquaresScheme<dim>::begin_projection(const Boundary<dim>&, State<dim>&,             \
                                                          const Neighbours&, const Neighbours&, double); \
  template void LeastSquaresScheme<dim>::end_projection(const Boundary<dim>&, State<dim>&,               \
                                                        const Neighbours&);                              \
  template void LeastSquaresScheme<dim>::note_acceleration(const Boundary<dim>&, State<dim>&) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
