#include "fluid/least_squares/scheme.hpp"
#include "fluid/mps/pressure_equation.hpp"
#include "fluid/particles/pair_loop.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace strake::fluid {
namespace {

/// Of a shift from x what does not go through the face of a body or of a wall.
template <int dim>
Vector<dim> before_faces(const Boundary<dim>& boundary, const Vector<dim>& x, Vector<dim> move) {
  const auto along = [&](const Vector<dim>& normal) { move -= std::min(0.0, move.dot(normal)) * normal; };
  const BodySurface<dim>& body = boundary.outline();
  if (!body.empty() && body.inside(x + move)) along(body.normal(body.nearest(x + move).point));
  if (const auto foot = boundary.tank().behind(x + move)) along(foot->normal);
  return move;
}

}  // namespace

/// Row i, times −s/ρ … as PressureSystem, s = n0 λ/(2d):
///   Σ_water w (p_i − p_j) + κ p_i + s p_i/(c²Δt²)
///     + (Σ_rows w (−m·P r) + s g)/(cΔt) (p_i − p_still)
///     = Σ_rows w q_ij − (1−σ) ρ g·m_i − s (ρ/Δt) ∇·u* + s pⁿ/(c²Δt²) + s (ρ γ/Δt²) (δ − pⁿ/(ρc²)),
/// m the normals of absorbing walls, g and 1/c² those of SoundLayer at the particle's depth, σ the surface's
/// share, γ of drift_share, δ = Σ W/Σ_lattice W − 1, not below zero beside the surface.
template <int dim>
void LeastSquaresScheme<dim>::assemble(const Boundary<dim>& boundary, const State<dim>& state,
                                       const Neighbours& far, const Vector<dim>& gravity, double dt,
                                       PressureSystem& system) {
  approach_from_mean(boundary, state, far);
  cut_.assign(static_cast<std::size_t>(boundary.water()), Cut::none);
  tension_ = true;
  gravity_ = gravity;
  speed_ = fastest(boundary, state);
  const double kept = kept_residual(dt), part = part_of_step(state, dt);
  undone_ = 1 - part;
  pull_ = dt * gravity;
  const std::int64_t water = boundary.water();
  const double rho = p_.density, c = p_.sound_speed;
  const double scale = laplacian_.n0 * laplacian_.lambda0 / (2.0 * dim);
  const double compression = std::isfinite(c) ? scale / (c * c * dt * dt) : 0.0;
  const double drift =
      p_.scheme.source == Source::divergence ? 0.0 : scale * rho * drift_share(dt) / (dt * dt);

  // Row and unknown are those of the particle; one that is parked has neither neighbours nor pressure.
  if (system.size() != water) {
    system.particle.resize(static_cast<std::size_t>(water));
    std::iota(system.particle.begin(), system.particle.end(), 0);
  }
  system.start = far.start();
  system.stop = water_stop_;
  system.column = far.column();
  system.value = shares_entries(far) ? far.entry() : entry_;
  system.diagonal.resize(water);
  system.right.resize(water);
  const double* const there = age_ > 0 ? pressure_then_.data() : state.pressure.data();  // as the volumes
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    const Inflow in = inflow(boundary, state, far, dt, i);
    double local = compression, sheet = 0, sound = 1;
    if (!sound_.is_whole()) {
      const double depth = depth_of(boundary, state.position.col(i));
      sound = sound_.compressible(depth);
      local = sound * compression;
      sheet = scale * sound_.yields(depth) / (c * dt);
    }
    const double yields = sound * in.yields + sheet;
    double deviation = volume_[i] / lattice_.volume - 1;
    const double share = surface_share_[i];
    if (share > 0) deviation = std::max(deviation, 0.0);
    if (std::isfinite(c)) deviation -= sound * there[i] / (rho * c * c);
    const double yielding = local + yields;
    yielding_[i] = static_cast<float>(yielding);
    meant_[i] = local * state.pressure[i] + drift * deviation;
    if (yields > 0) meant_[i] += yields * still_pressure(boundary, state.position.col(i));
    system.diagonal[i] = diagonal_[i] + surface_factor_[i] + yielding;
    const double soft = 1 - local / system.diagonal[i], eased = 0.5 * (1 + share) * kept * part * soft;
    soft_[i] = static_cast<float>(soft);
    eased_[i] = static_cast<float>(eased);
    if (undone_ > 0)
      meant_[i] += undone_ * soft *
                   (rho / dt * (scale * divergence(i) - in.flux + pull_.dot(in.held)) +
                    yielding * state.pressure[i] - meant_[i]);
    system.right[i] = rho / dt * (in.flux - scale * (divergence(i) - eased * state.residual_divergence[i])) -
                      (1 - share) * rho * gravity.dot(moment_.col(i).template cast<double>()) + meant_[i];
    // Nothing near and no compressibility: nothing holds a pressure.
    if (system.diagonal[i] <= 0 || boundary.parked(state, i)) {
      system.diagonal[i] = 1;
      system.right[i] = 0;
    }
  }
}

