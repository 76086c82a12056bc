#include "fluid/least_squares/scheme.hpp"

#include "fluid/boundary/body_packing.hpp"
#include "fluid/diagnostics/voids.hpp"
#include "fluid/scheme/stage_clock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

// Each stage of a step calls the functions of the scheme in order.

namespace strake::fluid {

namespace {

/// Largest displacement of the bodies' points since the configuration was measured [m].
template <int dim>
double largest_displacement(const StepData<dim>& step) {
  const auto& from = step.state.interface_displacement;
  double square = 0;
  for (Eigen::Index k = 0; k < from.cols(); ++k)
    square =
        std::max(square, (step.motion->displacement.col(k).template head<dim>() - from.col(k)).squaredNorm());
  return std::sqrt(square);
}

/// Whether a body has a face with that property. With volume coupling bodies have no faces.
template <int dim>
bool has_face(const Boundary<dim>& boundary, const auto& is_one) {
  if (boundary.volume()) return false;
  for (int k = 0; k < boundary.body_surface().points(); ++k)
    if (is_one(k)) return true;
  return false;
}

/// Returns √(|g| l0) beside a body that stood in the water, whose faces come and go gradually (F91).
double fading_speed(const Parameters& p) {
  const double g = p.gravity.norm();
  return p.submerged && g > 0 ? std::sqrt(g * p.spacing) : std::numeric_limits<double>::infinity();
}

}  // namespace

template <int dim>
LeastSquaresScheme<dim>::LeastSquaresScheme(const Parameters& p, const Boundary<dim>& boundary,
                                            const State<dim>& state)
    : p_(p),
      gradient_(lattice_constants<dim>(p.scheme.radius_gradient, p.spacing)),
      laplacian_(lattice_constants<dim>(p.scheme.radius_laplacian, p.spacing)),
      lattice_(laplacian_, p.spacing),
      walls_(boundary, state, p.spacing, fading_speed(p)),
      sound_(p.sound_depth, p.spacing),
      oblique_(has_face(boundary, [&](int k) { return !boundary.is_between_sharp_corners(k); })) {
  wall_.curved = has_face(boundary, [&](int k) { return boundary.is_curved(k); });
  images_.factor = image_factor();
  const std::int64_t water = boundary.water();
  full_ = is_full(boundary, state, water);
  wall_.mean_velocity.setZero(dim, state.position.cols() - water);
  wall_.cover.setZero(state.position.cols() - water);
}

/// Whether that much water fills a closed tank without a body.
template <int dim>
bool LeastSquaresScheme<dim>::is_full(const Boundary<dim>& boundary, const State<dim>& state,
                                      std::int64_t water) const {
  return boundary.first_of_bodies() == static_cast<std::int64_t>(state.kind.size()) &&
         static_cast<double>(water) * std::pow(p_.spacing, dim) >
             (1 - least_squares_constants().gap) * boundary.tank().shape().volume();
}

/// Makes room for that many water particles.
template <int dim>
void LeastSquaresScheme<dim>::resize(std::int64_t water) {
  const auto count = static_cast<std::size_t>(water);
  moments_.b_inverse.resize(count);
  moments_.a_inverse.resize(count);
  velocity_.motion = velocity_.memory.template of<Motion>(count);
  std::fill(velocity_.motion.begin(), velocity_.motion.end(), Motion{});
  moments_.water_stop.resize(count);
  for (SingleVectors* v : {&moments_.m_projected, &surface_.normal, &moments_.concentration, &wall_.force})
    v->setZero(dim, water);
  for (Eigen::VectorXf* v :
       {&moments_.stiffness, &equation_.carried, &equation_.incompressible, &equation_.own, &moments_.volume,
        &surface_.kappa, &surface_.slope_weight, &surface_.share, &film_.share})
    v->setZero(water);
  for (Eigen::VectorXd* v : {&equation_.source, &moments_.diagonal}) v->setZero(water);
  for (Eigen::VectorXf* v : {&equation_.tension, &surface_.deep}) v->setOnes(water);
  pressure_gradient_.setZero(dim, water);
}

template <int dim>
void LeastSquaresScheme<dim>::set_water(const StepData<dim>& step) {
  ranks_ = step.ranks;
  walls_.set_water(step.boundary.water());
  resize(step.boundary.water());
}

template <int dim>
void LeastSquaresScheme<dim>::set_layers(const StepData<dim>& step) {
  ranks_ = step.ranks;
  walls_ = WallContact<dim>(step.boundary, step.state, p_.spacing, fading_speed(p_));
  const std::int64_t layers = step.state.position.cols() - step.boundary.water();
  wall_.mean_velocity.setZero(dim, layers);
  wall_.cover.setZero(layers);
  full_ = is_full(step.boundary, step.state, step.subdomain->water_of_whole());
  resize(step.boundary.water());
}

template <int dim>
bool LeastSquaresScheme<dim>::may_substep(const StepData<dim>& step, double dt) const {
  return p_.sound_speed * dt <= p_.spacing && !step.boundary.tank().moves();
}

template <int dim>
void LeastSquaresScheme<dim>::begin(StepData<dim>& step) {
  start_ = {};
  resize(step.boundary.water());
  if (!water_starts_packed(step.p, step.boundary)) return;
  step.search_neighbours();
  const std::vector<std::uint8_t> flags = step.state.surface;  // `measure` makes faces wet, and the surface
  now_.fading = 0;
  measure(step.boundary, step.state, *step.far, step.near_gradient(), 0);
  note_start(step.boundary, step.state, *step.far);
  step.state.surface = flags;
  step.search.invalidate();
}

template <int dim>
void LeastSquaresScheme<dim>::measure(StepData<dim>& step) {
  const StageClock clock(step.seconds, "density", step.ranks.communicator());
  air_ = &step.air;
  now_.fading = step.dt;
  measure(step.boundary, step.state, *step.far, step.near_gradient(), step.substepping.length());
  follow_air(step.state, step.near_gradient(), step.boundary.water(), step.newly_connected);
  share_surface(step.state);
}

/// Gives the ghosts, which have no rows, the marks of their owners: surface, and connected with the air.
template <int dim>
void LeastSquaresScheme<dim>::share_surface(State<dim>& state) const {
  const auto read = [&](std::int32_t i, std::byte* to) {
    to[0] = std::byte{state.surface[static_cast<std::size_t>(i)]};
    to[1] = std::byte{state.air_connected[static_cast<std::size_t>(i)]};
  };
  const auto write = [&](std::int32_t i, const std::byte* from) {
    state.surface[static_cast<std::size_t>(i)] = std::to_integer<std::uint8_t>(from[0]);
    state.air_connected[static_cast<std::size_t>(i)] = std::to_integer<std::uint8_t>(from[1]);
  };
  ranks_.update(2, read, write);
}

template <int dim>
void LeastSquaresScheme<dim>::predict(StepData<dim>& step) {
  const StageClock clock(step.seconds, "predictor", step.ranks.communicator());
  step.accelerate();
}

template <int dim>
void LeastSquaresScheme<dim>::assemble(StepData<dim>& step, PressureSystem& system) {
  if (!step.substepping.begins()) fade_lags(step.boundary, step.state);  // `measure` did so for the first
  filter(step.boundary, step.state, step.near_gradient(), step.dt, step.substepping);
  assemble(step.boundary, step.state, *step.far, step.near_gradient(),
           step.gravity - step.boundary.tank().acceleration(), step.dt, system);
}

template <int dim>
void LeastSquaresScheme<dim>::limit_pressure(StepData<dim>& step, bool tension) {
  if (!tension) limit_tension(step.boundary, step.state, *step.far);
  ranks_.update(step.state.pressure);
  limit_film(step.state, step.near_gradient());
  ranks_.update(step.state.pressure);
  if (p_.submerged) {
    limit_at_corners(step.boundary, step.state, step.near_gradient());
    ranks_.update(step.state.pressure);
  }
  limit_at_surface(step.boundary, step.state, step.near_gradient());
  ranks_.update(step.state.pressure);
}

template <int dim>
void LeastSquaresScheme<dim>::find_gradient(StepData<dim>& step) {
  end_projection(step.boundary, step.state, *step.far);
  pressure_gradient(step.boundary, step.state, step.near_gradient(), step.dt);
  ranks_.update(pressure_gradient_);
  ranks_.update(wall_.force);
}

template <int dim>
Load<dim> LeastSquaresScheme<dim>::load(StepData<dim>& step) {
  Load<dim> load{layer_forces(step.boundary, step.state, step.near_gradient()), {}};
  const auto rows = load.on_layers.cols() - step.boundary.water();
  load.on_layers.rightCols(rows) += step.mass * step.viscous->rightCols(rows);
  return load;
}

template <int dim>
double LeastSquaresScheme<dim>::correct(StepData<dim>& step) {
  State<dim>& state = step.state;
  const Boundary<dim>& boundary = step.boundary;
  const std::int64_t water = boundary.water();
  const double factor = step.dt / p_.density;
  double largest = 0, fastest = 0;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (boundary.is_removed(state, i)) continue;
    state.velocity.col(i) -= factor * pressure_gradient_.col(i);
  }
  stop_films(boundary, state, step.near_gradient());
  ranks_.update(state.velocity);
  measure_residual(boundary, state, *step.far, step.near_gradient(), step.dt);
  note_acceleration(boundary, state);
#pragma omp parallel for schedule(static) reduction(max : largest, fastest)
  for (std::int64_t i = 0; i < water; ++i) {
    if (boundary.is_removed(state, i)) continue;
    if (!step.ranks.owns(i)) continue;
    fastest = std::max(fastest, state.velocity.col(i).squaredNorm());
    if (!state.surface[static_cast<std::size_t>(i)]) largest = std::max(largest, std::abs(divergence(i)));
  }
  fastest = step.ranks.max(fastest);
  largest = step.ranks.max(largest);
  const double gap =
      oblique_ ? -step.ranks.max(-walls_.contact_gap()) : std::numeric_limits<double>::infinity();
  if (!step.substepping.ends(std::sqrt(fastest), largest_displacement(step), gap, p_.spacing)) return largest;
  const double time = step.substepping.age();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i)
    if (!boundary.is_removed(state, i)) state.position.col(i) += time * state.velocity.col(i);
  step.move_boundaries();
  return largest;
}

template <int dim>
void LeastSquaresScheme<dim>::shift(StepData<dim>& step) {
  shift(step.boundary, step.state, step.near_gradient(), step.substepping.age());
  ranks_.send_motion(step.state);
}

template class LeastSquaresScheme<2>;
template class LeastSquaresScheme<3>;

}  // namespace strake::fluid
