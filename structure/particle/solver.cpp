#include "structure/particle/solver.hpp"

#include "proto/error.hpp"
#include "structure/body/beam.hpp"
#include "structure/body/surface.hpp"
#include "structure/material/material.hpp"
#include "structure/particle/linearised.hpp"
#include "structure/particle/pair_model.hpp"
#include "structure/particle/total_lagrangian.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::structure {
namespace {

/// N x for a field on the particles, and Nᵀ f for a force on the points.
template <int dim>
Points interpolate(const SparseRows& N, const Vectors<dim>& x) {
  return in_space<dim>((N * x.transpose()).transpose());
}
template <int dim>
Vectors<dim> spread(const SparseRows& N, const Points& f) {
  return (N.transpose() * f.template topRows<dim>().transpose()).transpose();
}

template <int dim>
Eigen::VectorXd masses(const Lattice<dim>& lattice) {
  Eigen::VectorXd mass(lattice.size());
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    mass[i] = lattice.material(i).density * lattice.share[i];
    for (int axis = 0; axis < dim; ++axis) mass[i] *= lattice.spacing;
  }
  return mass;
}

/// Of the body's particles that move with its supports.
template <int dim>
double fixed_mass(const Lattice<dim>& lattice, const Eigen::VectorXd& mass) {
  double sum = 0;
  for (Eigen::Index i = 0; i < mass.size(); ++i)
    if (lattice.fixed[static_cast<std::size_t>(i)] && lattice.inside[static_cast<std::size_t>(i)])
      sum += mass[i];
  return sum;
}

/// Volume coupling: the particles of the body, with their mass; those outside belong to the clamps.
template <int dim>
InterfaceMesh volume_mesh(const Lattice<dim>& lattice, const Eigen::VectorXd& mass) {
  const Eigen::Index n = lattice.count_inside();
  InterfaceMesh mesh;
  mesh.name = "structure";
  mesh.dimension = dim;
  mesh.position = Points::Zero(3, n);
  mesh.mass.resize(n);
  for (Eigen::Index i = 0, p = 0; i < lattice.size(); ++i)
    if (lattice.inside[static_cast<std::size_t>(i)]) {
      mesh.mass[p] = mass[i];
      mesh.position.col(p++).template head<dim>() = lattice.position.col(i);
    }
  return mesh;
}

template <int dim>
SparseRows volume_selection(const Lattice<dim>& lattice) {
  SparseRows N(lattice.count_inside(), lattice.size());
  for (Eigen::Index i = 0, p = 0; i < lattice.size(); ++i)
    if (lattice.inside[static_cast<std::size_t>(i)]) N.insert(p++, i) = 1;
  N.makeCompressed();
  return N;
}

/// The pair model and the unified loop have weights and densities of a lattice without gaps.
Places places_of(const Parameters& p) {
  return p.particle.model == ParticleModel::pair || p.interface == "volume" ? Places::cells : Places::pieces;
}

/// The loaded surface with points as near to one another as the particles, for the case's own load.
InterfaceMesh fine_surface(const Parameters& p) {
  Parameters fine = p;
  fine.surface_spacing = p.particle.spacing;
  return surface(fine);
}

template <int dim>
std::unique_ptr<ElasticModel<dim>> make_model(const ParticleKeys& keys, const Lattice<dim>& lattice,
                                              const Bonds<dim>& bonds) {
  if constexpr (dim == 2)
    if (keys.model == ParticleModel::pair) return std::make_unique<PairModel>(lattice, bonds, keys.rotation);
  return std::make_unique<TotalLagrangian<dim>>(lattice, bonds, keys.hourglass);
}

/// A plate as long as the body and as thin as its thinnest part. Its first frequency estimates the body's.
template <int dim>
Plate slenderest(const Parameters& p, const Lattice<dim>& lattice) {
  if (p.shape.kind == ShapeKind::plate) return p.plate;
  Plate plate;
  plate.length = lattice.extent.maxCoeff() * lattice.spacing;
  plate.thickness = lattice.layers * lattice.spacing;
  const bool clamped = std::count(lattice.fixed.begin(), lattice.fixed.end(), 1) > 0;
  plate.left = plate.right = clamped ? Support::clamped : Support::free;
  return plate;
}

}  // namespace