template <int dim>
typename LeastSquaresScheme<dim>::Inflow LeastSquaresScheme<dim>::inflow(const Boundary<dim>& boundary,
                                                                         const State<dim>& state,
                                                                         const Neighbours& far, double dt,
                                                                         std::int64_t i) const {
  const auto& periodic = boundary.tank().periodic();
  const bool absorbs = boundary.tank().absorbs();
  const auto k = static_cast<std::size_t>(i);
  const auto columns = far.row(i);
  Inflow in;
  for (auto e = static_cast<std::size_t>(water_stop_[k] - far.start()[k]); e < columns.size(); ++e) {
    const std::int64_t j = columns[e];
    if (!walls_.wet(j)) continue;
    const Vector<dim> r = periodic.separation(state.position.col(i), state.position.col(j));
    const double w = laplacian_.radius * far.inverse_of(far.start()[k] + static_cast<std::int64_t>(e)) - 1;
    const Vector<dim> held = walls_.held(j, r);
    in.flux += w * approach(boundary, state, i, j).dot(held);
    in.held += w * held;
    if (absorbs) in.yields -= w * boundary.tank().absorbing(j).dot(held) / (p_.sound_speed * dt);
  }
  return in;
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
  return std::sqrt(square);
}

// g·H, H the water's extent at the start: square of the speed of its waves [m²/s²].
template <int dim>
double LeastSquaresScheme<dim>::wave_speed_squared() const {
  return gravity_.cwiseAbs().dot((p_.water.max - p_.water.min).template head<dim>());
}

// γ = Δt/τ', τ' = max(τ, l0/U): disorder, and with it the error, grows while water passes a spacing; taken
// away faster it would stir a slow flow. Under a free surface the error is depth besides, which waves level:
// U = max|u|, there at least √(gH).
template <int dim>
double LeastSquaresScheme<dim>::drift_share(double dt) const {
  const double share = drift_factor(p_.scheme, dt);
  if (!(p_.scheme.tau > 0)) return share;
  const double speed = full_ ? speed_ : std::max(speed_, std::sqrt(wave_speed_squared()));
  return std::min(share, dt * speed / p_.spacing);
}

// (1 − Δt max|u|/l0) u²/(u² + gH), u = max|u| past the tank: all at once in water that hardly moves. Times
// the part that no compressibility holds, and half of that where no surface is near. Where neighbours are few
// and lie to one side divergence and gradient fit one another so badly that some flows about a jet's root
// would grow by 2 % at every step. Inside they fit better, and a residual that is left there lets the whole
// pressure lag behind the walls.
template <int dim>
double LeastSquaresScheme<dim>::kept_residual(double dt) const {
  if (!(speed_ > 0)) return 0;
  return std::max(0.0, 1 - dt * speed_ / p_.spacing) / (1 + wave_speed_squared() / (speed_ * speed_));
}

// min(1, Δt/τ), τ the step in which particles and walls made the moves that the velocity has not followed
// yet. A step that is shorter and did all of that at once would need a pressure larger by τ/Δt. Where steps
// are short because the water has become fast nothing is left: it would move particles by more than the CFL
// number.
template <int dim>
double LeastSquaresScheme<dim>::part_of_step(const State<dim>& state, double dt) const {
  const double time = std::min(state.residual_step, speed_ > 0 ? p_.scheme.cfl * p_.spacing / speed_ : 0.0);
  return dt < time ? dt / time : 1.0;
}

