#include "structure/fem/solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "proto/error.hpp"
#include "structure/fem/held.hpp"
#include "structure/fem/make_solver.hpp"
#include "structure/fem/modal.hpp"
#include "structure/material.hpp"
#include "structure/surface.hpp"

namespace strake::structure::fem {
namespace {

// A tangent serves on while a step needs no more corrections than this: a correction costs about a thirtieth
// of a factorisation.
constexpr int iterations_of_a_good_tangent = 8;
// Factors made for a step are kept for another one this near to it, relative: window ends carry rounding, no
// more.
constexpr double same_step = 1e-6;
// An iteration that solves for a correction leaves this much of it to the next one: Newton's method takes the
// residual anew each time.
constexpr double enough_of_a_correction = 1e-6;
// Of the square of the first frequency, for the line that shows five figures of it.
constexpr double enough_for_a_line = 1e-8;
constexpr double exact = 1e-12;
// Round-off of the internal force, in units of ε · largest stiffness · |u|: the forces of a node nearly
// cancel. Measured on the clamped strip of VALIDATION B1, 4 to 16 cells through the thickness: residuals
// stall at 0.57.
constexpr double round_off = 2;

bool all_linear(const Solid& solid) {
  return std::all_of(solid.parts.begin(), solid.parts.end(),
                     [](const Part& part) { return part.material.model == MaterialModel::linear; });
}

/// A cell softens by a share of its stress, which the enhanced strains of a cell in equilibrium do not know.
StrainField strain_field(const Parameters& p) {
  if (p.fem.strain != StrainField::automatic) return p.fem.strain;
  return p.failure.criterion == FailureCriterion::none ? StrainField::automatic : StrainField::compatible;
}

double fastest_wave(const Solid& solid) {
  double fastest = 0;
  for (const Part& part : solid.parts) fastest = std::max(fastest, wave_speed(part.material));
  return fastest;
}

}  // namespace

template <int dim>
FemSolver<dim>::FemSolver(const Parameters& p)
    : parameters_(p),
      scheme_(p.fem.rho_infinity),
      solid_(elastic_solid(p)),
      linear_(all_linear(solid_)),
      discretisation_(solid_, p.fem.degree, p.fem.refinement),
      assembly_(discretisation_.mesh(), solid_.parts, strain_field(p)),
      recovery_(discretisation_.mesh()),
      method_(chosen(p.fem.linear_solver, dim, discretisation_.mesh().n_unknowns())),
      mass_(assembly_.mass()),
      frame_(SupportFrame(p), mass_, discretisation_.mesh()),
      interface_(surface(p)),
      transfer_(discretisation_, interface_.position),
      factors_(linear_solver()),
      fresh_factors_(linear_solver()) {
  if (p.analysis == Analysis::statics) require_held(mesh());
  const int n = mesh().n_unknowns();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(n);
  stiffness_ = assembly_.tangent(zero);
  node_mass_ = mass_ * Eigen::VectorXd::Ones(n);
  largest_stiffness_ = stiffness_.coeffs().abs().maxCoeff();

  load_shape_ = zero;
  if (p.load.kind == LoadKind::traction) {
    const Eigen::VectorXd area = discretisation_.face_sizes(facets_named(solid_, p.load.face));
    for (int i = 0; i < mesh().n_nodes(); ++i)
      load_shape_.segment<dim>(dim * i) = area(i) * p.load.value.template head<dim>();
  } else if (p.load.kind == LoadKind::point) {
    load_shape_ = Transfer<dim>(discretisation_, p.load.at).to_unknowns(p.load.value);
  }

  first_frequency_ = frequencies(1, enough_for_a_line).front();
  if (p.failure.criterion != FailureCriterion::none) failure_.emplace(p.failure, mesh(), assembly_);
  start();
}

// The body moves with its supports and by what the case adds, as far as they let it; in a node between parts
// by the mean of what the cells around say. Accelerations at t = 0, which rho_inf < 1 remembers, follow from
// the loads.
template <int dim>
void FemSolver<dim>::start() {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(mesh().n_unknowns());
  state_ = {};
  state_.displacement = state_.velocity = state_.acceleration = state_.tangent_at = zero;
  state_.frame = frame_.supports().start();
  Eigen::VectorXd met = zero;
  for (int c = 0; c < mesh().n_cells(); ++c)
    for (Eigen::Index a = 0; a < mesh().cell.rows(); ++a) {
      const int node = mesh().cell(a, c);
      Eigen::Vector3d X = Eigen::Vector3d::Zero();
      X.template head<dim>() = mesh().node.col(node);
      state_.velocity.template segment<dim>(dim * node) +=
          velocity_at_start(parameters_.initial, mesh().part[static_cast<std::size_t>(c)], X)
              .template head<dim>();
      met.template segment<dim>(dim * node).array() += 1;
    }
  state_.velocity = state_.velocity.cwiseQuotient(met);
  hold(state_.velocity);
  if (failure_) state_.damage = failure_->intact();
  if (!scheme_.mid_point) {
    const Eigen::VectorXd force = own_load(0);
    const auto A = frame_.acceleration(scheme_, state_.frame, state_.frame, force, zero,
                                       gravity_at(0).template head<dim>(), 1);
    LinearSolver mass_factors = linear_solver();
    mass_factors.factorise(mass_, mesh().fixed);
    Eigen::VectorXd r = force - frame_.inertia(A);
    hold(r);
    state_.acceleration = frame_.correction(mass_factors, 1)(mass_factors, r);
    const auto at_start =
        frame_.acceleration(scheme_, state_.frame, state_.frame, force, mass_ * state_.acceleration,
                            gravity_at(0).template head<dim>(), 1);
    state_.frame.acceleration.template head<dim>() = at_start;
  }
  saved_ = state_;
}

template <int dim>
void FemSolver<dim>::hold(Eigen::VectorXd& unknowns) const {
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
        node_mass_.segment<dim>(dim * i).array() * gravity.template head<dim>().array();
  return force;
}

template <int dim>
Eigen::VectorXd FemSolver<dim>::internal_force(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1,
                                               double alpha) const {
  if (linear_ && assembly_.intact()) return stiffness_ * (alpha * u0 + (1 - alpha) * u1);
  return assembly_.internal_force(u0, u1, alpha);
}

// A = (1−α_m)/(β dt²) M + (1−α_f) (K + γ/(β dt) C): how the forces of a step change with u1.
template <int dim>
Matrix FemSolver<dim>::effective(const Matrix& tangent, double dt) const {
  const Damping& damping = parameters_.damping;
  const double share = 1 - scheme_.alpha_f, rate = scheme_.gamma / (scheme_.beta * dt);
  Matrix matrix = tangent;
  auto value = matrix.coeffs();  // one pattern for all
  value = share * value + (scheme_.inertia() / (dt * dt) + share * rate * damping.mass) * mass_.coeffs() +
          share * rate * damping.stiffness * stiffness_.coeffs();
  return matrix;
}

template <int dim>
void FemSolver<dim>::use_tangent(const State& state) {
  if (factors_dt_ == state.tangent_dt && factors_at_.size() > 0 && factors_at_ == state.tangent_at) return;
  const Matrix tangent = linear_ && assembly_.intact() ? stiffness_ : assembly_.tangent(state.tangent_at);
  ++factorisations_;
  if (!factors_.factorise(effective(tangent, state.tangent_dt), mesh().fixed))
    throw Error(ExitCode::solver_fault, fmt::format("structure (fem), t = {:.6g} s", state.time),
                "the matrix of a step is singular", "lower coupling.surface.window");
  factors_at_ = state.tangent_at;
  factors_dt_ = state.tangent_dt;
}

template <int dim>
Eigen::VectorXd FemSolver<dim>::load_of_window(double t, double dt, const Load& load) const {
  const double time = t + (1 - scheme_.alpha_f) * dt;
  const Points on_points = load.mean(t, t + dt, interface_.position.cols());
  if (!on_points.allFinite())
    throw Error(ExitCode::solver_fault, fmt::format("structure (fem), t = {:.6g} s", time),
                "the load on the interface is not finite",
                "see the fluid's log; lower coupling.surface.window");
  return own_load(time) + transfer_.to_unknowns(on_points);
}

// C v_α for the step from `old` to u1.
template <int dim>
Eigen::VectorXd FemSolver<dim>::damping_force(const State& old, const Eigen::VectorXd& u1, double dt) const {
  const Damping& damping = parameters_.damping;
  if (damping.mass == 0 && damping.stiffness == 0) return Eigen::VectorXd::Zero(u1.size());
  const Eigen::VectorXd v1 = scheme_.velocity(old.displacement, u1, old.velocity, old.acceleration, dt);
  const Eigen::VectorXd v = scheme_.alpha_f * old.velocity + (1 - scheme_.alpha_f) * v1;
  return damping.mass * (mass_ * v) + damping.stiffness * (stiffness_ * v);
}

template <int dim>
Eigen::Matrix<double, dim, 1> FemSolver<dim>::frame_acceleration(const State& old, const FrameState& told,
                                                                 const Eigen::VectorXd& force,
                                                                 const Eigen::VectorXd& inertia,
                                                                 double dt) const {
  const Eigen::Vector3d gravity = gravity_at(old.time + (1 - scheme_.alpha_f) * dt);
  return frame_.acceleration(scheme_, old.frame, told, force, inertia, gravity.template head<dim>(), dt);
}

// r(u1) = F − f(u0, u1) − C v_α − M a_m − M 1 A, in the unknowns that are free.
template <int dim>
NewtonResult FemSolver<dim>::solve_step(const State& old, const FrameState& told,
                                        const Eigen::VectorXd& force, double dt,
                                        const Eigen::VectorXd& start) {
  const Eigen::VectorXd drift = old.displacement + dt * old.velocity;
  Equilibrium equilibrium;
  equilibrium.residual = [&](const Eigen::VectorXd& u1) {
    const Eigen::VectorXd inside = internal_force(old.displacement, u1, scheme_.alpha_f);
    Eigen::VectorXd inertia = mass_ * scheme_.mean_acceleration(u1 - drift, old.acceleration, dt);
    inertia += frame_.inertia(frame_acceleration(old, told, force, inertia, dt));
    Equilibrium::Residual r{.value = force - inside - damping_force(old, u1, dt) - inertia};
    hold(r.value);
    r.scale = std::max({force.norm(), inside.norm(), inertia.norm()});
    r.floor = round_off * std::numeric_limits<double>::epsilon() * largest_stiffness_ * u1.norm();
    return r;
  };
  LinearSolver* factors = &factors_;
  const double kappa = scheme_.inertia() / (dt * dt);
  auto correction = frame_.correction(*factors, kappa);
  equilibrium.correction = [&](const Eigen::VectorXd& r) {
    return correction(*factors, r, enough_of_a_correction);
  };
  equilibrium.refresh = [&](const Eigen::VectorXd& u1) {
    factors = &fresh_factors_;
    ++factorisations_;
    // Conjugate gradients need a symmetric matrix: that of a state, not of a step.
    const Matrix tangent = method_ == LinearMethod::direct
                               ? assembly_.tangent(old.displacement, u1, scheme_.alpha_f)
                               : assembly_.tangent(u1);
    if (!fresh_factors_.factorise(effective(tangent, dt), mesh().fixed)) return false;
    correction = frame_.correction(fresh_factors_, kappa);
    return true;
  };
  const NewtonResult result = solve(equilibrium, start, parameters_.fem.tolerance);
  newton_iterations_ = result.iterations;
  const bool sound = result.converged && assembly_.smallest_jacobian(result.x) > 0;
  if (!sound) {
    const std::string stopped =
        fmt::format("Newton's method did not converge\n{} iterations, residual {:.2e} N, wanted {:.2e} N",
                    result.iterations, result.residual, result.wanted);
    throw Error(
        ExitCode::solver_fault, fmt::format("structure (fem), t = {:.6g} s", old.time),
        result.converged ? "a cell is turned inside out" : stopped,
        fmt::format(
            "lower coupling.surface.window ({:g} s), or look at the load: is the plate too thin for it?",
            dt));
  }
  return result;
}

// Kinetic + strain − external stays as it is when nothing damps: the loads work on u1 − u0, and what changes
// the momentum p of body and free frame, loads and supports, on the frame's way, ½(V0 + V1)·Δp; damping takes
// its share.
template <int dim>
void FemSolver<dim>::account(const State& old, const Eigen::VectorXd& force, double dt, State& next) const {
  const Eigen::Vector3d gained = next.frame.velocity - old.frame.velocity;
  const auto momentum = frame_.gained(next.velocity - old.velocity, gained);
  const Eigen::Vector3d V = 0.5 * (old.frame.velocity + next.frame.velocity);
  next.external +=
      (force - damping_force(old, next.displacement, dt)).dot(next.displacement - old.displacement) +
      V.template head<dim>().dot(momentum);
  next.reaction.setZero();
  for (int axis = 0; axis < dim; ++axis) {
    double loads = 0;
    for (Eigen::Index i = axis; i < force.size(); i += dim) loads += force[i];
    next.reaction[axis] = (momentum[axis] - frame_.lumped_mass(axis) * gained[axis]) / dt - loads;
  }
}

template <int dim>
Eigen::Vector3d FemSolver<dim>::momentum() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  sum.head<dim>() = frame_.gained(state_.velocity, state_.frame.velocity);
  return sum;
}