template <int dim>
ParticleSolver<dim>::ParticleSolver(const Parameters& p)
    : parameters_(p),
      frame_(p),
      lattice_(make_lattice<dim>(elastic_solid(p), p.particle.spacing, p.particle.radius, p.particle.clamp,
                                 places_of(p))),
      bonds_(make_bonds<dim>(lattice_, p.particle.radius)),
      mass_(masses<dim>(lattice_)),
      fixed_mass_(fixed_mass<dim>(lattice_, mass_)),
      constraints_(lattice_, elastic_solid(p), mass_, frame_mass()),
      model_(make_model<dim>(p.particle, lattice_, bonds_)) {
  if (p.interface == "volume") {
    mesh_ = volume_mesh<dim>(lattice_, mass_);
    to_interface_ = volume_selection<dim>(lattice_);
  } else {
    mesh_ = surface(p);
    to_interface_ = interpolation<dim>(lattice_, mesh_.position);
  }
  const InterfaceMesh fine = fine_surface(p);
  case_force_ =
      spread<dim>(interpolation<dim>(lattice_, fine.position), case_force(p.load, elastic_solid(p), fine));

  const bool has_fixed = std::count(lattice_.fixed.begin(), lattice_.fixed.end(), 1) > 0;
  for (int axis = 0; axis < dim; ++axis)
    if (!has_fixed && !constraints_.along(axis)) frame_.stays_out(axis);
  if (frame_.is_free() && frame_.mass() + fixed_mass_ == 0)
    throw Error(ExitCode::case_file, "structure.lumped.mass",
                "is 0, and no particle of the body is fixed: a free frame has no mass",
                "structure.lumped.mass, or structure.particle.clamp = \"inside\"");
  elastic_limit_ = elastic_limit<dim>(
      *model_, lattice_, mass_,
      has_fixed ? frame_mass() : Vector(Vector::Constant(std::numeric_limits<double>::infinity())));
  largest_step_ = p.particle.safety * elastic_limit_;

  start();
  if (p.failure.criterion != FailureCriterion::none) {
    failure_.emplace(p.failure, p.particle.hourglass, lattice_, bonds_);
    state_.failure = failure_->intact();
  }
  if (model_->spins()) {
    inertia_ = mass_ * lattice_.spacing * lattice_.spacing / 6;  // of a square
    state_.turn = state_.spin = state_.torque = Eigen::VectorXd::Zero(lattice_.size());
  }
  find_elastic_force();
  state_.interface_velocity = state_.window_velocity = interpolate<dim>(to_interface_, state_.velocity);
  saved_ = state_;
}

/// The body moves with its supports and by what the case adds, as far as they let it.
template <int dim>
void ParticleSolver<dim>::start() {
  state_.frame = frame_.start();
  state_.displacement = Vectors<dim>::Zero(dim, lattice_.size());
  Vector V = state_.frame.velocity.template head<dim>();
  state_.velocity = V.replicate(1, lattice_.size());
  for (Eigen::Index i = 0; i < lattice_.size(); ++i)
    if (!lattice_.fixed[static_cast<std::size_t>(i)])
      state_.velocity.col(i) +=
          velocity_at_start(parameters_.initial, lattice_.part[static_cast<std::size_t>(i)],
                            lattice_.place(i))
              .template head<dim>();
  for (Eigen::Index i = 0; frame_.turns() && i < lattice_.size(); ++i)
    state_.velocity.col(i) += frame_.turning(state_.frame, lattice_.place(i)).template head<dim>();
  constraints_.project(state_.velocity, V, nullptr, 1);
  state_.frame.velocity.template head<dim>() = V;
}

template <int dim>
std::optional<Eigen::Vector3d> ParticleSolver<dim>::support_displacement(const Eigen::Vector3d& X) const {
  return state_.frame.displacement + frame_.turned(state_.frame, X);
}

template <int dim>
void ParticleSolver<dim>::set_velocity(const Vectors<dim>& velocity) {
  for (Eigen::Index i = 0; i < lattice_.size(); ++i)
    if (!lattice_.fixed[static_cast<std::size_t>(i)]) state_.velocity.col(i) = velocity.col(i);
  Vector V = state_.frame.velocity.template head<dim>();
  constraints_.project(state_.velocity, V, nullptr, 1);
  state_.frame.velocity.template head<dim>() = V;
  state_.interface_velocity = state_.window_velocity = interpolate<dim>(to_interface_, state_.velocity);
  saved_ = state_;
}

template <int dim>
void ParticleSolver<dim>::find_elastic_force() {
  state_.elastic_force = model_->spins() ? model_->force(state_.displacement, state_.turn, state_.torque)
                                         : model_->force(state_.displacement);
}

