#include "fluid/least_squares/images.hpp"
#include "fluid/mps/pressure_equation.hpp"
#include "fluid/particles/pair_loop.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace strake::fluid {
template <int dim>
void LeastSquaresScheme<dim>::begin_equation(const Boundary<dim>& boundary, const State<dim>& state,
                                             const Vector<dim>& gravity) {
  equation_.limited.assign(static_cast<std::size_t>(boundary.water()), Limit::none);
  equation_.tension.setOnes(boundary.water());
  now_.gravity = gravity;
  now_.largest_speed = fastest(boundary, state);
  now_.deferred = 1 - corrected_fraction(state);
  now_.gravity_velocity = now_.projection * gravity;
}

/// Gives the matrix the rows of far. Row and unknown have the number of their particle. A removed particle
/// has neither neighbours nor pressure.
template <int dim>
void LeastSquaresScheme<dim>::share_rows(const Neighbours& far, PressureSystem& system) const {
  const auto water = moments_.diagonal.size();
  if (system.size() != water) {
    system.particle.resize(static_cast<std::size_t>(water));
    std::iota(system.particle.begin(), system.particle.end(), 0);
  }
  system.start = far.start();
  system.stop = moments_.water_stop;
  system.column = far.column();
  system.value = moments_.own_entries ? moments_.entry : far.entry();
  system.diagonal.resize(water);
  system.right.resize(water);
  if (!ranks_.several()) return;
  system.diagonal.setZero();  // of ghosts
  system.right.setZero();
}

/// Computes what of particle i's δ counts in (F40), less what water that starts packed had at the start.
/// Too much water counts in full. A lack of it does not beside the surface (σ > 0); in water with a body that
/// stood in it (F88)
///   δ' = (1−σ) δ/(1 + (δ/δ_m)²) .
/// Drift inside the water leaves lacks of some percent. A larger one is air: between the water and a hull
/// that leans over it, which no pressure may pull in. With sound what the pressure compresses is no error:
/// less (pⁿ − p_0)/(ρc²), p_0 the pressure of the water when δ was 0. With a body that stood in it this is
/// the pressure at rest, else 0.
template <int dim>
double LeastSquaresScheme<dim>::counted_deviation(const Boundary<dim>& boundary, const State<dim>& state,
                                                  std::int64_t i) const {
  const double share = surface_.share[i];
  const auto counted = [&](double deviation) {
    if (deviation >= 0) return deviation;
    if (!p_.submerged) return share > 0 ? 0.0 : deviation;
    const double part = deviation / least_squares_constants().lack;
    return (1 - share) * deviation / (1 + part * part);
  };
  const double now = counted(volume_deviation(i)),
               started = starts_packed() ? start_share(boundary, state, i) : 0;
  const double packed =
      started > 0 ? now - started * counted(start_.deviation[state.id[static_cast<std::size_t>(i)]]) : now;
  const double c = p_.sound_speed;
  if (!std::isfinite(c)) return packed;
  // This pressure is of the same time as the volumes.
  const auto& p = velocity_.age > 0 ? equation_.pressure_at_start : state.pressure;
  const Vector<dim> x = state.position.col(i);
  const double at_start = p_.submerged || p_.starts_level() ? still_pressure(boundary, x) : 0.0;  // p_0
  return packed - compressible(boundary, x) * (p[i] - at_start) / (p_.density * c * c);
}