template <int dim>
void FemSolver<dim>::advance(double t, double dt, const Load& load) {
  assert(dt > 0);
  step(t, dt, load, 0);
}

/// One step, or two of half its length where a cell would lose too much of its share in it.
template <int dim>
void FemSolver<dim>::step(double t, double dt, const Load& load, int halved) {
  // A notched bar takes 1.02 G_c in steps of 10 µs and 1.09 in steps of 40 µs; unhalved 1.08 and 1.57.
  constexpr double largest_fall = 0.1;
  constexpr int most_halvings = 6;
  const State& old = state_;
  State next = old;
  if (!(std::abs(dt - old.tangent_dt) <= same_step * dt)) next.tangent_dt = dt;
  use_tangent(next);

  const Eigen::VectorXd force = load_of_window(t, dt, load);
  next.frame = frame_.prescribed(old.frame, t + dt);
  const NewtonResult result =
      failure_ ? solve_softening(old, next.frame, force, dt, next.damage)
               : solve_step(old, next.frame, force, dt, old.displacement + dt * old.velocity);
  if (failure_ && halved < most_halvings &&
      (failure_->held(old.damage) - failure_->held(next.damage)).maxCoeff() > largest_fall) {
    assembly_.damage(failure_->held(old.damage));
    step(t, 0.5 * dt, load, halved + 1);
    step(t + 0.5 * dt, 0.5 * dt, load, halved + 1);
    return;
  }
  const Eigen::VectorXd leap = result.x - old.displacement - dt * old.velocity;
  next.displacement = result.x;
  next.velocity = scheme_.velocity(old.displacement, result.x, old.velocity, old.acceleration, dt);
  next.acceleration = scheme_.acceleration(leap, old.acceleration, dt);
  const Eigen::VectorXd inertia = mass_ * scheme_.mean_acceleration(leap, old.acceleration, dt);
  frame_.advance(scheme_, old.frame, frame_acceleration(old, next.frame, force, inertia, dt), dt, next.frame);
  account(old, force, dt, next);
  if (result.refreshed || result.iterations > iterations_of_a_good_tangent ||
      next.damage.released != old.damage.released)
    next.tangent_at = result.x;
  next.time = t + dt;
  ++next.steps;
  state_ = std::move(next);
}

