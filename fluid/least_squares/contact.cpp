#include "fluid/least_squares/scheme.hpp"
#include "fluid/particles/pair_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

// Computes how water takes on the faces of bodies that it has just met (F71). A face that becomes wet enters
// the equation of all water within 3.1 l0 at once. Water that is not the nearest may approach it with the
// speed of the jet, or leave it. Without what follows that acts as an impact: ρcu with sound, ρ u l0/Δt
// without.

namespace strake::fluid {

/// Returns −Σ w r over the water and the wet layers of the tank about particle i. It points to the air.
template <int dim>
Vector<dim> LeastSquaresScheme<dim>::to_air(const Boundary<dim>& boundary, const State<dim>& state,
                                            const Neighbours& far, std::int64_t i) const {
  const auto columns = far.row(i);
  const std::int64_t first = far.start()[static_cast<std::size_t>(i)];
  Vector<dim> out = Vector<dim>::Zero();
  for (std::size_t e = 0; e < columns.size() && columns[e] < boundary.first_of_bodies(); ++e) {
    const double w = walls_.pair_weight(columns[e], gradient_.radius,
                                        far.inverse_of(first + static_cast<std::int64_t>(e)));
    out -= std::max(0.0, w) *
           boundary.tank().periodic().separation(state.position.col(i), state.position.col(columns[e]));
  }
  return out;
}

/// Whether contact meets water at x next: it is under dry faces of a body that go on along n, and under no
/// wet one. Under: less than under_face beside the middle of a face of rows.
template <int dim>
static bool is_next(const WallContact<dim>& walls, const Boundary<dim>& boundary, const State<dim>& state,
                    std::span<const int> rows, const Vector<dim>& x, const Vector<dim>& normal,
                    double spacing) {
  const LeastSquaresConstants& tuned = least_squares_constants();
  bool dry = false;
  for (const std::int64_t j : rows) {
    if (j < boundary.first_of_bodies()) continue;
    const Vector<dim> r = boundary.tank().periodic().separation(state.position.col(j), x),
                      n = walls.normal(j);
    if ((r - r.dot(n) * n).norm() >= tuned.under_face * spacing) continue;
    if (walls.wet(j)) return false;
    dry = dry || n.dot(normal) > tuned.goes_on;
  }
  return dry;
}

/// Returns the mean place, seen from particle i, of the free surface that contact has not reached yet:
///   a = Σ w_L κ r/Σ w_L κ
/// over the water that contact meets next, κ of (F39). It is zero where there is none, or where it lies on
/// several sides of i.
template <int dim>
Vector<dim> LeastSquaresScheme<dim>::ahead(const Boundary<dim>& boundary, const State<dim>& state,
                                           const Neighbours& far, std::int64_t i) const {
  const auto columns = far.row(i);
  const std::int64_t first = far.start()[static_cast<std::size_t>(i)];
  const auto& periodic = boundary.tank().periodic();
  Vector<dim> normal = Vector<dim>::Zero();  // of the nearest wet face
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::int64_t j : columns) {
    if (j < boundary.first_of_bodies() || !walls_.wet(j)) continue;
    const double distance = periodic.separation(state.position.col(i), state.position.col(j)).squaredNorm();
    if (distance >= nearest) continue;
    nearest = distance;
    normal = walls_.normal(j);
  }
  Vector<dim> sum = Vector<dim>::Zero();
  double weight = 0, length = 0;
  for (std::size_t e = 0; e < columns.size() && columns[e] < boundary.water(); ++e) {
    const std::int64_t k = columns[e];
    if (!(surface_.kappa[k] > 0)) continue;
    if (!is_next<dim>(walls_, boundary, state, columns, state.position.col(k), normal, p_.spacing)) continue;
    const double inverse = far.inverse_of(first + static_cast<std::int64_t>(e)),
                 w = surface_.kappa[k] * (laplacian_.radius * inverse - 1);
    const Vector<dim> r = periodic.separation(state.position.col(i), state.position.col(k));
    sum += w * r;
    weight += w;
    length += w * r.norm();
  }
  return sum.norm() > least_squares_constants().one_sided * length ? Vector<dim>(sum / weight)
                                                                   : Vector<dim>::Zero();
}

