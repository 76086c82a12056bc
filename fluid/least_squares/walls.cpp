#include "fluid/least_squares/scheme.hpp"
#include "fluid/particles/pair_loop.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::fluid {

namespace {

/// Returns the part with which water at x enters the mean velocity at a face of a body (F90),
///   ω = clamp(e/at_end, 0, 1) ,
/// e [l0] its distance inside the face's nearest sharp free end. Water that left the mean at once would
/// change the flux of all water around the corner at once.
template <int dim>
double part_in_mean(const Boundary<dim>& boundary, int point, const Vector<dim>& x, double spacing) {
  const double inside = boundary.inside_free_end(point, x) / spacing;
  return std::clamp(inside / least_squares_constants().at_end, 0.0, 1.0);
}

}  // namespace

template <int dim>
bool LeastSquaresScheme<dim>::is_over(const Boundary<dim>& boundary, const State<dim>& state, std::int64_t i,
                                      std::int64_t row) const {
  return row < boundary.first_of_bodies() || boundary.volume() ||
         boundary.is_over(boundary.point_of(row), state.position.col(i));
}

/// Beside a chine the two faces share the water,
///   s = clamp(1/2 + e/l0, 0, 1) ,                                                          (F92)
/// e its distance inside the plane that halves the chine, along the face. The shares of equal distances from
/// both faces sum to 1.
template <int dim>
double LeastSquaresScheme<dim>::share_of(const Boundary<dim>& boundary, const State<dim>& state,
                                         std::int64_t i, std::int64_t row) const {
  if (!is_over(boundary, state, i, row)) return 0;
  if (row < boundary.first_of_bodies() || boundary.volume()) return 1;
  const double inside = boundary.inside_chine(boundary.point_of(row), state.position.col(i));
  return std::clamp(0.5 + inside / p_.spacing, 0.0, 1.0);
}

template <int dim>
double LeastSquaresScheme<dim>::inside_end(const Boundary<dim>& boundary, const State<dim>& state,
                                           std::int64_t i, std::int64_t row) const {
  constexpr double far = std::numeric_limits<double>::infinity();
  if (row < boundary.first_of_bodies() || boundary.volume()) return far;
  return boundary.within(boundary.point_of(row), state.position.col(i)) / p_.spacing;
}

/// Computes the part of each face that water covers:
///   Σ max(0, 1 − a/l0) over the water within l0 of the face, a the distance along it.
/// On a lattice this is 1 inside, and at the end of the water the part that lies below its level.
template <int dim>
void LeastSquaresScheme<dim>::cover_layers(const Boundary<dim>& boundary, const State<dim>& state,
                                           const Neighbours& near) {
  const std::int64_t n = state.position.cols(), water = boundary.water();
#pragma omp parallel for schedule(static)
  for (std::int64_t j = water; j < n; ++j) {
    if (boundary.master_of(j) >= 0) continue;
    const double part = j < boundary.first_of_bodies() ? 1.0 : walls_.bare(j);
    wall_.cover[j - water] = walls_.wet(j) ? part : 0;
    if (!walls_.wet(j) || walls_.corner(j)) continue;
    double sum = 0;
    const auto columns = near.row(j);
    for (std::size_t e = 0; e < columns.size() && columns[e] < boundary.water(); ++e) {
      const Vector<dim> r =
          boundary.tank().periodic().separation(state.position.col(j), state.position.col(columns[e]));
      const double up = r.dot(walls_.normal(j)), aside = std::sqrt(std::max(0.0, r.squaredNorm() - up * up));
      if (up - walls_.depth(j) < p_.spacing) sum += std::max(0.0, 1 - aside / p_.spacing);
    }
    wall_.cover[j - water] = part * std::min(1.0, sum);
  }
  for (std::int64_t j = boundary.water(); j < n; ++j)
    if (const std::int32_t master = boundary.master_of(j); master >= 0)
      wall_.cover[j - water] = wall_.cover[master - water];
}

// The plane of a face leaves a curved body. What a particle at the distance a beside the face's middle, and
// at the height h, finds for (u* − U)·n there is wrong by some u_t a/R and ½h² ∂²u_n/∂n². For the exact flow
// about a cylinder of five spacings in its radius the sum of ∇·u over the water was so wrong by 9 % of what
// the body displaces, for a sphere by 18 %. Of bodies that enter the water the contact line has an error of
// the opposite sign; they keep the velocity over the plane until both are mended.
template <int dim>
double LeastSquaresScheme<dim>::own_part(const Boundary<dim>& boundary, std::int64_t i, std::int64_t j,
                                         const Vector<dim>& from_layer, double height) const {
  if (!p_.submerged || !wall_.curved || j < boundary.first_of_bodies() ||
      !boundary.is_curved(boundary.point_of(j)))
    return 1;
  const LeastSquaresConstants& tuned = least_squares_constants();
  const auto falls = [&](double distance, double about) {
    return std::clamp(0.5 + (about - distance / p_.spacing) / tuned.own_fades, 0.0, 1.0);
  };
  const Vector<dim> n = walls_.normal(j);
  const double aside = (from_layer - from_layer.dot(n) * n).norm();
  return 1 - surface_.deep[i] * (1 - falls(height, tuned.own_height) * falls(aside, tuned.own_side));
}