template <int dim>
double ParticleSolver<dim>::strain_energy() const {
  return model_->spins() ? model_->energy(state_.displacement, state_.turn)
                         : model_->energy(state_.displacement);
}

template <int dim>
void ParticleSolver<dim>::break_bonds(double time) {
  if (!failure_ || !failure_->look(state_.displacement, time, state_.failure)) return;
  const double before = strain_energy();
  failure_->apply(state_.failure);
  state_.failure.released += before - strain_energy();
}

template <int dim>
void ParticleSolver<dim>::restore() {
  state_ = saved_;
  if (failure_) failure_->apply(state_.failure);
}

// A window of n sub-steps. What it makes out of nothing, ΔE + released − work, stays below the energy in it
// while the sub-steps are stable: leapfrog keeps E(1 − (½ωh)²) of a mode, at most 2.8 times less than E with
// the default safety. One that makes more, or leaves the numbers, is taken again with sub-steps half as long:
// a stretched solid is stiffer than at rest, from which the limit was found.
template <int dim>
void ParticleSolver<dim>::advance(double t, double dt, const Load& load) {
  constexpr int most_halvings = 3;
  int n = std::max(1, static_cast<int>(std::ceil(dt / largest_step_ * (1 - 1e-12))));
  const State start = state_;
  const Energy before = energy();
  const double longest = dt / n;
  for (int halved = 0;; ++halved, n *= 2) {
    take_window(t, dt, n, load);
    if (is_sound(before)) return;
    const bool finite = is_finite();
    state_ = start;
    if (failure_) failure_->apply(state_.failure);
    if (halved == most_halvings)
      throw StepFailed(ExitCode::solver_fault, fmt::format("structure (particle), t = {:.6g} s", t),
                       fmt::format("{} with sub-steps of {:.3g} s, and down to {:.3g} s",
                                   finite ? "the particles make energy out of nothing"
                                          : "the particles' places are not finite",
                                   longest, dt / n),
                       fmt::format("lower structure.particle.safety ({:.3g}), or look at the load. Where no "
                                   "shorter window was tried, lower coupling.surface.window",
                                   parameters_.particle.safety));
  }
}

template <int dim>
void ParticleSolver<dim>::take_window(double t, double dt, int n, const Load& load) {
  const double h = dt / n;
  const Points before = displacement();
  for (int k = 0; k < n; ++k) {
    const double middle = t + (k + 0.5) * h;
    state_.time = t + k * h;
    const Points fluid = load.mean(state_.time, t + (k + 1) * h, mesh_.position.cols());
    sub_step(h, external_force(middle, spread<dim>(to_interface_, fluid)), gravity_at(middle));
  }
  state_.time = t + dt;
  follow_interface(before, dt);
}

template <int dim>
bool ParticleSolver<dim>::is_finite() const {
  return state_.displacement.allFinite() && state_.velocity.allFinite();
}

template <int dim>
bool ParticleSolver<dim>::is_sound(const Energy& before) const {
  constexpr double most = 0.5;             // of the energy that was there or was put in
  constexpr double unseen_strain = 1e-10;  // round-off alone makes strains of 1e-13
  if (!is_finite()) return false;
  const Energy after = energy();
  const double work = after.external - before.external, there = before.kinetic + before.strain;
  const double made = after.kinetic + after.strain + after.released - there - before.released - work;
  const double speed = lattice_.spacing / elastic_limit_;  // [m/s] about the speed of sound
  return made <= most * std::max(there, std::abs(work)) + std::pow(unseen_strain * speed, 2) * mass_.sum();
}

// The partner's force is constant over a window: F̄ = −m_a (v_{n+1} − v_n)/dt for an added mass m_a. On a
// mode of frequency ω it does the work F̄ Δx, and with the particles' own end velocities Δx/dt = v̄ tan(z)/z,
// z = ½ω dt: beyond z = ½π the work has the wrong sign and the mode grows. The velocity sent to the partner
// therefore follows from the places at the ends of the windows,
//   v_{n+1} = w + (w − w')·dt/(dt + dt'),   w = Δx/dt of this window, w' of the one before   (BDF2; equal dt:
//   (3w − w')/2)
// It is of second order. The work is then a difference of squares less a square, so that no energy is
// produced for any ω dt.
template <int dim>
void ParticleSolver<dim>::follow_interface(const Points& before, double dt) {
  if (mesh_.faces.cols() == 0) {  // volume coupling: the fluid places the particles themselves
    state_.interface_velocity = interpolate<dim>(to_interface_, state_.velocity);
    return;
  }
  const Points mean = (displacement() - before) / dt;
  const double last = state_.window > 0 ? state_.window : dt;
  state_.interface_velocity = mean + dt / (dt + last) * (mean - state_.window_velocity);
  state_.window_velocity = mean;
  state_.window = dt;
}