/// Assembles row i of (F40), with the sign of PressureSystem and s = n0 λ/(2d):
///   Σ_water w (p_i − p_j) + κ p_i + s p_i/(c²ΔtΔt_p)
///     + (Σ_layers w (−n·P r) + s g)/(cΔt_p) (p_i − p_still)
///     = Σ_layers w (ρ/Δt_p) (u**−U)·P r − (1−σ) ρ g·m_P − s (ρ/Δt_p) (∇·u** − E_i)
///       + s pⁿ/(c²ΔtΔt_p) + s (ρ γ/(ΔtΔt_p)) (δ − (pⁿ − p_0)/(ρc²)),
/// n the normals of absorbing walls, γ of drift_share. With a SoundLayer 1/c² and the sum over absorbing
/// walls are multiplied by its compressible part at the particle's depth, and g is its own. δ = Σ W/Σ_lattice
/// W − 1 is not below zero beside the surface. Where 1 − π > 0, that part of the change is left to the next
/// steps (F45).
template <int dim>
void LeastSquaresScheme<dim>::assemble(const Boundary<dim>& boundary, State<dim>& state,
                                       const Neighbours& far, const Neighbours& near,
                                       const Vector<dim>& gravity, double dt, PressureSystem& system) {
  average_wall_velocity(boundary, state, far);
  if (!(velocity_.age > 0)) meet_faces(boundary, state, far);
  begin_projection(boundary, state, far, near, dt);
  begin_equation(boundary, state, gravity);
  find_image_velocities(boundary, state, now_.gravity_velocity, dt);
  share_rows(far, system);
  const CarriedFraction fraction = carried_fraction(dt);
  const double part = corrected_fraction(state);
  equation_.kept = p_.submerged ? fraction.elsewhere * part : 0.0;
  const double rho = p_.density, c = p_.sound_speed, projection = now_.projection;
  const double scale = laplacian_.n0 * laplacian_.lambda0 / (2.0 * dim);
  const double compression = std::isfinite(c) ? scale / (c * c * dt * projection) : 0.0;
  double drift = scale * rho * drift_share(dt) / (dt * projection);
  if (p_.scheme.source == Source::divergence) drift = 0;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    if (!ranks_.owns(i)) continue;  // its owner has the row
    const WallTerms wall = wall_terms(boundary, state, far, i);
    double local = compression, sheet = 0, sound = 1;
    if (!sound_.is_whole()) {
      const double depth = depth_of(boundary, state.position.col(i));
      sound = sound_.compressible(depth);
      local = sound * compression;
      sheet = scale * sound_.yields(depth) / (c * projection);
    }
    const double absorption = sound * wall.absorption + sheet;  // Y_i
    const double deviation = counted_deviation(boundary, state, i);
    const double share = surface_.share[i], own = local + absorption;
    equation_.own[i] = static_cast<float>(own);
    double& source = equation_.source[i] = local * state.pressure[i] + drift * deviation;
    if (absorption > 0) source += absorption * still_pressure(boundary, state.position.col(i));
    system.diagonal[i] = moments_.diagonal[i] + surface_.kappa[i] + own;
    const double incompressible = 1 - local / system.diagonal[i];
    double carried = 0.5 * (1 + share) * fraction.of(wall.beside) * part * incompressible;
    if (!p_.submerged && images_.at_edge[static_cast<std::size_t>(i)])
      carried = std::max(carried, fraction.at_edge * part);
    equation_.incompressible[i] = static_cast<float>(incompressible);
    equation_.carried[i] = static_cast<float>(carried);
    if (now_.deferred > 0)
      source += now_.deferred * incompressible *
                (rho / projection *
                     (scale * divergence(i) - wall.flux + now_.gravity_velocity.dot(wall.projected)) +
                 own * state.pressure[i] - source);
    const double at_edge = state.edge_divergence[i];  // k_i of (F94)
    const double left = divergence(i) - carried * (state.residual_divergence[i] - at_edge);
    system.right[i] =
        rho / projection * (wall.flux - scale * (left - equation_.kept * at_edge)) -
        rho * gravity.dot((1 - share) * moments_.m_projected.col(i).template cast<double>() + wall.images) +
        source + surface_.kappa[i] * air_->above(i);
    // Without a neighbour and without compressibility the pressure is undetermined: it is set to zero.
    if (system.diagonal[i] <= 0 || boundary.is_removed(state, i)) {
      system.diagonal[i] = 1;
      system.right[i] = 0;
    }
  }
}

template <int dim>
typename LeastSquaresScheme<dim>::WallTerms LeastSquaresScheme<dim>::wall_terms(const Boundary<dim>& boundary,
                                                                                const State<dim>& state,
                                                                                const Neighbours& far,
                                                                                std::int64_t i) const {
  const auto& periodic = boundary.tank().periodic();
  const bool absorbs = boundary.tank().absorbs();
  const auto k = static_cast<std::size_t>(i);
  const auto columns = far.row(i);
  WallTerms out;
  for (auto e = static_cast<std::size_t>(moments_.water_stop[k] - far.start()[k]); e < columns.size(); ++e) {
    const std::int64_t j = columns[e];
    if (!walls_.wet(j)) continue;
    if (j >= boundary.first_of_bodies() && out.beside != Beside::other_face)
      out.beside = !boundary.volume() && boundary.is_between_sharp_corners(boundary.point_of(j))
                       ? Beside::plate
                       : Beside::other_face;
    const Vector<dim> r = periodic.separation(state.position.col(i), state.position.col(j));
    const double w =
        walls_.weight(j, laplacian_.radius, far.inverse_of(far.start()[k] + static_cast<std::int64_t>(e)));
    const Vector<dim> projected = walls_.projection(j, r);
    out.flux += w * relative_wall_velocity(boundary, state, i, j).dot(projected);
    out.projected += w * projected;
    if (absorbs)
      out.absorption -= w * boundary.tank().absorbing(j).dot(projected) / (p_.sound_speed * now_.projection);
  }
  for_each_image(i, [&](std::size_t, double w, const Vector<dim>& r, const Vector<dim>& n, double slope) {
    const double up = n.dot(r);
    out.flux -= w * slope * up;
    out.projected -= w * up * n;
    out.images += w * (r - up * n);
  });
  return out;
}