/// Computes `to_air` and `ahead` of the water beside bodies, and gives them to the ghosts, which have no
/// rows.
template <int dim>
void LeastSquaresScheme<dim>::share_to_air(const Boundary<dim>& boundary, const State<dim>& state,
                                           const Neighbours& far) {
  wall_.to_air.setZero(dim, boundary.water());
  if constexpr (dim == 2) {
    ranks_.update(surface_.kappa, Rings::first);
    wall_.ahead.setZero(dim, boundary.water());
  }
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    const auto columns = far.row(i);
    if (columns.empty() || columns.back() < boundary.first_of_bodies()) continue;
    wall_.to_air.col(i) = to_air(boundary, state, far, i);
    if constexpr (dim == 2) wall_.ahead.col(i) = ahead(boundary, state, far, i);
  }
  ranks_.update(wall_.to_air, Rings::first);
  if constexpr (dim == 2) ranks_.update(wall_.ahead, Rings::first);
}

/// Returns tan β of the angle between a face with the normal n and the surface of water. out: to the air,
/// along the surface's normal.
static double tangent_to_surface(const auto& out, const auto& n) {
  const LeastSquaresConstants& tuned = least_squares_constants();
  if (!(out.squaredNorm() > 0)) return tuned.steepest;
  const double cosine = -out.normalized().dot(n);
  if (!(cosine > 0)) return tuned.steepest;
  return std::min(tuned.steepest, std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine);
}

/// Returns the same angle from the surface that contact will meet next: tan β = a·n/|a − a·n n|, not below 0.
static double tangent_ahead(const auto& ahead, const auto& n) {
  const double rise = ahead.dot(n), along = (ahead - rise * n).norm();
  return along > 0 ? std::clamp(rise / along, 0.0, least_squares_constants().steepest) : 0.0;
}

/// Returns the time in which contact passes a face that has become wet:
///   T = l0/max(u_n/tan β, u_t) ,
/// u_n and u_t the approach and the slip of the nearest water. A level face has β = 0 and T = 0: there the
/// whole face meets the water at once. The surface of a film lies along the face too, yet faces meet it one
/// after the other. So for the part φ of (F69) β is a right angle.
template <int dim>
double LeastSquaresScheme<dim>::passing_time(const Boundary<dim>& boundary, const State<dim>& state,
                                             const Neighbours& far,
                                             const typename WallContact<dim>::Joined& face) const {
  const Vector<dim> n = walls_.normal(face.row),
                    past = state.velocity.col(face.nearest) - state.velocity.col(face.row);
  const double approach = std::max(0.0, -past.dot(n)), slip = (past - past.dot(n) * n).norm();
  const auto passing = [&](double tangent) {
    const double speed = std::max(approach, slip * tangent);
    return speed > 0 ? p_.spacing * tangent / speed : 0.0;
  };
  const Vector<dim> out = ranks_.several() ? Vector<dim>(wall_.to_air.col(face.nearest))
                                           : to_air(boundary, state, far, face.nearest);
  double tangent = tangent_to_surface(out, n);
  if constexpr (dim == 2) {
    const Vector<dim> next = ranks_.several() ? Vector<dim>(wall_.ahead.col(face.nearest))
                                              : ahead(boundary, state, far, face.nearest);
    tangent = std::max(tangent, tangent_ahead(next, n));
  }
  return std::max(passing(tangent), film_.share[face.nearest] * passing(least_squares_constants().steepest));
}

/// Takes from the lag of a particle what fades in one step.
template <int dim>
void LeastSquaresScheme<dim>::fade_lag(State<dim>& state, std::int64_t i) const {
  const double left = std::max(0.0, std::abs(state.face_lag[i]) - now_.fading * state.face_lag_rate[i]);
  state.face_lag[i] = std::copysign(left, state.face_lag[i]);
}

template <int dim>
void LeastSquaresScheme<dim>::fade_lags(const Boundary<dim>& boundary, State<dim>& state) const {
  for (std::int64_t i = 0; i < boundary.water(); ++i)
    if (state.face_lag[i] != 0) fade_lag(state, i);
}

