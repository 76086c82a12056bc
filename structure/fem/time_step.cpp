// How the finite elements step through time: one window is one step.

#include "proto/error.hpp"
#include "structure/fem/solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace strake::structure::fem {
namespace {

// A tangent is kept while a step needs at most this many corrections. A correction costs about a thirtieth of
// a factorisation.
constexpr int iterations_of_a_good_tangent = 8;
// Factors are kept for a step whose size differs by less than this, relative. Window ends differ by rounding
// only.
constexpr double same_step = 1e-6;

StepFailed failed(double time, const std::string& problem) {
  return {ExitCode::solver_fault, fmt::format("structure (fem), t = {:.6g} s", time), problem,
          "look at the load: is the body too thin for it? Where no shorter window was tried, lower "
          "coupling.surface.window"};
}

}  // namespace

// A = (1−α_m)/(β dt²) M + (1−α_f) (K + γ/(β dt) C): how the forces of a step change with u1.
template <int dim>
Matrix FemSolver<dim>::effective(Matrix tangent, double dt) const {
  const Damping& damping = parameters_.damping;
  const double share = 1 - scheme_.alpha_f, rate = scheme_.gamma / (scheme_.beta * dt);
  auto value = tangent.coeffs();  // one pattern for all
  value = share * value +
          (scheme_.inertia() / (dt * dt) + share * rate * damping.mass) * matrices_.mass.coeffs() +
          share * rate * damping.stiffness * matrices_.stiffness.coeffs();
  return tangent;
}

template <int dim>
void FemSolver<dim>::use_tangent(const State& state) {
  factors_.kept.retry();
  const bool same =
      factors_.dt == state.tangent_dt && factors_.at.size() > 0 && factors_.at == state.tangent_at;
  if (division().min(same ? 1 : 0) == 1) return;
  Matrix tangent = linear_ && assembly_.intact() ? matrices_.stiffness : assembly_.tangent(state.tangent_at);
  ++factors_.made;
  factors_.at.resize(0);  // until they are made
  if (!factors_.kept.factorise(effective(std::move(tangent), state.tangent_dt), mesh().fixed))
    throw failed(state.time, "the matrix of a step is singular");
  factors_.at = state.tangent_at;
  factors_.dt = state.tangent_dt;
}

template <int dim>
Eigen::VectorXd FemSolver<dim>::load_of_window(double t, double dt, const Load& load) const {
  const double time = t + (1 - scheme_.alpha_f) * dt;
  const Points on_points = load.mean(t, t + dt, interface_.position.cols());
  if (!on_points.allFinite())
    throw Error(ExitCode::solver_fault, fmt::format("structure (fem), t = {:.6g} s", time),
                "the load on the interface is not finite",
                "see the fluid's log; lower coupling.surface.window");
  return own_load(time) + interpolation_.to_unknowns(on_points);
}

// C v_α for the step to u1.
template <int dim>
Eigen::VectorXd FemSolver<dim>::damping_force(const GivenStep& step, const Eigen::VectorXd& u1) const {
  const Damping& damping = parameters_.damping;
  const State& old = step.old;
  if (damping.mass == 0 && damping.stiffness == 0) return Eigen::VectorXd::Zero(u1.size());
  const Eigen::VectorXd v1 = scheme_.velocity(old.displacement, u1, old.velocity, old.acceleration, step.dt);
  const Eigen::VectorXd v = scheme_.alpha_f * old.velocity + (1 - scheme_.alpha_f) * v1;
  return damping.mass * (matrices_.mass * v) + damping.stiffness * (matrices_.stiffness * v);
}

template <int dim>
Eigen::Matrix<double, dim, 1> FemSolver<dim>::frame_acceleration(const GivenStep& step,
                                                                 const Eigen::VectorXd& inertia) const {
  const Eigen::Vector3d gravity = gravity_at(step.old.time + (1 - scheme_.alpha_f) * step.dt);
  return support_motion_.acceleration(scheme_, step.old.frame, step.told, step.force, inertia,
                                      gravity.template head<dim>(), step.dt);
}

// Held unknowns of turning supports are not zero: Newton's method leaves them as its start has them.
template <int dim>
void FemSolver<dim>::turn_held(const FrameState& frame, Eigen::VectorXd& u) const {
  if (!support_motion_.supports().turns()) return;
  for (const int i : mesh().fixed)
    u(i) = support_motion_.supports().turned(frame, mesh().place(i / dim))(i % dim);
}