/// ∇·u of the new velocity at the same places, walls with it, less what the pressure equation asked for:
///   e = ∇·u − Σ_rows w (u−U)·P r/s + Δt/(ρs) (s p/(c²Δt²) + yields p − what stood on the right side)
/// Water from which tension was kept opens as it likes; what closes it remains known, or the next step would
/// meet all of it at once.
template <int dim>
void LeastSquaresScheme<dim>::measure_residual(const Boundary<dim>& boundary, State<dim>& state,
                                               const Neighbours& far, const Neighbours& near, double dt) {
  // Slowly against the dt/τ with which what is left itself follows, so that its rate hardly changes.
  constexpr double slowly = 0.2;
  if (undone_ > 0)
    state.residual_step -= slowly * (1 - undone_) * std::max(0.0, state.residual_step - dt);
  else
    state.residual_step = dt;
  fit_velocity(boundary, state, near);
  approach_from_mean(boundary, state, far);
  const double scale = laplacian_.n0 * laplacian_.lambda0 / (2.0 * dim);
  const double factor = dt / (p_.density * scale);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    state.residual_divergence[i] = 0;
    state.residual_approach.col(i).setZero();
    const Cut cut = cut_[static_cast<std::size_t>(i)];
    if (cut == Cut::limited || boundary.parked(state, i)) continue;
    const double left = divergence(i) - inflow(boundary, state, far, dt, i).flux / scale +
                        factor * (yielding_[i] * state.pressure[i] - meant_[i]);
    state.residual_divergence[i] = cut == Cut::released ? std::min(0.0, left) : left;
    if (cut != Cut::none) continue;
    state.residual_approach.col(i) = left_approach(boundary, state, near, i);
    if (undone_ > 0) state.residual_approach.col(i) -= undone_approach_.col(i).template cast<double>();
  }
}

template <int dim>
void LeastSquaresScheme<dim>::limit(const Boundary<dim>& boundary, State<dim>& state,
                                    const Neighbours& near) {
  const std::int64_t water = boundary.water();
  // Those that are cut read those that are not.
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (surface_share_[i] < 1 || !(state.pressure[i] > 0)) continue;
    double inside = 0;
    bool walled = false;
    for (const std::int32_t j : near.row(i)) {
      if (j >= water)
        walled = walled || walls_.wet(j);
      else if (surface_share_[j] < 1)
        inside = std::max(inside, state.pressure[j]);
    }
    if (!walled && inside < state.pressure[i]) {
      state.pressure[i] = inside;
      cut_[static_cast<std::size_t>(i)] = Cut::limited;
    }
  }
}

/// ∇p_i = A_i⁻¹ (Σ_water w (p_j − p_i) r/r² + Σ_rows w q P r/r² + (c/d) p_i n), q = `rise`: A_i from the same
/// places, so that it is exact for a linear p with that slope at the walls and p = 0 at the depth d above a
/// surface particle.
template <int dim>
template <bool seams>
void LeastSquaresScheme<dim>::find_pressure_gradient(const Boundary<dim>& boundary, const State<dim>& state,
                                                     const Neighbours& near, double dt) {
  const auto& periodic = boundary.tank().periodic();
  const std::int64_t water = boundary.water();
  if (undone_ > 0) undone_approach_.resize(dim, water);
  const double share = slope_share(dt), whole = p_.density / dt;
  const double *const place = state.position.data(), *const pressure = state.pressure.data();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    const Vector<dim> x = state.position.col(i);
    const double here = state.pressure[i];
    const double slope = whole * (1 - compressible(boundary, x) * (1 - share));
    const std::size_t inner = water_pairs(columns, water);
    const auto middle = column_at<dim>(place + dim * i);
    Column<dim> rises{};
    for (std::size_t e = 0; e < inner; ++e) {
      const std::int64_t j = columns[e];
      auto r = column_at<dim>(place + dim * j) - middle;
      if constexpr (seams) over_seams<dim>(periodic, r);
      const double w = (gradient_.radius * inverses[e] - 1) * inverses[e] * inverses[e];
      rises += r * (w * (pressure[j] - here));
    }
    Vector<dim> sum = surface_pull_[i] * here * inward_.col(i).template cast<double>();
    sum += Eigen::Map<const Vector<dim>>(reinterpret_cast<const double*>(&rises));
    Faces faces;
    for (std::size_t e = inner; e < columns.size(); ++e) {
      const std::int64_t j = columns[e];
      if (!walls_.wet(j) || !over(boundary, state, i, j)) continue;
      const double weight = gradient_.radius * inverses[e] - 1, w = weight * inverses[e] * inverses[e];
      const Vector<dim> held = walls_.held(j, periodic.separation(x, state.position.col(j)));
      faces.rises += w * rise(boundary, state, i, j, held, slope) * held;
      faces.held.noalias() += w * held * held.transpose();
      if (boundary.master_of(j) < 0 && !walls_.corner(j)) faces.weights += std::max(0.0, weight);
    }
    gradient_of_p_.col(i).noalias() = all_[static_cast<std::size_t>(i)] * (sum + faces.rises);
    if (undone_ > 0)
      undone_approach_.col(i) =
          (undone_ * soft_[i] * (left_approach(boundary, state, near, i) - pull_)).template cast<float>();
    if (inner < columns.size()) reaction_.col(i) = reaction(i, faces).template cast<float>();
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
  return gradient_of_p_;
}