// A step from shares h0 = 1 − D0 of the cells to h1 carries their mean s, so that what it dissipates is that
// of the trapezoidal rule, ½ Σ V (h0 − h1)(ψ0 + ψ1):
//   released += U_s(u1) − U_s(u0) − (U_h1(u1) − U_h0(u0))
// u1 and h1 follow one another until s stands still; what it lacks then is no energy, for s is what was
// carried.
template <int dim>
NewtonResult FemSolver<dim>::solve_softening(const State& old, const FrameState& told,
                                             const Eigen::VectorXd& force, double dt,
                                             typename Damage<dim>::State& damage) {
  constexpr int most_passes = 40;
  constexpr double still = 1e-3;  // of a share
  const Eigen::VectorXd before = failure_->held(old.damage);
  Eigen::VectorXd carried = before;
  NewtonResult result;
  Eigen::VectorXd start = old.displacement + dt * old.velocity;
  for (int pass = 0;; ++pass) {
    assembly_.damage(carried);
    result = solve_step(old, told, force, dt, start);
    damage = old.damage;
    if (!failure_->look(result.x, old.time + dt, damage)) break;
    const Eigen::VectorXd mean = 0.5 * (before + failure_->held(damage));
    const double change = (mean - carried).cwiseAbs().maxCoeff();
    if (change <= still || pass == most_passes) break;
    carried = mean;
    start = result.x;
  }
  const Eigen::VectorXd after = failure_->held(damage);
  if (after != before || carried != before) {
    const double work = assembly_.strain_energy(result.x) - assembly_.strain_energy(old.displacement);
    assembly_.damage(before);
    const double first = assembly_.strain_energy(old.displacement);
    assembly_.damage(after);
    damage.released += work - (assembly_.strain_energy(result.x) - first);
  }
  return result;
}