template <int dim>
Vector<dim> LeastSquaresScheme<dim>::relative_wall_velocity(const Boundary<dim>& boundary,
                                                            const State<dim>& state, std::int64_t i,
                                                            std::int64_t j) const {
  const Vector<dim> lacking = lag(boundary, state, i, j);
  const auto mean = [&]() -> Vector<dim> {
    const std::int32_t master = boundary.master_of(j);
    return lacking + wall_.mean_velocity.col((master < 0 ? j : master) - boundary.water());
  };
  if (!is_over(boundary, state, i, j)) return mean();
  Vector<dim> u = state.velocity.col(i) - state.velocity.col(j);
  if (walls_.corner(j)) return u;
  u += lacking;
  // ∇u* extrapolates the particle's velocity to the face. Beside the free surface it is one-sided and left
  // out.
  const Vector<dim> from_layer =
      boundary.tank().periodic().separation(state.position.col(j), state.position.col(i));
  const double height = walls_.height(j, state.position.col(j), from_layer + state.position.col(j));
  const double trust = 1 - surface_.share[i];
  u -= trust * height * (velocity_gradient(i) * walls_.normal(j));
  if (const double own = own_part(boundary, i, j, from_layer, height); own < 1)
    u = mean() + own * (u - mean());
  if constexpr (dim == 2)
    if (j >= boundary.first_of_bodies() && !boundary.volume()) {
      const double from_end = boundary.within(boundary.point_of(j), state.position.col(i)) / p_.spacing;
      const double own_from = least_squares_constants().first_row;
      if (from_end < own_from) u = mean() + from_end / own_from * (u - mean());
    }
  return u;
}

template <int dim>
double LeastSquaresScheme<dim>::depth_of(const Boundary<dim>& boundary, const Vector<dim>& x) const {
  return p_.water.max[1] - boundary.tank().in_tank(x)[1];
}

template <int dim>
double LeastSquaresScheme<dim>::still_pressure(const Boundary<dim>& boundary, const Vector<dim>& x) const {
  return std::max(0.0, -p_.density * now_.gravity[1] * depth_of(boundary, x));
}

template <int dim>
Vector<dim> LeastSquaresScheme<dim>::absorbing_velocity(const Boundary<dim>& boundary,
                                                        const State<dim>& state, std::int64_t i,
                                                        std::int64_t j) const {
  if (!boundary.tank().absorbs()) return Vector<dim>::Zero();
  const double excess = state.pressure[i] - still_pressure(boundary, state.position.col(i));
  return excess / (p_.density * p_.sound_speed) * compressible(boundary, state.position.col(i)) *
         boundary.tank().absorbing(j);
}

template <int dim>
void LeastSquaresScheme<dim>::average_wall_velocity(const Boundary<dim>& boundary, const State<dim>& state,
                                                    const Neighbours& far) {
  const auto n = static_cast<std::int64_t>(state.kind.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t j = boundary.first_of_bodies(); j < n; ++j) {
    if (boundary.master_of(j) >= 0 || !walls_.wet(j)) continue;
    const Vector<dim> face = state.position.col(j) + walls_.depth(j) * walls_.normal(j);
    const auto columns = far.row(j);
    Vector<dim> sum = Vector<dim>::Zero();
    double weights = 0;
    for (std::size_t e = 0; e < columns.size() && columns[e] < boundary.water(); ++e) {
      const std::int64_t i = columns[e];
      const Vector<dim> to_face = boundary.tank().periodic().separation(state.position.col(i), face);
      const double q = to_face.norm() / (least_squares_constants().face_reach * p_.spacing);
      if (q >= 1 || !is_over(boundary, state, i, j)) continue;
      const double part =
          p_.submerged ? part_in_mean<dim>(boundary, boundary.point_of(j), state.position.col(i), p_.spacing)
                       : 1;
      const double w = part * (1 - q) * (1 - q);
      sum += w * (state.velocity.col(i) + velocity_gradient(i) * to_face);
      weights += w;
    }
    wall_.mean_velocity.col(j - boundary.water()).setZero();
    if (weights > 0) wall_.mean_velocity.col(j - boundary.water()) = sum / weights - state.velocity.col(j);
  }
}

