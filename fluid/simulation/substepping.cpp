#include "fluid/simulation/step.hpp"

#include <algorithm>
#include <cmath>

// Where steps share their places: how long they do, and the corrector, whose last step moves the particles.

namespace strake::fluid {

/// Steps that follow sound from particle to particle share their places; longer ones follow the water itself.
/// The walls of a tank that moves take their velocity from the places they come from.
template <int dim>
void Simulation<dim>::Work::hold_places(double step, double rest, double stable) {
  const bool may = fitted && p.sound_speed * step <= p.spacing && !boundary.tank().moves();
  hold.step(step, rest, may ? stable : 0, state.step);
}

/// Longest way of the body's points since the places were found [m].
template <int dim>
double Simulation<dim>::Work::farthest_of_bodies() const {
  const auto& from = state.interface_displacement;
  double square = 0;
  for (Eigen::Index k = 0; k < from.cols(); ++k)
    square = std::max(square, (motion->displacement.col(k).template head<dim>() - from.col(k)).squaredNorm());
  return std::sqrt(square);
}

template <int dim>
void Simulation<dim>::Work::correct_fitted() {
  {
    const StageClock clock(seconds, "corrector");
    fitted->pressure_gradient(boundary, state, near_gradient(), dt);
  }
  load_interface();
  const StageClock clock(seconds, "corrector");
  const std::int64_t water = boundary.water();
  const double factor = dt / p.density;
  double largest = 0, fastest = 0;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (boundary.parked(state, i)) continue;
    state.velocity.col(i) -= factor * fitted->pressure_gradient().col(i);
  }
  fitted->measure_residual(boundary, state, *far, near_gradient(), dt);
#pragma omp parallel for schedule(static) reduction(max : largest, fastest)
  for (std::int64_t i = 0; i < water; ++i) {
    if (boundary.parked(state, i)) continue;
    fastest = std::max(fastest, state.velocity.col(i).squaredNorm());
    if (!state.surface[static_cast<std::size_t>(i)])
      largest = std::max(largest, std::abs(fitted->divergence(i)));
  }
  report.divergence_max = largest;
  if (!hold.ends(std::sqrt(fastest), farthest_of_bodies(), p.spacing)) return;
  const double time = hold.age();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i)
    if (!boundary.parked(state, i)) state.position.col(i) += time * state.velocity.col(i);
  boundary.move(state, motion->displacement, motion->velocity, true);
  boundary.move_tank(state, state.time + dt, true);
}

#define STRAKE_INSTANTIATE(dim)                                             \
  template void Simulation<dim>::Work::hold_places(double, double, double); \
  template void Simulation<dim>::Work::correct_fitted();
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