template <int dim>
void FemSolver<dim>::restore() {
  state_ = saved_;
  if (failure_) assembly_.damage(failure_->held(state_.damage));
}

template <int dim>
Points FemSolver<dim>::displacement() const {
  return transfer_.at_points(state_.displacement).colwise() + state_.frame.displacement;
}

template <int dim>
Points FemSolver<dim>::velocity() const {
  return transfer_.at_points(state_.velocity).colwise() + state_.frame.velocity;
}

template <int dim>
Energy FemSolver<dim>::energy() const {
  Eigen::VectorXd velocity = state_.velocity;
  for (int i = 0; i < mesh().n_nodes(); ++i)
    velocity.segment<dim>(dim * i) += state_.frame.velocity.template head<dim>();
  double lumped = 0;
  for (Eigen::Index axis = 0; axis < dim; ++axis)
    lumped += 0.5 * frame_.lumped_mass(axis) * state_.frame.velocity[axis] * state_.frame.velocity[axis];
  return {.kinetic = 0.5 * velocity.dot(mass_ * velocity) + lumped,
          .strain = assembly_.strain_energy(state_.displacement),
          .external = state_.external,
          .released = state_.damage.released};
}

template <int dim>
const Transfer<dim>& FemSolver<dim>::probe(const Eigen::Vector3d& X) const {
  const std::array<double, 3> key{X.x(), X.y(), X.z()};
  auto found = probes_.find(key);
  if (found == probes_.end()) found = probes_.emplace(key, Transfer<dim>(discretisation_, X)).first;
  return found->second;
}

