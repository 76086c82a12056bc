#include "structure/fem/solver.hpp"

#include "proto/error.hpp"
#include "structure/body/surface.hpp"
#include "structure/fem/fem.hpp"
#include "structure/fem/mesh/refinement.hpp"
#include "structure/material/material.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace strake::structure::fem {
namespace {

/// Chooses the strain field. A softening cell scales its stress by a share that the equations of the enhanced
/// strains do not contain.
StrainField strain_field(const Parameters& p) {
  if (p.fem.strain != StrainField::automatic) return p.fem.strain;
  return p.failure.criterion == FailureCriterion::none ? StrainField::automatic : StrainField::compatible;
}

/// Below this number of unknowns for each rank, messages take as long as the work.
void require_work_for(int ranks, Eigen::Index unknowns) {
  constexpr double fewest = 5000;
  if (ranks == 1 || static_cast<double>(unknowns) >= fewest * ranks) return;
  const int most = std::max(1, static_cast<int>(static_cast<double>(unknowns) / fewest));
  throw Error(ExitCode::case_file, "structure.ranks",
              fmt::format("expected at least {:g} unknowns for each rank, these are {:.0f}", fewest,
                          static_cast<double>(unknowns) / ranks),
              fmt::format("structure.ranks = {}", most));
}

}  // namespace

template <int dim>
FemSolver<dim>::FemSolver(const Parameters& p, Communicator* ranks)
    : parameters_(p),
      scheme_(p.fem.rho_infinity),
      solid_(elastic_solid(p)),
      linear_(all_linear(solid_.parts)),
      discretisation_(solid_, p.fem.degree, p.fem.refinement, size_along(p.fem, solid_), ranks),
      assembly_(discretisation_.mesh(), solid_.parts, strain_field(p)),
      recovery_(discretisation_.mesh()),
      matrices_{.mass = assembly_.mass()},
      support_motion_(SupportFrame(p), matrices_.mass, discretisation_.mesh()),
      interface_(surface(p)),
      interpolation_(discretisation_, interface_.position) {
  const LinearMethod asked = p.fem.linear_solver;
  factors_.method = division().alone()              ? chosen(asked, dim, mesh().n_unknowns())
                    : asked == LinearMethod::direct ? asked
                                                    : LinearMethod::cg_amg;
  require_work_for(p.ranks, division().size(mesh().n_unknowns()));
  require_free(mesh());
  if (p.analysis == Analysis::statics) require_constrained(mesh());
  const int n = mesh().n_unknowns();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(n);
  matrices_.stiffness = assembly_.tangent(zero);
  matrices_.node_mass = matrices_.mass * Eigen::VectorXd::Ones(n);
  matrices_.largest_node_mass = division().max(matrices_.node_mass.head(division().own(n)).maxCoeff());
  const Matrix& K = matrices_.stiffness;
  const Eigen::Index own_entries = K.outerIndexPtr()[division().own(n)];
  matrices_.largest_stiffness = division().max(K.coeffs().head(own_entries).abs().maxCoeff());

  summary_.most_unknowns = static_cast<int>(division().max(static_cast<double>(division().own(n))));
  summary_.fewest_unknowns = static_cast<int>(division().min(static_cast<double>(division().own(n))));

  load_shape_ = discretisation_.case_force(p.load);
  // A body for several ranks takes some tens of solutions for that line.
  if (division().alone())
    for (const double f1 : frequencies(1, enough_for_a_line)) summary_.first_frequency = f1;
  // The stiffness alone is harder to solve for than a step's matrix, to which inertia adds.
  if (factors_.given_up->times > 0) factors_.method = LinearMethod::direct;
  factors_.kept = linear_solver();
  factors_.fresh = linear_solver();
  if (p.failure.criterion != FailureCriterion::none) failure_.emplace(p.failure, mesh(), assembly_);
  start();
}

