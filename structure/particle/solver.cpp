#include "structure/particle/solver.hpp"

#include "proto/error.hpp"
#include "structure/beam.hpp"
#include "structure/material.hpp"
#include "structure/particle/linearised.hpp"
#include "structure/particle/pair_model.hpp"
#include "structure/particle/total_lagrangian.hpp"
#include "structure/surface.hpp"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace strake::structure {
namespace {

template <int dim>
Points in_space(const Vectors<dim>& vectors) {
  Points points = Points::Zero(3, vectors.cols());
  points.template topRows<dim>() = vectors;
  return points;
}

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
Eigen::Index count_inside(const Lattice<dim>& lattice) {
  return std::count(lattice.inside.begin(), lattice.inside.end(), 1);
}

template <int dim>
Eigen::VectorXd masses(const Lattice<dim>& lattice) {
  Eigen::VectorXd mass(lattice.size());
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    mass[i] = lattice.material(i).density;
    for (int axis = 0; axis < dim; ++axis) mass[i] *= lattice.spacing;
  }
  return mass;
}

/// Volume coupling: the particles of the body themselves, with their mass; those outside belong to the
/// clamps.
template <int dim>
InterfaceMesh volume_mesh(const Lattice<dim>& lattice, const Eigen::VectorXd& mass) {
  const Eigen::Index n = count_inside(lattice);
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
  SparseRows N(count_inside(lattice), lattice.size());
  for (Eigen::Index i = 0, p = 0; i < lattice.size(); ++i)
    if (lattice.inside[static_cast<std::size_t>(i)]) N.insert(p++, i) = 1;
  N.makeCompressed();
  return N;
}

/// The wet surface with points as near to one another as the particles, for the case's own load.
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

/// A plate as long as the body and as thin as its thinnest part: its first frequency is of the body's order.
template <int dim>
Plate slenderest(const Parameters& p, const Lattice<dim>& lattice) {
  if (p.shape.kind == ShapeKind::plate) return p.plate;
  Plate plate;
  plate.length = lattice.extent.maxCoeff() * lattice.spacing;
  plate.thickness = lattice.layers * lattice.spacing;
  const bool held = std::count(lattice.fixed.begin(), lattice.fixed.end(), 1) > 0;
  plate.left = plate.right = held ? Support::clamped : Support::free;
  return plate;
}

std::string model_name(const ParticleKeys& keys) {
  if (keys.model == ParticleModel::total_lagrangian) return "total Lagrangian";
  return keys.rotation == Rotation::dynamic
             ? "pair model, rotation dynamic: angular momentum exact"
             : "pair model, rotation of the neighbourhood: angular momentum for small strains only";
}

}  // namespace

template <int dim>
ParticleSolver<dim>::ParticleSolver(const Parameters& p)
    : parameters_(p),
      lattice_(make_lattice<dim>(elastic_solid(p), p.particle.spacing, p.particle.radius, p.particle.clamp)),
      bonds_(make_bonds<dim>(lattice_, p.particle.radius)),
      mass_(masses<dim>(lattice_)),
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

  elastic_limit_ = elastic_limit<dim>(*model_, lattice_, mass_);
  largest_step_ = p.particle.safety * elastic_limit_;

  state_.displacement = Vectors<dim>::Zero(dim, lattice_.size());
  state_.velocity = p.velocity.head<dim>().replicate(1, lattice_.size());
  if (model_->spins()) {
    inertia_ = mass_ * lattice_.spacing * lattice_.spacing / 6;  // of a square
    state_.turn = state_.spin = state_.torque = Eigen::VectorXd::Zero(lattice_.size());
  }
  find_elastic_force();
  state_.interface_velocity = state_.window_velocity = interpolate<dim>(to_interface_, state_.velocity);
  saved_ = state_;
}

template <int dim>
void ParticleSolver<dim>::set_velocity(const Vectors<dim>& velocity) {
  for (Eigen::Index i = 0; i < lattice_.size(); ++i)
    if (!lattice_.fixed[static_cast<std::size_t>(i)]) state_.velocity.col(i) = velocity.col(i);
  state_.interface_velocity = state_.window_velocity = interpolate<dim>(to_interface_, state_.velocity);
  saved_ = state_;
}