template <int dim>
Eigen::Vector3d FemSolver<dim>::displacement_at(const Eigen::Vector3d& X) const {
  return probe(X).at_points(state_.displacement).col(0) + state_.frame.displacement;
}

template <int dim>
Eigen::Vector3d FemSolver<dim>::velocity_at(const Eigen::Vector3d& X) const {
  return probe(X).at_points(state_.velocity).col(0) + state_.frame.velocity;
}

template <int dim>
Stress FemSolver<dim>::stress_at(const Eigen::Vector3d& X) const {
  const std::array<double, 3> key{X.x(), X.y(), X.z()};
  auto found = stress_probes_.find(key);
  if (found == stress_probes_.end()) {
    const auto place = discretisation_.locate(X);
    found = stress_probes_.emplace(key, recovery_.shares(place.cell, place.weights)).first;
  }
  Stress stress = Stress::Zero();
  for (const auto& share : found->second)
    stress += assembly_.cell_state(state_.displacement, share.cell).template topRows<6>() * share.weight;
  return stress;
}

template <int dim>
void FemSolver<dim>::set_unknowns(Eigen::VectorXd displacement, Eigen::VectorXd velocity) {
  assert(displacement.size() == mesh().n_unknowns() && velocity.size() == mesh().n_unknowns());
  hold(displacement);
  hold(velocity);
  state_.displacement = std::move(displacement);
  state_.velocity = std::move(velocity);
  saved_ = state_;
}

