#include "fluid/least_squares/scheme.hpp"
#include "fluid/particles/pair_loop.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace strake::fluid {

namespace {
/// Water so near to the middle of a face says what velocity and pressure are there [l0].
constexpr double face_reach = 1.6;
/// So far from a face's end a particle's own velocity counts in full [l0].
constexpr double known_from = 0.5;
}  // namespace

template <int dim>
bool LeastSquaresScheme<dim>::over(const Boundary<dim>& boundary, const State<dim>& state, std::int64_t i,
                                   std::int64_t row) const {
  return row < boundary.first_of_bodies() || boundary.volume() ||
         boundary.is_over(boundary.point_of(row), state.position.col(i));
}

// Hats of width l0 over the layer of water next to the face: a lattice's sum to one inside, and to as much of
// the row's length as lies below the water's level at its end.
template <int dim>
void LeastSquaresScheme<dim>::cover_rows(const Boundary<dim>& boundary, const State<dim>& state,
                                         const Neighbours& near) {
  const std::int64_t n = state.position.cols(), water = boundary.water();
#pragma omp parallel for schedule(static)
  for (std::int64_t j = water; j < n; ++j) {
    if (boundary.master_of(j) >= 0) continue;
    cover_[j - water] = walls_.wet(j) ? 1 : 0;
    if (!walls_.wet(j) || walls_.corner(j)) continue;
    double sum = 0;
    const auto columns = near.row(j);
    for (std::size_t e = 0; e < columns.size() && columns[e] < boundary.water(); ++e) {
      const Vector<dim> r =
          boundary.tank().periodic().separation(state.position.col(j), state.position.col(columns[e]));
      const double up = r.dot(walls_.normal(j)), aside = std::sqrt(std::max(0.0, r.squaredNorm() - up * up));
      if (up - walls_.depth(j) < p_.spacing) sum += std::max(0.0, 1 - aside / p_.spacing);
    }
    cover_[j - water] = std::min(1.0, sum);
  }
  for (std::int64_t j = boundary.water(); j < n; ++j)
    if (const std::int32_t master = boundary.master_of(j); master >= 0)
      cover_[j - water] = cover_[master - water];
}

template <int dim>
Vector<dim> LeastSquaresScheme<dim>::approach(const Boundary<dim>& boundary, const State<dim>& state,
                                              std::int64_t i, std::int64_t j) const {
  const auto mean = [&] {
    const std::int32_t master = boundary.master_of(j);
    return mean_approach_.col((master < 0 ? j : master) - boundary.water());
  };
  if (!over(boundary, state, i, j)) return mean();
  Vector<dim> u = state.velocity.col(i) - state.velocity.col(j);
  if (walls_.corner(j)) return u;
  // ∇u* carries the particle's velocity to the face; beside the free surface it is one-sided and left out.
  const double height =
      walls_.height(j, state.position.col(j),
                    boundary.tank().periodic().separation(state.position.col(j), state.position.col(i)) +
                        state.position.col(j));
  const double trust = 1 - surface_share_[i];
  u -= trust * height * (velocity_gradient(i) * walls_.normal(j));
  if constexpr (dim == 2)
    if (j >= boundary.first_of_bodies() && !boundary.volume()) {
      const double from_end = boundary.within(boundary.point_of(j), state.position.col(i)) / p_.spacing;
      if (from_end < known_from) u = mean() + from_end / known_from * (u - mean());
    }
  return u;
}

template <int dim>
double LeastSquaresScheme<dim>::depth_of(const Boundary<dim>& boundary, const Vector<dim>& x) const {
  return p_.water.max[1] - boundary.tank().in_tank(x)[1];
}

template <int dim>
double LeastSquaresScheme<dim>::still_pressure(const Boundary<dim>& boundary, const Vector<dim>& x) const {
  return std::max(0.0, -p_.density * gravity_[1] * depth_of(boundary, x));
}

template <int dim>
Vector<dim> LeastSquaresScheme<dim>::yielding(const Boundary<dim>& boundary, const State<dim>& state,
                                              std::int64_t i, std::int64_t j) const {
  if (!boundary.tank().absorbs()) return Vector<dim>::Zero();
  const double excess = state.pressure[i] - still_pressure(boundary, state.position.col(i));
  return excess / (p_.density * p_.sound_speed) * compressible(boundary, state.position.col(i)) *
         boundary.tank().absorbing(j);
}