template <int dim>
void ParticleSolver<dim>::find_elastic_force() {
  state_.elastic_force = model_->spins() ? model_->force(state_.displacement, state_.turn, state_.torque)
                                         : model_->force(state_.displacement);
}

template <int dim>
void ParticleSolver<dim>::advance(double t, double dt, const Load& load) {
  const int n = std::max(1, static_cast<int>(std::ceil(dt / largest_step_ * (1 - 1e-12))));
  const double h = dt / n;
  const Points before = displacement();
  for (int k = 0; k < n; ++k) {
    const double middle = t + (k + 0.5) * h;
    state_.time = t + k * h;
    const Points fluid = load.mean(state_.time, t + (k + 1) * h, mesh_.position.cols());
    sub_step(h, external_force(middle, spread<dim>(to_interface_, fluid)));
  }
  state_.time = t + dt;
  follow_interface(before, dt);
  if (!state_.displacement.allFinite() || !state_.velocity.allFinite())
    throw Error(ExitCode::solver_fault, fmt::format("structure, t = {:.6g} s", state_.time),
                "particle positions are not finite",
                fmt::format("lower structure.particle.safety ({:.3g}) or coupling.surface.window",
                            parameters_.particle.safety));
}

// The partner's force is held over a window: F̄ = −m_a (v_{n+1} − v_n)/dt for an added mass m_a. On a mode of
// frequency ω it does the work F̄ Δx, and with the particles' own end velocities Δx/dt = v̄ tan(z)/z, z = ½ω
// dt: beyond z = ½π the work has the wrong sign and the mode grows. The velocity told is therefore that of
// the places at the ends of the windows,
//   v_{n+1} = w + (w − w')·dt/(dt + dt'),   w = Δx/dt of this window, w' of the one before   (BDF2; equal dt:
//   (3w − w')/2)
// second order, and the work is then a difference of squares less a square: energy is never made, whatever ω
// dt.
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
  const double ramp = ramp_factor(time, parameters_.gravity_ramp);
  Vectors<dim> force = fluid + ramp_factor(time, parameters_.load.ramp) * case_force_;
  for (Eigen::Index i = 0; i < force.cols(); ++i)
    force.col(i) += mass_[i] * ramp * parameters_.gravity.head<dim>();
  return force;
}

// Leapfrog (velocity Verlet), second order and symplectic; external force held over the step, c
// mass-proportional damping of the motion relative to the supports:
//   v_½ = v + ½h (f(u)/m + a),  u⁺ = u + h v_½,  v⁺ = v_½ + ½h (f(u⁺)/m + a)
// The work of the loads is f_ext·(u⁺ − u). A support moves with constant velocity: its force is −(f + f_ext),
// its work added to that of the loads leaves −½(f(u) + f(u⁺))·(u⁺ − u).
template <int dim>
void ParticleSolver<dim>::sub_step(double h, const Vectors<dim>& external) {
  const Eigen::Matrix<double, dim, 1> V = parameters_.velocity.head<dim>();
  const double c = parameters_.damping.mass;
  const Eigen::Index n = lattice_.size();
  Vectors<dim> moved(dim, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (lattice_.fixed[static_cast<std::size_t>(i)]) {
      moved.col(i) = V * (state_.time + h) - state_.displacement.col(i);
    } else {
      const Eigen::Matrix<double, dim, 1> a = (state_.elastic_force.col(i) + external.col(i)) / mass_[i];
      state_.velocity.col(i) += 0.5 * h * (a - c * (state_.velocity.col(i) - V));
      moved.col(i) = h * state_.velocity.col(i);
    }
  }
  state_.displacement += moved;
  double work = 0;
  if (model_->spins()) work += turn_half(h, true);
  const Vectors<dim> before = std::move(state_.elastic_force);
  find_elastic_force();
  for (Eigen::Index i = 0; i < n; ++i) {
    if (lattice_.fixed[static_cast<std::size_t>(i)]) {
      work -= 0.5 * (before.col(i) + state_.elastic_force.col(i)).dot(moved.col(i));
    } else {
      work += (external.col(i) - c * mass_[i] * (state_.velocity.col(i) - V)).dot(moved.col(i));
      const Eigen::Matrix<double, dim, 1> a = (state_.elastic_force.col(i) + external.col(i)) / mass_[i];
      state_.velocity.col(i) = V + (state_.velocity.col(i) - V + 0.5 * h * a) / (1 + 0.5 * h * c);
    }
  }
  if (model_->spins()) turn_half(h, false);
  state_.external_work += work;
  ++state_.steps;
}