template <int dim>
double LeastSquaresScheme<dim>::fastest(const Boundary<dim>& boundary, const State<dim>& state) const {
  const bool moves = boundary.tank().moves();
  double square = 0;
#pragma omp parallel for schedule(static) reduction(max : square)
  for (Eigen::Index i = 0; i < state.velocity.cols(); ++i) {
    Vector<dim> past = state.velocity.col(i);
    if (moves) past -= boundary.tank().velocity_at(state.position.col(i));
    square = std::max(square, past.squaredNorm());
  }
  return std::sqrt(ranks_.max(square));
}

// Returns g·H, the square of the speed of the water's waves [m²/s²]. H is the water's extent at the start.
template <int dim>
double LeastSquaresScheme<dim>::wave_speed_squared() const {
  return now_.gravity.cwiseAbs().dot((p_.water.max - p_.water.min).template head<dim>());
}

// Returns γ = Δt/τ' of (F41), the part of the density error that a step removes. Disorder, and with it the
// error, grows while water passes a spacing. Removing it faster would disturb a slow flow. Under a free
// surface the error is also one of depth, which waves level: there U_m ≥ √(gH).
template <int dim>
double LeastSquaresScheme<dim>::drift_share(double dt) const {
  const double share = drift_factor(p_.scheme, dt);
  if (!(p_.scheme.tau > 0)) return share;
  const double speed =
      full_ ? now_.largest_speed : std::max(now_.largest_speed, std::sqrt(wave_speed_squared()));
  return std::min(share, dt * speed / p_.spacing);
}

// Returns the fraction of the residual divergence that is carried to the next step (F44), u = max|u| past the
// tank:
//   max(0, 1 − Δt (u + √(g l0))/l0) ,   beside a plate or box max(0, 1 − Δt u/l0) u²/(u² + gH) ,
// beside other bodies 0. The factors of each particle come later. In the last column before a plate's free
// end
//   max(0, 1 − cΔt/(2 r_e)) max(0, 1 − Δt (u + √(g l0))/l0)
// is the least (F84), r_e the radius of the gradient; with a body that stood in the water (F94) is in its
// place. Divergence and gradient are not adjoint.
// Removing all of the residual in each step amplifies some modes by up to 5 % per step, still water then
// never rests, and the less so the shorter the steps. A residual that is left beside a body makes its force
// lag behind its motion.
template <int dim>
auto LeastSquaresScheme<dim>::carried_fraction(double dt) const -> CarriedFraction {
  const double u = now_.largest_speed, free_fall = std::sqrt(now_.gravity.norm() * p_.spacing);
  CarriedFraction out;
  out.elsewhere = std::max(0.0, 1 - dt * (u + free_fall) / p_.spacing);
  if (u > 0) out.beside_plate = std::max(0.0, 1 - dt * u / p_.spacing) / (1 + wave_speed_squared() / (u * u));
  out.at_edge = out.elsewhere * std::max(0.0, 1 - p_.sound_speed * dt / (2 * gradient_.radius));
  return out;
}

// Returns π = min(1, Δt_p/τ_r) (F45), the fraction of the accumulated position error that this step corrects.
// After a drop of the step, correcting all of it would need a pressure τ_r/Δt_p times larger. τ_r is bounded
// by the CFL number: where steps are short because the water has become fast, nothing is deferred.
template <int dim>
double LeastSquaresScheme<dim>::corrected_fraction(const State<dim>& state) const {
  const double time = std::min(
      state.residual_step, now_.largest_speed > 0 ? p_.scheme.cfl * p_.spacing / now_.largest_speed : 0.0);
  return now_.projection < time ? now_.projection / time : 1.0;
}