template <int dim>
void LeastSquaresScheme<dim>::approach_from_mean(const Boundary<dim>& boundary, const State<dim>& state,
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
      const double q = to_face.norm() / (face_reach * p_.spacing);
      if (q >= 1 || !over(boundary, state, i, j)) continue;
      const double w = (1 - q) * (1 - q);
      sum += w * (state.velocity.col(i) + velocity_gradient(i) * to_face);
      weights += w;
    }
    mean_approach_.col(j - boundary.water()).setZero();
    if (weights > 0) mean_approach_.col(j - boundary.water()) = sum / weights - state.velocity.col(j);
  }
}

// Sound through a layer h: over the depth h the slope falls as exp(−x/(cΔt)), so that its mean is
// (cΔt/h) (1 − exp(−h/(cΔt))) of that at the face; 1 for c = ∞.
template <int dim>
double LeastSquaresScheme<dim>::slope_share(double dt) const {
  if (!std::isfinite(p_.sound_speed)) return 1;
  const double layers = 0.5 * p_.spacing / (p_.sound_speed * dt);
  return (1 - std::exp(-layers)) / layers;
}

// Water that comes nearer to a face than on a lattice is stopped at once.
template <int dim>
double LeastSquaresScheme<dim>::rise(const Boundary<dim>& boundary, const State<dim>& state, std::int64_t i,
                                     std::int64_t j, const Vector<dim>& held, double slope) const {
  constexpr double stopped = 0.3, free = 0.5;  // [l0]
  const Vector<dim> from_row =
      boundary.tank().periodic().separation(state.position.col(j), state.position.col(i));
  const double height =
      walls_.corner(j) ? 0.5 * held.norm() : walls_.normal(j).dot(from_row) - walls_.depth(j);
  const double eased = std::clamp((height / p_.spacing - stopped) / (free - stopped), 0.0, 1.0);
  const Vector<dim> u = approach(boundary, state, i, j);
  const Vector<dim> past = u + yielding(boundary, state, i, j) - eased * left_past(state, i, u);
  const double rise = slope * past.dot(held);
  if (tension_ || rise >= 0) return rise;
  // p_i + (h/|P r|) q ≥ min(0, p_i), h the particle's height over the face; half the way in a corner.
  const double part = std::clamp(height / held.norm(), 0.0, 1.0);
  return std::max(rise, part > 1e-3 ? -std::max(0.0, state.pressure[i]) / part : 0.0);
}

// The slope s that the water's side alone gives is that of A ∇p = Σ_rows w q P r + (A − a) s, a = Σ_rows w P
// r ⊗ P r: V (∇p − s)/2 = ½ V (A − a)⁻¹ Σ_rows w (q − ∇p·P r) P r is what particle i gets from the faces and
// neither p_i + h ∂p/∂n nor the water next to it tells of. On an even lattice faces carry p_i + q/2 with it,
// and momentum is exact.
template <int dim>
Vector<dim> LeastSquaresScheme<dim>::reaction(std::int64_t i, const Faces& faces) const {
  constexpr double least = 1e-3;  // of n0, added to A − a: a film of one particle has none across
  const Tensor<dim>& inverse = all_[static_cast<std::size_t>(i)];
  if (!(faces.weights > 0) || !(inverse.determinant() > least_determinant())) return Vector<dim>::Zero();
  Tensor<dim> rest = inverse.inverse() - faces.held;
  rest.diagonal().array() += least * gradient_.n0;
  const Vector<dim> beyond = faces.rises - faces.held * gradient_of_p_.col(i);
  return 0.5 * std::pow(p_.spacing, dim) / faces.weights * (rest.inverse() * beyond);
}

template <int dim>
Vector<dim> LeastSquaresScheme<dim>::left_approach(const Boundary<dim>& boundary, const State<dim>& state,
                                                   const Neighbours& near, std::int64_t i) const {
  const auto columns = near.row(i);
  const auto inverses = near.inverses(i);
  Tensor<dim> seen = Tensor<dim>::Zero();
  Vector<dim> left = Vector<dim>::Zero();
  for (std::size_t e = water_pairs(columns, boundary.water()); e < columns.size(); ++e) {
    const std::int64_t j = columns[e];
    if (!walls_.wet(j) || !over(boundary, state, i, j)) continue;
    const double w = (gradient_.radius * inverses[e] - 1) * inverses[e] * inverses[e];
    const Vector<dim> held =
        walls_.held(j, boundary.tank().periodic().separation(state.position.col(i), state.position.col(j)));
    seen.noalias() += w * held * held.transpose();
    left += w * held * held.dot(approach(boundary, state, i, j) + yielding(boundary, state, i, j));
  }
  if (!(seen.trace() > 0)) return left;
  seen.diagonal().array() += 1e-6 * seen.trace();  // nothing is held along a face
  return seen.inverse() * left;
}