/// Sets the lag of the water beside faces that have just become wet, so that its equation does not change by
/// them at that moment:
///   Σ_wet w |P r| lag' = Σ_wet before w |P r| lag + Σ_new w |P r| u_n ,
/// u_n its own approach to the new faces. From there the lag falls to zero in T (F71).
template <int dim>
void LeastSquaresScheme<dim>::meet_faces(const Boundary<dim>& boundary, State<dim>& state,
                                         const Neighbours& far) {
  if (!ranks_.any(!walls_.joined().empty())) return;
  wall_.meeting.clear();
  wall_.passing.setZero(state.position.cols() - boundary.water());
  if (ranks_.several()) share_to_air(boundary, state, far);
  for (const auto& face : walls_.joined())
    wall_.passing[face.row - boundary.water()] = passing_time(boundary, state, far, face);
  ranks_.update_layers(wall_.passing, 0);
  for (const auto& face : walls_.joined()) {
    const double time = wall_.passing[face.row - boundary.water()];
    const auto columns = far.row(face.row);
    const std::int64_t first = far.start()[static_cast<std::size_t>(face.row)];
    for (std::size_t e = 0; e < columns.size() && columns[e] < boundary.water(); ++e) {
      const std::int64_t i = columns[e];
      const double w = face_weight(boundary, state, far, i, face.row, first + static_cast<std::int64_t>(e));
      const double lacking = state.face_lag[i];
      state.face_lag[i] = 0;
      const double approach =
          -walls_.normal(face.row).dot(relative_wall_velocity(boundary, state, i, face.row));
      state.face_lag[i] = lacking;
      wall_.meeting.push_back({i, w, time > 0 ? w * approach : 0.0, time});
    }
  }
  std::stable_sort(wall_.meeting.begin(), wall_.meeting.end(),
                   [](const Meeting& a, const Meeting& b) { return a.particle < b.particle; });
  for (std::size_t k = 0; k < wall_.meeting.size();) {
    Meeting all = wall_.meeting[k];
    for (++k; k < wall_.meeting.size() && wall_.meeting[k].particle == all.particle; ++k) {
      all.weight += wall_.meeting[k].weight;
      all.approach += wall_.meeting[k].approach;
      all.time = std::min(all.time, wall_.meeting[k].time);
    }
    if (all.weight > 0) set_lag(boundary, state, far, all);
  }
  ranks_.update(state.face_lag);
  ranks_.update(state.face_lag_rate);
}

/// Sets lag' of one particle, and its rate |lag'|/T. T is the least over the new faces, at most the time in
/// which the particle comes to stopped_height:
///   T ≤ 2 (h − stopped_height)/|lag'| ,  h its height over the nearest wet face.
template <int dim>
void LeastSquaresScheme<dim>::set_lag(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& far,
                                      const Meeting& met) {
  const LeastSquaresConstants& tuned = least_squares_constants();
  const std::int64_t i = met.particle;
  const auto columns = far.row(i);
  const std::int64_t first = far.start()[static_cast<std::size_t>(i)];
  double wet = 0, height = std::numeric_limits<double>::infinity();
  for (std::size_t e = water_pairs(columns, boundary.water()); e < columns.size(); ++e) {
    const std::int64_t j = columns[e];
    if (j < boundary.first_of_bodies() || !walls_.wet(j)) continue;
    wet += face_weight(boundary, state, far, i, j, first + static_cast<std::int64_t>(e));
    if (!is_over(boundary, state, i, j)) continue;
    const Vector<dim> x = state.position.col(j) +
                          boundary.tank().periodic().separation(state.position.col(j), state.position.col(i));
    height = std::min(height, walls_.height(j, state.position.col(j), x));
  }
  if (!(wet > 0)) return;
  const double lag = ((wet - met.weight) * state.face_lag[i] + met.approach) / wet;
  double time = met.time;
  if (lag != 0)
    time = std::min(time, 2 * p_.spacing *
                              std::max(tuned.least_stopping, height / p_.spacing - tuned.stopped_height) /
                              std::abs(lag));
  state.face_lag[i] = time > 0 ? lag : 0;
  state.face_lag_rate[i] = time > 0 ? std::abs(lag) / time : 0;
  fade_lag(state, i);
}

#define STRAKE_INSTANTIATE(dim)                                                                             \
  template Vector<dim> LeastSquaresScheme<dim>::to_air(const Boundary<dim>&, const State<dim>&,             \
                                                       const Neighbours&, std::int64_t) const;              \
  template Vector<dim> LeastSquaresScheme<dim>::ahead(const Boundary<dim>&, const State<dim>&,              \
                                                      const Neighbours&, std::int64_t) const;               \
  template void LeastSquaresScheme<dim>::share_to_air(const Boundary<dim>&, const State<dim>&,              \
                                                      const Neighbours&);                                   \
  template double LeastSquaresScheme<dim>::passing_time(                                                    \
      const Boundary<dim>&, const State<dim>&, const Neighbours&, const typename WallContact<dim>::Joined&) \
      const;                                                                                                \
  template void LeastSquaresScheme<dim>::fade_lags(const Boundary<dim>&, State<dim>&) const;                \
  template void LeastSquaresScheme<dim>::meet_faces(const Boundary<dim>&, State<dim>&, const Neighbours&);  \
  template void LeastSquaresScheme<dim>::set_lag(const Boundary<dim>&, State<dim>&, const Neighbours&,      \
                                                 const Meeting&);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