// Sets the state at t = 0. The body moves with its supports, plus the case's initial velocity where supports
// allow it; a node between parts gets the mean of its cells' values. Accelerations at t = 0, which rho_inf <
// 1 needs, follow from the loads and the drag of that velocity:
//   M a0 = F − C v0 − M 1 A
template <int dim>
void FemSolver<dim>::start() {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(mesh().n_unknowns());
  state_ = {};
  state_.displacement = state_.velocity = state_.acceleration = state_.tangent_at = zero;
  state_.frame = support_motion_.supports().start();
  Eigen::VectorXd met = zero;
  for (int c = 0; c < mesh().n_cells(); ++c)
    for (Eigen::Index a = 0; a < mesh().cell.rows(); ++a) {
      const int node = mesh().cell(a, c);
      state_.velocity.template segment<dim>(dim * node) +=
          velocity_at_start(parameters_.initial, mesh().part[static_cast<std::size_t>(c)], mesh().place(node))
              .template head<dim>();
      met.template segment<dim>(dim * node).array() += 1;
    }
  state_.velocity = state_.velocity.cwiseQuotient(met);
  division().update(state_.velocity);
  clear_constrained(state_.velocity);
  for (int i = 0; support_motion_.supports().turns() && i < mesh().n_nodes(); ++i)
    state_.velocity.template segment<dim>(dim * i) +=
        support_motion_.supports().turning(state_.frame, mesh().place(i)).template head<dim>();
  if (failure_) state_.damage = failure_->intact();
  if (!scheme_.mid_point) {
    const Damping& damping = parameters_.damping;
    const Eigen::VectorXd force = own_load(0),
                          drag = damping.mass * (matrices_.mass * state_.velocity) +
                                 damping.stiffness * (matrices_.stiffness * state_.velocity);
    const auto frame_acceleration = [&](const Eigen::VectorXd& inertia) {
      return support_motion_.acceleration(scheme_, state_.frame, state_.frame, force, inertia,
                                          gravity_at(0).template head<dim>(), 1);
    };
    LinearSolver mass_factors = linear_solver();
    mass_factors.factorise(matrices_.mass, mesh().fixed);
    Eigen::VectorXd r = force - drag - support_motion_.inertia(frame_acceleration(zero));
    clear_constrained(r);
    state_.acceleration = support_motion_.correction(mass_factors, 1)(mass_factors.solve(r));
    state_.frame.acceleration.template head<dim>() = frame_acceleration(matrices_.mass * state_.acceleration);
  }
  saved_ = state_;
}

template <int dim>
void FemSolver<dim>::clear_constrained(Eigen::VectorXd& unknowns) const {
  for (const int i : mesh().fixed) unknowns(i) = 0;
}

template <int dim>
Eigen::Vector3d FemSolver<dim>::gravity_at(double time) const {
  return ramp_factor(time, parameters_.gravity_ramp) * parameters_.gravity;
}

template <int dim>
Eigen::VectorXd FemSolver<dim>::own_load(double time) const {
  Eigen::VectorXd force = ramp_factor(time, parameters_.load.ramp) * load_shape_;
  const Eigen::Vector3d gravity = gravity_at(time);
  for (int i = 0; i < mesh().n_nodes(); ++i)
    force.segment<dim>(dim * i).array() +=
        matrices_.node_mass.template segment<dim>(dim * i).array() * gravity.template head<dim>().array();
  return force;
}

template <int dim>
Eigen::VectorXd FemSolver<dim>::internal_force(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1,
                                               double alpha) const {
  if (linear_ && assembly_.intact()) return matrices_.stiffness * (alpha * u0 + (1 - alpha) * u1);
  return assembly_.internal_force(u0, u1, alpha);
}

// Estimates the round-off of the residual. The forces on a node nearly cancel, also κ M (u1 − u0 − dt v0)
// with κ = (1−α_m)/(β dt²), the dominant term in short steps. Measured on the clamped strip of
// cases/VALIDATION.md, 4 to 16 cells through the thickness: residuals stall at 0.57 ε · largest stiffness ·
// |u|.
template <int dim>
double FemSolver<dim>::round_off(const Eigen::VectorXd& u, double kappa) const {
  constexpr double units = 2;
  return units * std::numeric_limits<double>::epsilon() *
         (matrices_.largest_stiffness + kappa * matrices_.largest_node_mass) * division().norm(u);
}