template <int dim>
RowForces<dim> LeastSquaresScheme<dim>::row_forces(const Boundary<dim>& boundary, State<dim>& state,
                                                   const Neighbours& near) const {
  const auto n = static_cast<std::int64_t>(state.kind.size());
  const std::int64_t water = boundary.water();
  RowForces<dim> forces = RowForces<dim>::Zero(dim, n);
#pragma omp parallel for schedule(static)
  for (std::int64_t j = water; j < n; ++j) {
    if (boundary.master_of(j) >= 0 || !walls_.wet(j) || walls_.corner(j)) continue;
    const Vector<dim> normal = walls_.normal(j), area = boundary.face_area(j);
    const Vector<dim> face = state.position.col(j) + walls_.depth(j) * normal;
    const auto columns = near.row(j);
    const auto inverses = near.inverses(j);
    double sum = 0, weights = 0, reactions = 0, least = 0;
    for (std::size_t e = 0; e < columns.size() && columns[e] < water; ++e) {
      const std::int64_t i = columns[e];
      const double w = gradient_.radius * inverses[e] - 1;
      if (w <= 0 || !over(boundary, state, i, j)) continue;
      const double up = normal.dot(boundary.tank().periodic().separation(state.position.col(i), face));
      const double on_face = state.pressure[i] + up * normal.dot(gradient_of_p_.col(i));
      sum += w * (tension_ ? on_face : std::max(std::min(0.0, state.pressure[i]), on_face));
      least = std::min(least, state.pressure[i]);
      reactions += w * normal.dot(reaction_.col(i).template cast<double>());
      weights += w;
    }
    if (weights <= 0 || !(area.norm() > 0)) continue;
    const double pressure = sum / weights - reactions / area.norm();
    state.pressure[j] = tension_ ? pressure : std::max(least, pressure);
    forces.col(j) = -state.pressure[j] * area;
  }
  return forces;
}

#define STRAKE_INSTANTIATE(dim)                                                                            \
  template bool LeastSquaresScheme<dim>::over(const Boundary<dim>&, const State<dim>&, std::int64_t,       \
                                              std::int64_t) const;                                         \
  template Vector<dim> LeastSquaresScheme<dim>::approach(const Boundary<dim>&, const State<dim>&,          \
                                                         std::int64_t, std::int64_t) const;                \
  template void LeastSquaresScheme<dim>::cover_rows(const Boundary<dim>&, const State<dim>&,               \
                                                    const Neighbours&);                                    \
  template void LeastSquaresScheme<dim>::approach_from_mean(const Boundary<dim>&, const State<dim>&,       \
                                                            const Neighbours&);                            \
  template Vector<dim> LeastSquaresScheme<dim>::yielding(const Boundary<dim>&, const State<dim>&,          \
                                                         std::int64_t, std::int64_t) const;                \
  template double LeastSquaresScheme<dim>::depth_of(const Boundary<dim>&, const Vector<dim>&) const;       \
  template double LeastSquaresScheme<dim>::still_pressure(const Boundary<dim>&, const Vector<dim>&) const; \
  template double LeastSquaresScheme<dim>::rise(const Boundary<dim>&, const State<dim>&, std::int64_t,     \
                                                std::int64_t, const Vector<dim>&, double) const;           \
  template Vector<dim> LeastSquaresScheme<dim>::reaction(std::int64_t, const Faces&) const;                \
  template Vector<dim> LeastSquaresScheme<dim>::left_approach(const Boundary<dim>&, const State<dim>&,     \
                                                              const Neighbours&, std::int64_t) const;      \
  template double LeastSquaresScheme<dim>::slope_share(double) const;                                      \
  template RowForces<dim> LeastSquaresScheme<dim>::row_forces(const Boundary<dim>&, State<dim>&,           \
                                                              const Neighbours&) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
