#include "fluid/mps/scheme.hpp"

#include "fluid/diagnostics/voids.hpp"
#include "fluid/mps/correction.hpp"
#include "fluid/mps/interface_load.hpp"
#include "fluid/mps/lattice_filter.hpp"
#include "fluid/mps/number_density.hpp"
#include "fluid/scheme/stage_clock.hpp"

#include <algorithm>
#include <cmath>

namespace strake::fluid {

template <int dim>
MpsScheme<dim>::MpsScheme(const StepData<dim>& step)
    : at_star_(step.p.scheme.density_at == DensityAt::star),
      pairwise_(step.p.scheme.gradient == Gradient::pairwise),
      moves_(step.state.kind.size(), 0) {
  std::fill_n(moves_.begin(), step.boundary.water(), std::uint8_t{1});
}

template <int dim>
void MpsScheme<dim>::measure(StepData<dim>& step) {
  if (!at_star_) measure_number_density(step);
}

template <int dim>
void MpsScheme<dim>::predict(StepData<dim>& step) {
  {
    const StageClock clock(step.seconds, "predictor");
    if (pairwise_) filter_velocity(step);
    step.accelerate();
    if (!at_star_) return;
    const std::int64_t water = step.boundary.water();
    step.state.position.leftCols(water) += step.dt * step.state.velocity.leftCols(water);
    step.move_boundaries();
  }
  {
    const StageClock clock(step.seconds, "density");
    step.check_finite();
    step.search_neighbours();
  }
  measure_number_density(step);
}

template <int dim>
void MpsScheme<dim>::filter_velocity(StepData<dim>& step) const {
  const Scheme& scheme = step.p.scheme;
  State<dim>& state = step.state;
  const Vectors<dim> change = filter_lattice<dim>(
      {state.position, state.velocity, state.pressure, step.near_gradient(), step.gradient_lattice,
       step.boundary.water(), scheme.filter, step.p.density, step.p.spacing, step.dt});
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < change.cols(); ++i)
    if (!step.boundary.is_removed(state, i)) state.velocity.col(i) += change.col(i);
}

template <int dim>
void MpsScheme<dim>::measure_number_density(StepData<dim>& step) {
  const StageClock clock(step.seconds, "density");
  State<dim>& state = step.state;
  const Neighbours& near = step.near_density();
  n_ = number_density(near, step.density_lattice.radius);
  step.boundary.count_water(state, near, step.density_lattice, n_);
  const SurfaceTest test{step.p.scheme.beta, step.p.scheme.second, step.p.spacing, step.density_lattice};
  std::vector<std::uint8_t> flags =
      surface_flags<dim>(state.position, state.kind, near, n_, test, state.surface);
  step.boundary.keep_contact_open(state, near, state.surface, flags);
  state.surface.swap(flags);
  follow_air(state, near, step.boundary.water(), step.newly_connected);
  classify_rows(step);
}

/// Whether a surrounded structure particle lies at a crack: its weight of structure neighbours is below 0.85
/// n0. Strain of 1 % removes at most 3 % of it, and a second layer at a crack lacks 2 %. The face of a crack
/// lacks 15 % from an opening of 0.35 l0 on, and 35 to 40 % in the end.
template <int dim>
bool MpsScheme<dim>::exposed_by_crack(const StepData<dim>& step, std::int64_t i,
                                      const Neighbours& near) const {
  constexpr double left = 0.85;
  const LatticeConstants& lattice = step.density_lattice;
  const auto columns = near.row(i);
  const auto distances = near.distances(i);
  double fellows = 0;
  for (std::size_t e = 0; e < columns.size(); ++e)
    if (columns[e] >= step.boundary.first_of_bodies() && distances[e] < lattice.radius)
      fellows += weight(distances[e], lattice.radius);
  return fellows < left * lattice.n0;
}

/// Marks the unknowns: particles with a pressure that are not surface. δ = (n − n0)/n0; a negative δ beside
/// the surface comes from missing neighbours and counts as zero (fluid/THEORY.md, section 5).
template <int dim>
void MpsScheme<dim>::classify_rows(StepData<dim>& step) {
  const Neighbours& near = step.near_density();
  const State<dim>& state = step.state;
  const Boundary<dim>& boundary = step.boundary;
  const auto count = static_cast<std::int64_t>(state.kind.size());
  row_.assign(state.kind.size(), Row::none);
  solved_.assign(state.kind.size(), 0);
  deviation_.setZero(count);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!has_pressure(state.kind[k]) || boundary.is_removed(state, i)) continue;
    if (boundary.buried(i) && !exposed_by_crack(step, i, near)) continue;
    row_[k] = state.surface[k] ? Row::zero : Row::unknown;
    if (state.surface[k]) continue;
    solved_[k] = 1;
    // A structure particle keeps its own density whatever the water does.
    if (state.kind[k] == Kind::solid) continue;
    double delta = n_[i] / step.density_lattice.n0 - 1;
    if (delta < 0)
      for (const std::int32_t j : near.row(i))
        if (state.surface[static_cast<std::size_t>(j)]) {
          delta = 0;
          break;
        }
    deviation_[i] = delta;
  }
}