// The spins of R2 in the same way: ω_½ = ω + ½h (M/I − c ω), θ⁺ = θ + h ω_½, and once more with the new
// torque. Returns the damping's work −c I ω_½ · hω_½.
template <int dim>
double ParticleSolver<dim>::turn_half(double h, bool first) {
  const double c = parameters_.damping.mass;
  double work = 0;
  for (Eigen::Index i = 0; i < lattice_.size(); ++i) {
    if (lattice_.fixed[static_cast<std::size_t>(i)]) continue;  // supports move, they do not turn
    const double a = state_.torque[i] / inertia_[i];
    if (first) {
      state_.spin[i] += 0.5 * h * (a - c * state_.spin[i]);
      state_.turn[i] += h * state_.spin[i];
      work -= c * inertia_[i] * state_.spin[i] * h * state_.spin[i];
    } else {
      state_.spin[i] = (state_.spin[i] + 0.5 * h * a) / (1 + 0.5 * h * c);
    }
  }
  return work;
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
  energy.strain = model_->spins() ? model_->energy(state_.displacement, state_.turn)
                                  : model_->energy(state_.displacement);
  if (model_->spins()) energy.kinetic += 0.5 * inertia_.dot(state_.spin.cwiseAbs2());
  energy.external = state_.external_work;
  return energy;
}

template <int dim>
Eigen::Vector3d ParticleSolver<dim>::momentum() const {
  return in_space<dim>(state_.velocity) * mass_;
}

template <int dim>
Eigen::Vector3d ParticleSolver<dim>::angular_momentum() const {
  const Points x = in_space<dim>(lattice_.position + state_.displacement), v = in_space<dim>(state_.velocity);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    sum += mass_[i] * Eigen::Vector3d(x.col(i)).cross(Eigen::Vector3d(v.col(i)));
  if (model_->spins()) sum.z() += inertia_.dot(state_.spin);
  return sum;
}

template <int dim>
void ParticleSolver<dim>::solve_static() {
  const Vectors<dim> weight = parameters_.gravity.head<dim>() * mass_.transpose();
  state_.displacement = equilibrium<dim>(*model_, lattice_, case_force_ + weight);
  state_.velocity.setZero();
  state_.interface_velocity.setZero();
  find_elastic_force();
}

template <int dim>
std::vector<double> ParticleSolver<dim>::frequencies(int count) {
  const double scale = beam_frequencies(slenderest(parameters_, lattice_), parameters_.material,
                                        BeamTheory::euler_bernoulli, 1)
                           .at(0);
  return natural_frequencies<dim>(*model_, lattice_, mass_, scale, count);
}

template <int dim>
void ParticleSolver<dim>::write(Archive& archive) const {
  archive.real["particle.displacement"] = saved_.displacement;
  archive.real["particle.velocity"] = saved_.velocity;
  archive.real["particle.interface_velocity"] = saved_.interface_velocity;
  archive.real["particle.window_velocity"] = saved_.window_velocity;
  archive.real["particle.scalars"] = Eigen::Vector3d(saved_.time, saved_.external_work, saved_.window);
  archive.integer["particle.steps"] = {saved_.steps};
  if (model_->spins()) {
    archive.real["particle.turn"] = saved_.turn;
    archive.real["particle.spin"] = saved_.spin;
  }
}