template <int dim>
void FemSolver<dim>::solve_static() {
  require_held(mesh());
  constexpr double end_of_ramps = std::numeric_limits<double>::infinity();
  constexpr double smallest_part = 1.0 / 64;  // of the load
  const Eigen::VectorXd full = own_load(end_of_ramps);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(mesh().n_unknowns());
  LinearSolver factors = linear_solver();
  double done = 0, part = 1;
  while (done < 1) {
    const double share = std::min(1.0, done + part);
    const Eigen::VectorXd force = share * full;
    Equilibrium equilibrium;
    equilibrium.residual = [&](const Eigen::VectorXd& x) {
      const Eigen::VectorXd inside = internal_force(x, x, 0);
      Equilibrium::Residual r{.value = force - inside};
      hold(r.value);
      r.scale = force.norm();
      r.floor = round_off * std::numeric_limits<double>::epsilon() * largest_stiffness_ * x.norm();
      return r;
    };
    equilibrium.correction = [&](const Eigen::VectorXd& r) {
      return factors.solve(r, enough_of_a_correction);
    };
    equilibrium.refresh = [&](const Eigen::VectorXd& x) {
      return factors.factorise(assembly_.tangent(x), mesh().fixed);
    };
    const bool regular = equilibrium.refresh(u);
    const NewtonResult result = regular ? solve(equilibrium, u, parameters_.fem.tolerance) : NewtonResult{};
    if (regular && result.converged && assembly_.smallest_jacobian(result.x) > 0) {
      u = result.x;
      done = share;
      continue;
    }
    part /= 2;
    if (part < smallest_part)
      throw Error(ExitCode::solver_fault, "structure (fem), static",
                  fmt::format("no equilibrium found beyond {:.0f} % of the load", 100 * done),
                  "lower structure.load.value, or hold both ends: structure.plate.supports");
  }
  state_.displacement = u;
  state_.velocity.setZero();
  state_.acceleration.setZero();
  state_.time = 0;
  saved_ = state_;
}

template <int dim>
LinearSolver FemSolver<dim>::linear_solver() const {
  if (method_ == LinearMethod::direct) return LinearSolver(method_);
  return LinearSolver(method_, {.per_node = dim, .rigid_motions = rigid_motions(mesh())});
}

template <int dim>
std::vector<double> FemSolver<dim>::frequencies(int count) {
  return frequencies(count, exact);
}

template <int dim>
std::vector<double> FemSolver<dim>::frequencies(int count, double tolerance) const {
  // Motions that the supports leave free have no frequency.
  const int rigid = rigid_motions_left(mesh());
  const Eigen::Vector3d size = solid_.node.rowwise().maxCoeff() - solid_.node.rowwise().minCoeff();
  if (method_ != LinearMethod::direct) tolerance = std::max(tolerance, enough_for_a_line);
  std::vector<double> f =
      natural_frequencies(stiffness_, mass_, mesh().fixed, count + rigid,
                          size.maxCoeff() / fastest_wave(solid_), linear_solver(), tolerance);
  f.erase(f.begin(), f.begin() + std::min<std::ptrdiff_t>(rigid, static_cast<std::ptrdiff_t>(f.size())));
  return f;
}

std::unique_ptr<Solver> make_solver(const Parameters& parameters) {
  if (parameters.dimension == 3) return std::make_unique<FemSolver<3>>(parameters);
  return std::make_unique<FemSolver<2>>(parameters);
}

template class FemSolver<2>;
template class FemSolver<3>;

}  // namespace strake::structure::fem