// Work of the supports' forces on constrained unknowns, f + M a_m + M 1 A − F, along their displacement.
template <int dim>
double FemSolver<dim>::work_of_turn(const GivenStep& step, const State& next,
                                    const Eigen::VectorXd& inertia) const {
  if (!support_motion_.supports().turns()) return 0;
  const Eigen::VectorXd inside = internal_force(step.old.displacement, next.displacement, scheme_.alpha_f);
  double work = 0;
  for (const int i : mesh().fixed)
    if (division().owns(i))
      work += (inside(i) + inertia(i) - step.force(i)) * (next.displacement(i) - step.old.displacement(i));
  return division().sum(work);
}

// r(u1) = F − f(u0, u1) − C v_α − M a_m − M 1 A, in the unknowns that are free.
template <int dim>
NewtonResult FemSolver<dim>::solve_step(const GivenStep& step, Eigen::VectorXd start) {
  const State& old = step.old;
  const Eigen::VectorXd& force = step.force;
  const double dt = step.dt;
  const Eigen::VectorXd drift = old.displacement + dt * old.velocity;
  const double kappa = scheme_.inertia() / (dt * dt);
  Equilibrium equilibrium;
  equilibrium.division = division();
  equilibrium.residual = [&](const Eigen::VectorXd& u1) {
    const Eigen::VectorXd inside = internal_force(old.displacement, u1, scheme_.alpha_f);
    Eigen::VectorXd inertia = matrices_.mass * scheme_.mean_acceleration(u1 - drift, old.acceleration, dt);
    inertia += support_motion_.inertia(frame_acceleration(step, inertia));
    Equilibrium::Residual r{.value = force - inside - damping_force(step, u1) - inertia};
    clear_constrained(r.value);
    r.scale = std::max({division().norm(force), division().norm(inside), division().norm(inertia)});
    r.floor = round_off(u1, kappa);
    return r;
  };
  LinearSolver* factors = &factors_.kept;
  auto correction = support_motion_.correction(*factors, kappa);
  equilibrium.correction = [&](const Eigen::VectorXd& r) {
    return correction(factors->solve(r, enough_of_a_correction));
  };
  equilibrium.refresh = [&](const Eigen::VectorXd& u1) {
    factors = &factors_.fresh;
    ++factors_.made;
    // Conjugate gradients and Cholesky factors need a symmetric matrix: the tangent of a state, not of a
    // step. In large bodies LU factors are expensive.
    const bool large = dim == 3 && division().size(mesh().n_unknowns()) >= many_unknowns;
    Matrix tangent = factors_.method == LinearMethod::direct && !large
                         ? assembly_.tangent(old.displacement, u1, scheme_.alpha_f)
                         : assembly_.tangent(u1);
    if (!factors_.fresh.factorise(effective(std::move(tangent), dt), mesh().fixed)) return false;
    correction = support_motion_.correction(factors_.fresh, kappa);
    return true;
  };
  const auto solve_from = [&](Eigen::VectorXd u) {
    turn_held(step.told, u);
    return solve(equilibrium, std::move(u), parameters_.fem.tolerance);
  };
  NewtonResult result = solve_from(std::move(start));
  newton_iterations_ = result.iterations;
  // A part of a body that moves by more than a cell in a step tears its cells along, if it goes on as it was.
  // No line search leads back from there; from the displacement before the step there is a way.
  if (!result.converged && equilibrium.refresh(old.displacement)) {
    result = solve_from(old.displacement);
    newton_iterations_ += result.iterations;
  }
  if (!result.converged)
    throw failed(old.time, fmt::format("Newton's method did not converge: {} iterations, residual {:.2e} N, "
                                       "wanted {:.2e} N",
                                       result.iterations, result.residual, result.wanted));
  if (!(assembly_.smallest_jacobian(result.x) > 0)) throw failed(old.time, "a cell is turned inside out");
  return result;
}

// Adds the work of a step. Without damping, kinetic + strain − external energy stays constant. The loads work
// on u1 − u0. Loads and supports change the momentum p of body and free frame; their work on the frame's
// motion is ½(V0 + V1)·Δp. The work of the damping is subtracted.
template <int dim>
void FemSolver<dim>::account(const GivenStep& step, State& next) const {
  const State& old = step.old;
  const Eigen::Vector3d gained = next.frame.velocity - old.frame.velocity;
  const auto momentum = support_motion_.gained(next.velocity - old.velocity, gained);
  const Eigen::Vector3d V = 0.5 * (old.frame.velocity + next.frame.velocity);
  next.external += division().dot(step.force - damping_force(step, next.displacement),
                                  next.displacement - old.displacement) +
                   V.template head<dim>().dot(momentum);
  next.reaction.setZero();
  for (int axis = 0; axis < dim; ++axis) {
    double loads = 0;
    for (Eigen::Index i = axis; i < division().own(step.force.size()); i += dim) loads += step.force[i];
    next.reaction[axis] =
        (momentum[axis] - support_motion_.lumped_mass(axis) * gained[axis]) / step.dt - division().sum(loads);
  }
}

