#include "fluid/least_squares/scheme.hpp"

#include "fluid/boundary/body_packing.hpp"
#include "fluid/diagnostics/voids.hpp"
#include "fluid/scheme/stage_clock.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

template <int dim>
bool LeastSquaresScheme<dim>::may_substep(const StepData<dim>& step, double dt) const {
  return p_.sound_speed * dt <= p_.spacing && !step.boundary.tank().moves();
}

template <int dim>
void LeastSquaresScheme<dim>::begin(StepData<dim>& step) {
  start_ = {};
  if (!water_starts_packed(step.p, step.boundary)) return;
  step.search_neighbours();
  const std::vector<std::uint8_t> flags = step.state.surface;  // `measure` makes faces wet, and the surface
  measure(step.boundary, step.state, *step.far, step.near_gradient(), 0);
  note_start(step.boundary, step.state, *step.far);
  step.state.surface = flags;
  step.search.invalidate();
}

template <int dim>
void LeastSquaresScheme<dim>::measure(StepData<dim>& step) {
  const StageClock clock(step.seconds, "density");
  air_ = &step.air;
  measure(step.boundary, step.state, *step.far, step.near_gradient(), step.substepping.length());
  follow_air(step.state, step.near_gradient(), step.boundary.water(), step.newly_connected);
}

template <int dim>
void LeastSquaresScheme<dim>::predict(StepData<dim>& step) {
  const StageClock clock(step.seconds, "predictor");
  step.accelerate();
}

template <int dim>
void LeastSquaresScheme<dim>::assemble(StepData<dim>& step, PressureSystem& system) {
  filter(step.boundary, step.state, step.near_gradient(), step.dt, step.substepping);
  assemble(step.boundary, step.state, *step.far, step.near_gradient(),
           step.gravity - step.boundary.tank().acceleration(), step.dt, system);
}

template <int dim>
void LeastSquaresScheme<dim>::limit_pressure(StepData<dim>& step, bool tension) {
  if (!tension) limit_tension(step.boundary, step.state, *step.far);
  limit_film(step.state, step.near_gradient());
  limit_at_surface(step.boundary, step.state, step.near_gradient());
}

template <int dim>
void LeastSquaresScheme<dim>::find_gradient(StepData<dim>& step) {
  end_projection(step.boundary, step.state, *step.far);
  pressure_gradient(step.boundary, step.state, step.near_gradient(), step.dt);
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
  measure_residual(boundary, state, *step.far, step.near_gradient(), step.dt);
  note_acceleration(boundary, state);
#pragma omp parallel for schedule(static) reduction(max : largest, fastest)
  for (std::int64_t i = 0; i < water; ++i) {
    if (boundary.is_removed(state, i)) continue;
    fastest = std::max(fastest, state.velocity.col(i).squaredNorm());
    if (!state.surface[static_cast<std::size_t>(i)]) largest = std::max(largest, std::abs(divergence(i)));
  }
  if (!step.substepping.ends(std::sqrt(fastest), largest_displacement(step), p_.spacing)) return largest;
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
}

template class LeastSquaresScheme<2>;
template class LeastSquaresScheme<3>;

}  // namespace strake::fluid
