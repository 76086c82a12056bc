#include "fluid/least_squares/scheme.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace strake::fluid {
namespace {

/// Returns the part of a shift from x that goes through no face of a body or wall.
template <int dim>
Vector<dim> before_faces(const Boundary<dim>& boundary, const Vector<dim>& x, Vector<dim> move) {
  const auto along = [&](const Vector<dim>& normal) { move -= std::min(0.0, move.dot(normal)) * normal; };
  const BodySurface<dim>& body = boundary.body_surface();
  if (!body.empty() && body.inside(x + move)) along(body.normal(body.nearest(x + move).point));
  if (const auto foot = boundary.tank().behind(x + move)) along(foot->normal);
  return move;
}

}  // namespace

/// Moves each particle by δr = −(I + αS)⁻¹ α l0² ∇C, α = A |u| Δt/l0 (F49), at most 0.1 l0. S is the change
/// of l0² ∇C with the particle's place: 3 on a square lattice, 10 across a string of crowded particles. With
/// α alone particles would be thrown past their places and back at every other step wherever S α > 1, and the
/// pressure would oscillate with them. Next to the free surface particles move only along it, and through no
/// face.
///
/// The velocity changes by δu = (1−σ) ∇u·δr (F50). Beside a jet or a drop ∇u is one-sided. A velocity that
/// grows with the shift that it causes would run away.
template <int dim>
void LeastSquaresScheme<dim>::shift(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& near,
                                    double dt) const {
  if (p_.scheme.shifting <= 0) return;
  const LeastSquaresConstants& tuned = least_squares_constants();
  const bool moves = boundary.tank().moves();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    if (!ranks_.owns(i) || boundary.is_removed(state, i)) continue;
    const auto k = static_cast<std::size_t>(i);
    // The velocity is relative to the tank, so that an observer who moves with it finds the same result.
    Vector<dim> past = state.velocity.col(i);
    if (moves) past -= boundary.tank().velocity_at(state.position.col(i));
    const double alpha = std::min(1.0, p_.scheme.shifting * past.norm() * dt / p_.spacing);
    if (!(alpha > 0)) continue;
    const double reach = alpha * p_.spacing * p_.spacing * dim / gradient_.n0;
    Vector<dim> move = -reach * moments_.concentration.col(i).template cast<double>();
    const double stiffness = moments_.stiffness[i], share = surface_.share[i];
    if (alpha * stiffness > tuned.soft_stiffness) {
      // The matrix S has the shape of B, normalised to the trace d.
      Tensor<dim> matrix = Tensor<dim>::Identity();
      if (moments_.b_inverse[k].determinant() > least_determinant()) {
        matrix = moments_.b_inverse[k].inverse();
        matrix *= dim / matrix.trace();
      }
      matrix = Tensor<dim>::Identity() + alpha * stiffness * matrix;
      move = (matrix.inverse() * move).eval();
    }
    const Vector<dim> normal = surface_.normal.col(i).template cast<double>();
    move -= share * normal.dot(move) * normal;
    const double length = move.norm();
    if (length > tuned.longest_shift * p_.spacing) move *= tuned.longest_shift * p_.spacing / length;
    const auto columns = near.row(i);
    if (!columns.empty() && columns.back() >= boundary.water())
      move = before_faces<dim>(boundary, state.position.col(i), move);
    state.position.col(i) += move;
    state.velocity.col(i).noalias() += (1 - share) * velocity_gradient(i) * move;
  }
}

template void LeastSquaresScheme<2>::shift(const Boundary<2>&, State<2>&, const Neighbours&, double) const;
template void LeastSquaresScheme<3>::shift(const Boundary<3>&, State<3>&, const Neighbours&, double) const;

}  // namespace strake::fluid