template <int dim>
LinearSolver FemSolver<dim>::linear_solver() const {
  NodalUnknowns unknowns{.per_node = dim, .rigid_motions = {}, .division = division()};
  if (factors_.method != LinearMethod::direct) unknowns.rigid_motions = rigid_motions(mesh());
  return LinearSolver(factors_.method, unknowns, factors_.given_up);
}

template <int dim>
Eigen::Vector3d FemSolver<dim>::momentum() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  sum.head<dim>() = support_motion_.gained(state_.velocity, state_.frame.velocity);
  return sum;
}

template <int dim>
void FemSolver<dim>::restore() {
  state_ = saved_;
  if (failure_) assembly_.damage(failure_->integrity(state_.damage));
}

template <int dim>
Points FemSolver<dim>::displacement() const {
  return interpolation_.at_points(state_.displacement).colwise() + state_.frame.displacement;
}

template <int dim>
Points FemSolver<dim>::velocity() const {
  return interpolation_.at_points(state_.velocity).colwise() + state_.frame.velocity;
}

template <int dim>
std::optional<Eigen::Vector3d> FemSolver<dim>::support_displacement(const Eigen::Vector3d& X) const {
  return state_.frame.displacement + support_motion_.supports().turned(state_.frame, X);
}

template <int dim>
Energy FemSolver<dim>::energy() const {
  Eigen::VectorXd velocity = state_.velocity;
  for (int i = 0; i < mesh().n_nodes(); ++i)
    velocity.segment<dim>(dim * i) += state_.frame.velocity.template head<dim>();
  double lumped = 0;
  for (Eigen::Index axis = 0; axis < dim; ++axis)
    lumped +=
        0.5 * support_motion_.lumped_mass(axis) * state_.frame.velocity[axis] * state_.frame.velocity[axis];
  return {.kinetic = 0.5 * division().dot(velocity, matrices_.mass * velocity) + lumped,
          .strain = assembly_.strain_energy(state_.displacement),
          .external = state_.external,
          .released = state_.damage.released};
}

template <int dim>
const typename FemSolver<dim>::Probe& FemSolver<dim>::probe(const Eigen::Vector3d& X) const {
  const std::array<double, 3> key{X.x(), X.y(), X.z()};
  auto found = probes_.find(key);
  if (found == probes_.end()) {
    const auto place = discretisation_.locate(X).front();
    const auto shares = recovery_.shares(place.cell, place.weights);
    found = probes_.emplace(key, Probe{PointInterpolation<dim>(discretisation_, X), shares}).first;
  }
  return found->second;
}

template <int dim>
Eigen::Vector3d FemSolver<dim>::displacement_at(const Eigen::Vector3d& X) const {
  return probe(X).at.at_points(state_.displacement).col(0) + state_.frame.displacement;
}

template <int dim>
Eigen::Vector3d FemSolver<dim>::velocity_at(const Eigen::Vector3d& X) const {
  return probe(X).at.at_points(state_.velocity).col(0) + state_.frame.velocity;
}

template <int dim>
Stress FemSolver<dim>::stress_at(const Eigen::Vector3d& X) const {
  Stress stress = Stress::Zero();
  for (const auto& share : probe(X).stress)
    stress += assembly_.cell_state(state_.displacement, share.cell).template topRows<6>() * share.weight;
  return division().sum(stress);
}

template <int dim>
void FemSolver<dim>::set_unknowns(Eigen::VectorXd displacement, Eigen::VectorXd velocity) {
  assert(displacement.size() == mesh().n_unknowns() && velocity.size() == mesh().n_unknowns());
  clear_constrained(displacement);
  clear_constrained(velocity);
  state_.displacement = std::move(displacement);
  state_.velocity = std::move(velocity);
  saved_ = state_;
}

std::unique_ptr<Solver> make_solver(const Parameters& parameters, Communicator* ranks) {
  use_threads(parameters.threads);
  if (parameters.dimension == 3) return std::make_unique<FemSolver<3>>(parameters, ranks);
  return std::make_unique<FemSolver<2>>(parameters, ranks);
}

template class FemSolver<2>;
template class FemSolver<3>;

}  // namespace strake::structure::fem