/// Computes e_i of (F43), the divergence that the step has left at the same positions:
///   e = ∇·u − Σ_layers w (u−U)·P r/s + Δt_p/(ρs) (own p − source)
/// This is ∇·u of the new velocity, with walls, less what the equation asked for. Where tension was limited
/// water may open freely, and only a negative e is kept. Without that the next step would have to correct all
/// of it at once. The part of e that the ends of faces keep (F94) stays where the pressure was limited: as
/// removed in one step it is a blow. What a projection longer than the step adds is left out, by the factor
/// Δt/Δt_p (F74).
template <int dim>
void LeastSquaresScheme<dim>::measure_residual(const Boundary<dim>& boundary, State<dim>& state,
                                               const Neighbours& far, const Neighbours& near, double dt) {
  const double length = now_.projection;
  // τ_r falls slowly against the rate Δt_p/τ_r at which the deferred part itself falls.
  const double slowly = least_squares_constants().memory_rate;
  if (now_.deferred > 0)
    state.residual_step -= slowly * (1 - now_.deferred) * std::max(0.0, state.residual_step - length);
  else
    state.residual_step = length;
  fit_velocity(boundary, state, near);
  average_wall_velocity(boundary, state, far);
  find_image_velocities(boundary, state, Vector<dim>::Zero(), dt);
  const double scale = laplacian_.n0 * laplacian_.lambda0 / (2.0 * dim);
  const double factor = length / (p_.density * scale);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    if (!ranks_.owns(i)) continue;
    const double kept = equation_.kept * state.edge_divergence[i];
    const double before =
        equation_.carried[i] * (state.residual_divergence[i] - state.edge_divergence[i]) + kept;
    state.residual_divergence[i] = state.edge_divergence[i] = 0;
    state.residual_wall_velocity.col(i).setZero();
    if (boundary.is_removed(state, i)) continue;
    const Limit limit = equation_.limited[static_cast<std::size_t>(i)];
    state.residual_divergence[i] = state.edge_divergence[i] = kept;
    if (limit == Limit::at_surface) continue;
    double left = divergence(i) - wall_terms(boundary, state, far, i).flux / scale +
                  factor * (equation_.own[i] * state.pressure[i] - equation_.source[i]);
    if (dt < length) left = before + dt / length * (left - before);
    if (limit == Limit::tension) left = std::min(kept, left);
    state.residual_divergence[i] = left;
    if (p_.submerged && images_.at_edge[static_cast<std::size_t>(i)]) state.edge_divergence[i] = left;
    if (limit != Limit::none) continue;
    state.residual_wall_velocity.col(i) = residual_wall_velocity(boundary, state, near, i);
    if (now_.deferred > 0)
      state.residual_wall_velocity.col(i) -= wall_.deferred_velocity.col(i).template cast<double>();
  }
}

template <int dim>
void LeastSquaresScheme<dim>::limit_at_surface(const Boundary<dim>& boundary, State<dim>& state,
                                               const Neighbours& near) {
  const std::int64_t water = boundary.water();
  // Particles that are limited, less deep than a spacing, read only particles that are not. Their next rows
  // count as inner water: the third row of a rough surface may lie out of reach.
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (!ranks_.owns(i) || !state.surface[static_cast<std::size_t>(i)] || !(state.pressure[i] > 0)) continue;
    double inside = std::max(0.0, air_->above(i));
    bool walled = false;
    for (const std::int32_t j : near.row(i)) {
      if (j >= water)
        walled = walled || walls_.wet(j);
      else if (!state.surface[static_cast<std::size_t>(j)])
        inside = std::max(inside, state.pressure[j]);
    }
    if (!walled && inside < state.pressure[i]) {
      state.pressure[i] = inside;
      equation_.limited[static_cast<std::size_t>(i)] = Limit::at_surface;
    }
  }
}

#define STRAKE_INSTANTIATE(dim)                                                                          \
  template void LeastSquaresScheme<dim>::measure_residual(const Boundary<dim>&, State<dim>&,             \
                                                          const Neighbours&, const Neighbours&, double); \
  template void LeastSquaresScheme<dim>::limit_at_surface(const Boundary<dim>&, State<dim>&,             \
                                                          const Neighbours&);                            \
  template void LeastSquaresScheme<dim>::assemble(const Boundary<dim>&, State<dim>&, const Neighbours&,  \
                                                  const Neighbours&, const Vector<dim>&, double,         \
                                                  PressureSystem&);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