template <int dim>
Eigen::VectorXd MpsScheme<dim>::divergence(StepData<dim>& step) const {
  return fluid::divergence<dim>(step.state.position, step.state.velocity,
                                step.search.within(step.divergence_lattice.radius), step.divergence_lattice,
                                Masks{solved_, {}});
}

template <int dim>
void MpsScheme<dim>::assemble(StepData<dim>& step, PressureSystem& system) {
  const Eigen::VectorXd before = divergence(step);
  const PressureTerms terms{row_,
                            before,
                            deviation_,
                            step.state.pressure,
                            step.boundary.solid_density(),
                            step.p.density,
                            step.p.sound_speed,
                            step.dt};
  assemble_pressure<dim>(*step.far, terms, step.p.scheme, step.laplacian_lattice, system);
}

template <int dim>
void MpsScheme<dim>::limit_pressure(StepData<dim>& step, bool tension) {
  if (!tension) step.state.pressure = step.state.pressure.cwiseMax(0.0);
  step.boundary.fill_dummies(step.state, step.gravity, step.motion->acceleration);
}

template <int dim>
void MpsScheme<dim>::find_gradient(StepData<dim>& step) {
  if (pairwise_)
    level_ = face_level<dim>(step.state, step.boundary, step.near_gradient(), step.gradient_lattice,
                             step.p.spacing);
  gradient_ = pressure_gradient<dim>(step.state, step.boundary, step.near_gradient(), step.gradient_lattice,
                                     step.p.scheme.gradient, Masks{moves_, {}}, level_);
}

template <int dim>
Load<dim> MpsScheme<dim>::load(StepData<dim>& step) {
  const State<dim>& state = step.state;
  const LoadTerms<dim> terms{*step.viscous,
                             step.gravity,
                             step.motion->acceleration,
                             step.p.scheme.gradient,
                             step.gradient_lattice,
                             step.p.density,
                             step.p.spacing,
                             &level_};
  Load<dim> load{layer_forces<dim>(state, step.boundary, step.near_gradient(), terms), {}};
  if (step.boundary.volume()) {
    if (pairwise_) {
      load.on_solids =
          carried_pressure<dim>(state, step.boundary, step.near_gradient(), step.gradient_lattice);
    } else {
      const auto solids = state.pressure.tail(state.pressure.size() - step.boundary.first_of_bodies());
      load.on_solids.setOnes(2, solids.size());
      load.on_solids.row(0) = solids.transpose();
    }
  }
  return load;
}

/// Moves the water by r = r* + Δt (u − u*) or rⁿ + Δt u (F32). The first is for a scheme at r*, the second
/// for one at rⁿ. Both are rⁿ + Δt u, which adds no energy to the lattice's own oscillation; the mean of uⁿ
/// and u would.
template <int dim>
double MpsScheme<dim>::correct(StepData<dim>& step) {
  State<dim>& state = step.state;
  const std::int64_t water = step.boundary.water();
  const double dt = step.dt;
  Vectors<dim> change = -dt / step.p.density * gradient_.leftCols(water);
  for (std::int64_t i = 0; i < water; ++i)
    if (step.boundary.is_removed(state, i)) change.col(i).setZero();
  state.velocity.leftCols(water) += change;
  const double largest = divergence(step).head(water).cwiseAbs().maxCoeff();
  if (at_star_) {
    state.position.leftCols(water) += dt * change;
  } else {
    state.position.leftCols(water) += dt * state.velocity.leftCols(water);
    step.move_boundaries();
  }
  step.substepping.ends(0, 0, 0, step.p.spacing);
  return largest;
}

template <int dim>
void MpsScheme<dim>::shift(StepData<dim>& step) {
  shift_particles<dim>(step.state, step.boundary, step.near_gradient(), step.gradient_lattice,
                       step.p.scheme.shifting, std::sqrt(step.p.gravity.norm() * step.p.spacing), step.dt,
                       step.p.spacing);
}

template class MpsScheme<2>;
template class MpsScheme<3>;

}  // namespace strake::fluid