template <int dim>
Vectors<dim> ParticleSolver<dim>::external_force(double time, const Vectors<dim>& fluid) const {
  const Vector gravity = gravity_at(time);
  Vectors<dim> force = fluid + ramp_factor(time, parameters_.load.ramp) * case_force_;
  for (Eigen::Index i = 0; i < force.cols(); ++i)
    if (lattice_.inside[static_cast<std::size_t>(i)]) force.col(i) += mass_[i] * gravity;
  return force;
}

template <int dim>
typename ParticleSolver<dim>::Vector ParticleSolver<dim>::gravity_at(double time) const {
  return ramp_factor(time, parameters_.gravity_ramp) * parameters_.gravity.head<dim>();
}

template <int dim>
Points ParticleSolver<dim>::displacement() const {
  return interpolate<dim>(to_interface_, state_.displacement);
}

template <int dim>
Points ParticleSolver<dim>::velocity() const {
  return state_.interface_velocity;
}

template <int dim>
Eigen::Vector3d ParticleSolver<dim>::displacement_at(const Eigen::Vector3d& X) const {
  return interpolate<dim>(interpolation<dim>(lattice_, X), state_.displacement);
}

template <int dim>
Eigen::Vector3d ParticleSolver<dim>::velocity_at(const Eigen::Vector3d& X) const {
  return interpolate<dim>(interpolation<dim>(lattice_, X), state_.velocity);
}

template <int dim>
Energy ParticleSolver<dim>::energy() const {
  Energy energy;
  for (Eigen::Index i = 0; i < lattice_.size(); ++i)
    if (lattice_.inside[static_cast<std::size_t>(i)])
      energy.kinetic += 0.5 * mass_[i] * state_.velocity.col(i).squaredNorm();
  for (int axis = 0; axis < dim; ++axis)
    if (frame_.is_free(axis))
      energy.kinetic += 0.5 * frame_.mass() * std::pow(state_.frame.velocity[axis], 2);
  energy.strain = strain_energy();
  energy.released = state_.failure.released;
  if (model_->spins()) energy.kinetic += 0.5 * inertia_.dot(state_.spin.cwiseAbs2());
  energy.external = state_.external_work;
  return energy;
}

template <int dim>
Eigen::Vector3d ParticleSolver<dim>::momentum() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const Points v = in_space<dim>(state_.velocity);
  for (Eigen::Index i = 0; i < v.cols(); ++i)
    if (lattice_.inside[static_cast<std::size_t>(i)]) sum += mass_[i] * v.col(i);
  for (Eigen::Index axis = 0; axis < dim; ++axis)
    if (frame_.is_free(axis)) sum[axis] += frame_.mass() * state_.frame.velocity[axis];
  return sum;
}

template <int dim>
Eigen::Vector3d ParticleSolver<dim>::angular_momentum() const {
  const Points x = in_space<dim>(lattice_.position + state_.displacement), v = in_space<dim>(state_.velocity);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    if (lattice_.inside[static_cast<std::size_t>(i)])
      sum += mass_[i] * Eigen::Vector3d(x.col(i)).cross(Eigen::Vector3d(v.col(i)));
  if (model_->spins()) sum.z() += inertia_.dot(state_.spin);
  return sum;
}

template <int dim>
void ParticleSolver<dim>::solve_static() {
  const Vectors<dim> weight = parameters_.gravity.head<dim>() * mass_.transpose();
  state_.displacement = equilibrium<dim>(*model_, lattice_, constraints_, case_force_ + weight);
  state_.velocity.setZero();
  state_.interface_velocity.setZero();
  find_elastic_force();
}

template <int dim>
std::vector<double> ParticleSolver<dim>::frequencies(int count) {
  const double scale = beam_frequencies(slenderest(parameters_, lattice_), parameters_.material,
                                        BeamTheory::euler_bernoulli, 1)
                           .at(0);
  return natural_frequencies<dim>(*model_, lattice_, constraints_, mass_, scale, count);
}

std::unique_ptr<Solver> make_particle_solver(const Parameters& p) {
  if (p.dimension == 3) return std::make_unique<ParticleSolver<3>>(p);
  return std::make_unique<ParticleSolver<2>>(p);
}

template class ParticleSolver<2>;
template class ParticleSolver<3>;

}  // namespace strake::structure