/// δr = −(I + αS)⁻¹ α l0² ∇C, α = A |u| Δt/l0, ∇C = (d/n0) Σ w r/r² (fluid/THEORY.md (F49)), S how stiffly
/// l0² ∇C answers to the particle's place (3 on a square lattice, 10 across a string of crowded particles):
/// with α alone particles would be thrown past their places and back at every other step wherever S α > 1,
/// and the pressure with them. At most 0.1 l0; next to the free surface only along it, and through no face.
///
/// δu = (1−σ) ∇u·δr, σ the surface's share: of a jet or a drop the neighbours on one side do not tell ∇u, and
/// a velocity that grows with the shift it causes would run away.
template <int dim>
void LeastSquaresScheme<dim>::shift(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& near,
                                    double dt) const {
  if (p_.scheme.shifting <= 0) return;
  constexpr double longest = 0.1;  // [l0]
  constexpr double soft = 0.02;    // αS that changes nothing
  const bool moves = boundary.tank().moves();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    if (boundary.parked(state, i)) continue;
    const auto k = static_cast<std::size_t>(i);
    // Past the tank: the same for an observer who falls or drives along with it.
    Vector<dim> past = state.velocity.col(i);
    if (moves) past -= boundary.tank().velocity_at(state.position.col(i));
    const double alpha = std::min(1.0, p_.scheme.shifting * past.norm() * dt / p_.spacing);
    if (!(alpha > 0)) continue;
    const double reach = alpha * p_.spacing * p_.spacing * dim / gradient_.n0;
    Vector<dim> move = -reach * crowding_.col(i).template cast<double>();
    const double stiffness = stiffness_[i], share = surface_share_[i];
    if (alpha * stiffness > soft) {
      // S is as uneven as the neighbours are, Σ w r⊗r/r².
      Tensor<dim> answer = Tensor<dim>::Identity();
      if (water_[k].determinant() > least_determinant()) {
        answer = water_[k].inverse();
        answer *= dim / answer.trace();
      }
      answer = Tensor<dim>::Identity() + alpha * stiffness * answer;
      move = (answer.inverse() * move).eval();
    }
    const Vector<dim> inward = inward_.col(i).template cast<double>();
    move -= share * inward.dot(move) * inward;
    const double length = move.norm();
    if (length > longest * p_.spacing) move *= longest * p_.spacing / length;
    const auto columns = near.row(i);
    if (!columns.empty() && columns.back() >= boundary.water())
      move = before_faces<dim>(boundary, state.position.col(i), move);
    state.position.col(i) += move;
    state.velocity.col(i).noalias() += (1 - share) * velocity_gradient(i) * move;
  }
}

#define STRAKE_INSTANTIATE(dim)                                                                              \
  template void LeastSquaresScheme<dim>::measure_residual(const Boundary<dim>&, State<dim>&,                 \
                                                          const Neighbours&, const Neighbours&, double);     \
  template void LeastSquaresScheme<dim>::limit(const Boundary<dim>&, State<dim>&, const Neighbours&);        \
  template double LeastSquaresScheme<dim>::fastest(const Boundary<dim>&, const State<dim>&) const;           \
  template void LeastSquaresScheme<dim>::assemble(const Boundary<dim>&, const State<dim>&,                   \
                                                  const Neighbours&, const Vector<dim>&, double,             \
                                                  PressureSystem&);                                          \
  template const Vectors<dim>& LeastSquaresScheme<dim>::pressure_gradient(                                   \
      const Boundary<dim>&, const State<dim>&, const Neighbours&, double);                                   \
  template void LeastSquaresScheme<dim>::shift(const Boundary<dim>&, State<dim>&, const Neighbours&, double) \
      const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