template <int dim>
void ParticleSolver<dim>::read(const Archive& archive) {
  const auto& u = archive.real.at("particle.displacement");
  if (u.rows() != dim || u.cols() != lattice_.size())
    throw Error(ExitCode::case_file, "structure, checkpoint",
                fmt::format("holds {} particles, the case has {}", u.cols(), lattice_.size()),
                "resume with the case of that run");
  state_.displacement = u;
  state_.velocity = archive.real.at("particle.velocity");
  state_.time = archive.real.at("particle.scalars")(0);
  state_.external_work = archive.real.at("particle.scalars")(1);
  state_.window = archive.real.at("particle.scalars")(2);
  state_.interface_velocity = archive.real.at("particle.interface_velocity");
  state_.window_velocity = archive.real.at("particle.window_velocity");
  state_.steps = static_cast<int>(archive.integer.at("particle.steps").at(0));
  if (model_->spins()) {
    state_.turn = archive.real.at("particle.turn");
    state_.spin = archive.real.at("particle.spin");
  }
  find_elastic_force();
  saved_ = state_;
}

//   Cauchy stress σ = P Fᵀ / det F; in plane strain σ_zz = λ/(2(λ+μ)) (σ_xx + σ_yy) = ν (σ_xx + σ_yy)
//   von Mises √(3/2 s:s) of its deviator s
template <int dim>
Frame ParticleSolver<dim>::frame() const {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  const Tensors<dim> H = displacement_gradient<dim>(bonds_, state_.displacement);
  Eigen::MatrixXd stress(dim == 2 ? 3 : 6, lattice_.size()), mises(1, lattice_.size());
  for (Eigen::Index i = 0; i < lattice_.size(); ++i) {
    const Material& material = lattice_.material(i);
    const Matrix F = Matrix::Identity() + Eigen::Map<const Matrix>(H.col(i).data());
    const Matrix s = first_piola_kirchhoff<dim>(material, F) * F.transpose() / F.determinant();
    if constexpr (dim == 2) {
      const double zz = material.plane_stress ? 0 : material.poisson * s.trace();
      stress.col(i) << s(0, 0), s(1, 1), s(0, 1);
      mises(0, i) = std::sqrt(
          0.5 * (std::pow(s(0, 0) - s(1, 1), 2) + std::pow(s(1, 1) - zz, 2) + std::pow(zz - s(0, 0), 2)) +
          3 * s(0, 1) * s(0, 1));
    } else {
      const Matrix deviator = s - s.trace() / 3 * Matrix::Identity();
      stress.col(i) << s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2);
      mises(0, i) = std::sqrt(1.5) * deviator.norm();
    }
  }
  Frame frame;
  frame.time = state_.time;
  frame.position = in_space<dim>(lattice_.position + state_.displacement);
  frame.point_data = {{"displacement", "m", in_space<dim>(state_.displacement)},
                      {"velocity", "m/s", in_space<dim>(state_.velocity)},
                      {"stress", "Pa", stress},
                      {"von_mises", "Pa", mises}};
  return frame;
}

template <int dim>
std::vector<std::string> ParticleSolver<dim>::lines() const {
  const Eigen::Index inside = count_inside(lattice_);
  double fastest = 0, mass = 0;
  for (Eigen::Index i = 0; i < lattice_.size(); ++i) {
    fastest = std::max(fastest, wave_speed(lattice_.material(i)));
    if (lattice_.inside[static_cast<std::size_t>(i)]) mass += mass_[i];
  }
  const bool plate = parameters_.shape.kind == ShapeKind::plate && dim == 2;
  return {
      fmt::format("particle ({})   {} layers, {} particles (+ {} in the clamps)   spacing {:.4g} mm",
                  model_name(parameters_.particle), lattice_.layers, inside, lattice_.size() - inside,
                  1e3 * lattice_.spacing),
      fmt::format("mass {:.4g} {}", mass, dim == 2 ? "kg/m" : "kg") +
          (plate ? "   " + beam_line(parameters_.plate, parameters_.material) : std::string()),
      fmt::format("elastic limit {:.4g} s = {:.3f} spacing / c_P (c_P {:.0f} m/s), sub-step at most {:.4g} s",
                  elastic_limit_, elastic_limit_ * fastest / lattice_.spacing, fastest, largest_step_)};
}

std::unique_ptr<Solver> make_particle_solver(const Parameters& p) {
  if (p.dimension == 3) return std::make_unique<ParticleSolver<3>>(p);
  return std::make_unique<ParticleSolver<2>>(p);
}

template class ParticleSolver<2>;
template class ParticleSolver<3>;

}  // namespace strake::structure