// Returns χ (F36), the mean slope of the pressure over h = l0/2, divided by that at the face. With sound the
// slope falls as exp(−x/(cΔt)). Its mean is (cΔt/h) (1 − exp(−h/(cΔt))) of that at the face; 1 for c = ∞.
template <int dim>
double LeastSquaresScheme<dim>::slope_share(double dt) const {
  if (!std::isfinite(p_.sound_speed)) return 1;
  const double layers = 0.5 * p_.spacing / (p_.sound_speed * dt);
  return (1 - std::exp(-layers)) / layers;
}

template <int dim>
Vector<dim> LeastSquaresScheme<dim>::carried_wall_velocity(const State<dim>& state, std::int64_t i,
                                                           const Vector<dim>& relative) const {
  Vector<dim> carried = equation_.carried[i] * state.residual_wall_velocity.col(i);
  if (now_.deferred > 0)
    carried += now_.deferred * equation_.incompressible[i] * (relative - now_.gravity_velocity);
  return carried;
}

// Computes q_ij. The carried residual is reduced for water nearer to a face than the first layer of a
// lattice, and zero below 0.3 l0: that water is stopped at once.
template <int dim>
double LeastSquaresScheme<dim>::wall_pressure_increment(const Boundary<dim>& boundary,
                                                        const State<dim>& state, std::int64_t i,
                                                        std::int64_t j, const Vector<dim>& projected,
                                                        double slope) const {
  const LeastSquaresConstants& tuned = least_squares_constants();
  const Vector<dim> from_row =
      boundary.tank().periodic().separation(state.position.col(j), state.position.col(i));
  const double height =
      walls_.corner(j) ? 0.5 * projected.norm() : walls_.normal(j).dot(from_row) - walls_.depth(j);
  const double free =
      std::clamp((height / p_.spacing - tuned.stopped) / (tuned.first_row - tuned.stopped), 0.0, 1.0);
  const Vector<dim> u = relative_wall_velocity(boundary, state, i, j);
  const Vector<dim> past =
      u + absorbing_velocity(boundary, state, i, j) - free * carried_wall_velocity(state, i, u);
  const double q = slope * past.dot(projected);
  const double tension = equation_.tension[i];
  if (q >= 0 || tension == 1) return q;
  // The limit is p_i + (h/|P r|) q ≥ min(0, p_i), and holds in part where water carries some tension (F46).
  // h is the particle's height over the face; in a corner half of |P r|.
  const double part = std::clamp(height / projected.norm(), 0.0, 1.0);
  const double limited = std::max(q, part > tuned.smallest ? -std::max(0.0, state.pressure[i]) / part : 0.0);
  return std::lerp(limited, q, tension);
}

// Computes R_i of (F52). Let s be the gradient fitted from the water neighbours only,
//   A ∇p = Σ_layers w q P r/r² + (A − a) s.
// The force from the walls on particle i that the extrapolated face pressure p_i + h ∂p/∂n does not contain
// is
//   V (∇p − s)/2 = ½ V (A − a)⁻¹ Σ_layers w (q − ∇p·P r) P r/r².
// On an even lattice the faces then carry p_i + q/2, and momentum is exact. A film of one particle has no
// A − a across: `smallest` n0 is added.
template <int dim>
Vector<dim> LeastSquaresScheme<dim>::wall_force(std::int64_t i, const FaceSums& faces) const {
  const Tensor<dim>& inverse = moments_.a_inverse[static_cast<std::size_t>(i)];
  if (!(faces.weights > 0) || !(inverse.determinant() > least_determinant())) return Vector<dim>::Zero();
  Tensor<dim> rest = inverse.inverse() - faces.a;
  rest.diagonal().array() += least_squares_constants().smallest * gradient_.n0;
  const Vector<dim> beyond = faces.q_moment - faces.a * pressure_gradient_.col(i);
  return 0.5 * std::pow(p_.spacing, dim) / faces.weights * (rest.inverse() * beyond);
}

template <int dim>
Vector<dim> LeastSquaresScheme<dim>::residual_wall_velocity(const Boundary<dim>& boundary,
                                                            const State<dim>& state, const Neighbours& near,
                                                            std::int64_t i) const {
  const auto columns = near.row(i);
  const auto inverses = near.inverses(i);
  Tensor<dim> seen = Tensor<dim>::Zero();
  Vector<dim> left = Vector<dim>::Zero();
  for (std::size_t e = water_pairs(columns, boundary.water()); e < columns.size(); ++e) {
    const std::int64_t j = columns[e];
    if (!walls_.wet(j)) continue;
    const double share = share_of(boundary, state, i, j);
    if (!(share > 0)) continue;
    const double w = share * walls_.weight(j, gradient_.radius, inverses[e]) * inverses[e] * inverses[e];
    const Vector<dim> projected = walls_.projection(
        j, boundary.tank().periodic().separation(state.position.col(i), state.position.col(j)));
    seen.noalias() += w * projected * projected.transpose();
    left += w * projected *
            projected.dot(relative_wall_velocity(boundary, state, i, j) +
                          absorbing_velocity(boundary, state, i, j));
  }
  if (!(seen.trace() > 0)) return left;
  seen.diagonal().array() += least_squares_constants().singular * seen.trace();  // no condition along a face
  return seen.inverse() * left;
}