template <int dim>
void FemSolver<dim>::advance(double t, double dt, const Load& load) {
  assert(dt > 0);
  step(t, dt, load, 0);
}

/// One step, or two of half its length where a cell would lose too much of its share in it.
template <int dim>
void FemSolver<dim>::step(double t, double dt, const Load& load, int halved) {
  // A step is halved if a cell would lose a larger share than this. A notched bar then dissipates 1.02 G_c in
  // steps of 10 µs and 1.09 in steps of 40 µs; without halving 1.08 and 1.57.
  constexpr double largest_fall = 0.1;
  constexpr int most_halvings = 6;
  const State& old = state_;
  State next = old;
  if (!(std::abs(dt - old.tangent_dt) <= same_step * dt)) next.tangent_dt = dt;
  use_tangent(next);

  next.frame = support_motion_.prescribed(old.frame, t + dt);
  const GivenStep given{old, next.frame, load_of_window(t, dt, load), dt};
  const NewtonResult result = failure_ ? solve_softening(given, next.damage)
                                       : solve_step(given, old.displacement + dt * old.velocity);
  if (failure_ && halved < most_halvings &&
      division().max((failure_->integrity(old.damage) - failure_->integrity(next.damage)).maxCoeff()) >
          largest_fall) {
    assembly_.damage(failure_->integrity(old.damage));
    step(t, 0.5 * dt, load, halved + 1);
    step(t + 0.5 * dt, 0.5 * dt, load, halved + 1);
    return;
  }
  const Eigen::VectorXd leap = result.x - old.displacement - dt * old.velocity;
  next.displacement = result.x;
  next.velocity = scheme_.velocity(old.displacement, result.x, old.velocity, old.acceleration, dt);
  next.acceleration = scheme_.acceleration(leap, old.acceleration, dt);
  const Eigen::VectorXd inertia = matrices_.mass * scheme_.mean_acceleration(leap, old.acceleration, dt);
  const auto A = frame_acceleration(given, inertia);
  support_motion_.advance(scheme_, old.frame, A, dt, next.frame);
  account(given, next);
  next.external += work_of_turn(given, next, inertia + support_motion_.inertia(A));
  if (result.refreshed || result.iterations > iterations_of_a_good_tangent ||
      next.damage.released != old.damage.released)
    next.tangent_at = result.x;
  next.time = t + dt;
  ++next.steps;
  state_ = std::move(next);
}

// Solves a step in which cells soften from integrity h0 = 1 − D0 to h1. The forces use the mean integrity s,
// so that the dissipation is that of the trapezoidal rule, ½ Σ V (h0 − h1)(ψ0 + ψ1):
//   released += U_s(u1) − U_s(u0) − (U_h1(u1) − U_h0(u0))
// It is a fixed-point iteration on u1 and h1, until s changes by less than 1e-3. A difference that is left
// does not break the energy balance, since the balance uses the s of the forces.
template <int dim>
NewtonResult FemSolver<dim>::solve_softening(const GivenStep& step, typename Damage<dim>::State& damage) {
  const State& old = step.old;
  constexpr int most_passes = 40;
  constexpr double still = 1e-3;  // of a share
  const Eigen::VectorXd before = failure_->integrity(old.damage);
  Eigen::VectorXd carried = before;
  NewtonResult result;
  Eigen::VectorXd start = old.displacement + step.dt * old.velocity;
  for (int pass = 0;; ++pass) {
    assembly_.damage(carried);
    result = solve_step(step, start);
    damage = old.damage;
    if (!failure_->look(result.x, old.time + step.dt, damage)) break;
    const Eigen::VectorXd mean = 0.5 * (before + failure_->integrity(damage));
    const double change = division().max((mean - carried).cwiseAbs().maxCoeff());
    if (change <= still || pass == most_passes) break;
    carried = mean;
    start = result.x;
  }
  const Eigen::VectorXd after = failure_->integrity(damage);
  if (division().any(after != before || carried != before)) {
    const double work = assembly_.strain_energy(result.x) - assembly_.strain_energy(old.displacement);
    assembly_.damage(before);
    const double first = assembly_.strain_energy(old.displacement);
    assembly_.damage(after);
    damage.released += work - (assembly_.strain_energy(result.x) - first);
  }
  return result;
}

template void FemSolver<2>::advance(double, double, const Load&);
template void FemSolver<3>::advance(double, double, const Load&);

}  // namespace strake::structure::fem