template <int dim>
LayerForces<dim> LeastSquaresScheme<dim>::layer_forces(const Boundary<dim>& boundary, State<dim>& state,
                                                       const Neighbours& near) const {
  const auto n = static_cast<std::int64_t>(state.kind.size());
  const std::int64_t water = boundary.water();
  LayerForces<dim> forces = LayerForces<dim>::Zero(dim, n);
#pragma omp parallel for schedule(static)
  for (std::int64_t j = water; j < n; ++j) {
    if (boundary.master_of(j) >= 0 || !walls_.wet(j) || walls_.corner(j)) continue;
    const Vector<dim> normal = walls_.normal(j), area = walls_.bare(j) * boundary.face_area(j);
    const Vector<dim> face = state.position.col(j) + walls_.depth(j) * normal;
    const auto columns = near.row(j);
    const auto inverses = near.inverses(j);
    double sum = 0, weights = 0, reactions = 0, tension = 0, least = 0;
    for (std::size_t e = 0; e < columns.size() && columns[e] < water; ++e) {
      const std::int64_t i = columns[e];
      const double w = walls_.weight(j, gradient_.radius, inverses[e]);
      if (w <= 0 || !is_over(boundary, state, i, j)) continue;
      const double up = normal.dot(boundary.tank().periodic().separation(state.position.col(i), face));
      const double on_face = state.pressure[i] + up * normal.dot(pressure_gradient_.col(i));
      const double limited = std::max(std::min(0.0, state.pressure[i]), on_face);
      sum += w * std::lerp(limited, on_face, static_cast<double>(equation_.tension[i]));
      tension += w * equation_.tension[i];
      least = std::min(least, state.pressure[i]);
      reactions += w * normal.dot(wall_.force.col(i).template cast<double>());
      weights += w;
    }
    if (weights <= 0 || !(area.norm() > 0)) continue;
    const double pressure = sum / weights - reactions / area.norm();
    const double limited = std::max(least, pressure);
    state.pressure[j] = std::lerp(limited, pressure, tension / weights);
    forces.col(j) = -state.pressure[j] * area;
  }
  return forces;
}

#define STRAKE_INSTANTIATE(dim)                                                                              \
  template double LeastSquaresScheme<dim>::inside_end(const Boundary<dim>&, const State<dim>&, std::int64_t, \
                                                      std::int64_t) const;                                   \
  template bool LeastSquaresScheme<dim>::is_over(const Boundary<dim>&, const State<dim>&, std::int64_t,      \
                                                 std::int64_t) const;                                        \
  template double LeastSquaresScheme<dim>::share_of(const Boundary<dim>&, const State<dim>&, std::int64_t,   \
                                                    std::int64_t) const;                                     \
  template Vector<dim> LeastSquaresScheme<dim>::relative_wall_velocity(                                      \
      const Boundary<dim>&, const State<dim>&, std::int64_t, std::int64_t) const;                            \
  template void LeastSquaresScheme<dim>::cover_layers(const Boundary<dim>&, const State<dim>&,               \
                                                      const Neighbours&);                                    \
  template void LeastSquaresScheme<dim>::average_wall_velocity(const Boundary<dim>&, const State<dim>&,      \
                                                               const Neighbours&);                           \
  template Vector<dim> LeastSquaresScheme<dim>::absorbing_velocity(const Boundary<dim>&, const State<dim>&,  \
                                                                   std::int64_t, std::int64_t) const;        \
  template double LeastSquaresScheme<dim>::depth_of(const Boundary<dim>&, const Vector<dim>&) const;         \
  template double LeastSquaresScheme<dim>::still_pressure(const Boundary<dim>&, const Vector<dim>&) const;   \
  template double LeastSquaresScheme<dim>::wall_pressure_increment(                                          \
      const Boundary<dim>&, const State<dim>&, std::int64_t, std::int64_t, const Vector<dim>&, double)       \
      const;                                                                                                 \
  template Vector<dim> LeastSquaresScheme<dim>::wall_force(std::int64_t, const FaceSums&) const;             \
  template Vector<dim> LeastSquaresScheme<dim>::residual_wall_velocity(                                      \
      const Boundary<dim>&, const State<dim>&, const Neighbours&, std::int64_t) const;                       \
  template double LeastSquaresScheme<dim>::slope_share(double) const;                                        \
  template LayerForces<dim> LeastSquaresScheme<dim>::layer_forces(const Boundary<dim>&, State<dim>&,         \
                                                                  const Neighbours&) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
