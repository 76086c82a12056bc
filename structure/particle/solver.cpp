#include "structure/particle/solver.hpp"

#include "proto/error.hpp"
#include "structure/beam.hpp"
#include "structure/material.hpp"
#include "structure/particle/linearised.hpp"
#include "structure/particle/pair_model.hpp"
#include "structure/particle/total_lagrangian.hpp"
#include "structure/surface.hpp"

#include <fmt/format.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace strake::structure {
namespace {

Points in_space(const Eigen::Matrix2Xd& plane) {
  Points points = Points::Zero(3, plane.cols());
  points.topRows<2>() = plane;
  return points;
}

/// N x for a field on the particles, and Nᵀ f for a force on the points.
Points interpolate(const Eigen::SparseMatrix<double, Eigen::RowMajor>& N, const Eigen::Matrix2Xd& x) {
  return in_space((N * x.transpose()).transpose());
}
Eigen::Matrix2Xd spread(const Eigen::SparseMatrix<double, Eigen::RowMajor>& N, const Points& f) {
  return (N.transpose() * f.topRows<2>().transpose()).transpose();
}

/// Volume coupling: the particles of the span themselves, with their mass; the columns outside belong to the
/// clamp.
InterfaceMesh volume_mesh(const Lattice& lattice, double mass) {
  const Eigen::Index n = std::count(lattice.inside.begin(), lattice.inside.end(), 1);
  InterfaceMesh mesh;
  mesh.name = "structure";
  mesh.dimension = 2;
  mesh.position = Points::Zero(3, n);
  mesh.mass = Eigen::VectorXd::Constant(n, mass);
  for (Eigen::Index i = 0, p = 0; i < lattice.size(); ++i)
    if (lattice.inside[static_cast<std::size_t>(i)])
      mesh.position.col(p++).head<2>() = lattice.position.col(i);
  return mesh;
}

Eigen::SparseMatrix<double, Eigen::RowMajor> volume_selection(const Lattice& lattice, Eigen::Index n_points) {
  Eigen::SparseMatrix<double, Eigen::RowMajor> N(n_points, lattice.size());
  for (Eigen::Index i = 0, p = 0; i < lattice.size(); ++i)
    if (lattice.inside[static_cast<std::size_t>(i)]) N.insert(p++, i) = 1;
  N.makeCompressed();
  return N;
}

std::unique_ptr<ElasticModel> make_model(const Parameters& p, const Bonds& bonds, double volume) {
  if (p.particle.model == ParticleModel::pair) return std::make_unique<PairModel>(p.material, bonds, volume);
  return std::make_unique<TotalLagrangian>(p.material, bonds, volume, p.particle.hourglass);
}

std::string model_name(ParticleModel model) {
  return model == ParticleModel::pair ? "pair model" : "total Lagrangian";
}

}  // namespace

ParticleSolver::ParticleSolver(const Parameters& p)
    : parameters_(p),
      lattice_(make_lattice(p.plate, p.particle.spacing, p.particle.radius, p.particle.clamp)),
      bonds_(make_bonds(lattice_, p.particle.radius)),
      mass_(p.material.density * p.particle.spacing * p.particle.spacing),
      model_(make_model(p, bonds_, p.particle.spacing * p.particle.spacing)) {
  if (p.interface == "volume") {
    mesh_ = volume_mesh(lattice_, mass_);
    to_interface_ = volume_selection(lattice_, mesh_.position.cols());
  } else {
    mesh_ = surface(p);
    to_interface_ = interpolation(lattice_, mesh_.position);
  }
  const InterfaceMesh fine = outline(p.plate, p.particle.spacing);
  case_force_ = spread(interpolation(lattice_, fine.position), case_force(p.load, elastic_solid(p), fine));

  elastic_limit_ = elastic_limit(*model_, lattice_, mass_);
  largest_step_ = p.particle.safety * elastic_limit_;

  state_.displacement = Eigen::Matrix2Xd::Zero(2, lattice_.size());
  state_.velocity = p.velocity.head<2>().replicate(1, lattice_.size());
  state_.elastic_force = model_->force(state_.displacement);
  state_.interface_velocity = state_.window_velocity = interpolate(to_interface_, state_.velocity);
  saved_ = state_;
}

void ParticleSolver::set_velocity(const Eigen::Matrix2Xd& velocity) {
  for (Eigen::Index i = 0; i < lattice_.size(); ++i)
    if (!lattice_.fixed[static_cast<std::size_t>(i)]) state_.velocity.col(i) = velocity.col(i);
  state_.interface_velocity = state_.window_velocity = interpolate(to_interface_, state_.velocity);
  saved_ = state_;
}

void ParticleSolver::advance(double t, double dt, const Load& load) {
  const int n = std::max(1, static_cast<int>(std::ceil(dt / largest_step_ * (1 - 1e-12))));
  const double h = dt / n;
  const Points before = displacement();
  for (int k = 0; k < n; ++k) {
    const double middle = t + (k + 0.5) * h;
    state_.time = t + k * h;
    const Points fluid = load.mean(state_.time, t + (k + 1) * h, mesh_.position.cols());
    sub_step(h, external_force(middle, spread(to_interface_, fluid)));
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
void ParticleSolver::follow_interface(const Points& before, double dt) {
  if (mesh_.faces.cols() == 0) {  // volume coupling: the fluid places the particles themselves
    state_.interface_velocity = interpolate(to_interface_, state_.velocity);
    return;
  }
  const Points mean = (displacement() - before) / dt;
  const double last = state_.window > 0 ? state_.window : dt;
  state_.interface_velocity = mean + dt / (dt + last) * (mean - state_.window_velocity);
  state_.window_velocity = mean;
  state_.window = dt;
}

Eigen::Matrix2Xd ParticleSolver::external_force(double time, const Eigen::Matrix2Xd& fluid) const {
  const Eigen::Vector2d weight =
      mass_ * ramp_factor(time, parameters_.gravity_ramp) * parameters_.gravity.head<2>();
  return (fluid + ramp_factor(time, parameters_.load.ramp) * case_force_).colwise() + weight;
}

// Leapfrog (velocity Verlet), second order and symplectic; external force held over the step, c
// mass-proportional damping of the motion relative to the supports:
//   v_½ = v + ½h (f(u)/m + a),  u⁺ = u + h v_½,  v⁺ = v_½ + ½h (f(u⁺)/m + a)
// The work of the loads is f_ext·(u⁺ − u). A support moves with constant velocity: its force is −(f + f_ext),
// its work added to that of the loads leaves −½(f(u) + f(u⁺))·(u⁺ − u).
void ParticleSolver::sub_step(double h, const Eigen::Matrix2Xd& external) {
  const Eigen::Vector2d V = parameters_.velocity.head<2>();
  const double c = parameters_.damping.mass;
  const Eigen::Index n = lattice_.size();
  Eigen::Matrix2Xd moved(2, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (lattice_.fixed[static_cast<std::size_t>(i)]) {
      moved.col(i) = V * (state_.time + h) - state_.displacement.col(i);
    } else {
      const Eigen::Vector2d a = (state_.elastic_force.col(i) + external.col(i)) / mass_;
      state_.velocity.col(i) += 0.5 * h * (a - c * (state_.velocity.col(i) - V));
      moved.col(i) = h * state_.velocity.col(i);
    }
  }
  state_.displacement += moved;
  const Eigen::Matrix2Xd before = std::move(state_.elastic_force);
  state_.elastic_force = model_->force(state_.displacement);
  double work = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (lattice_.fixed[static_cast<std::size_t>(i)]) {
      work -= 0.5 * (before.col(i) + state_.elastic_force.col(i)).dot(moved.col(i));
    } else {
      work += (external.col(i) - c * mass_ * (state_.velocity.col(i) - V)).dot(moved.col(i));
      const Eigen::Vector2d a = (state_.elastic_force.col(i) + external.col(i)) / mass_;
      state_.velocity.col(i) = V + (state_.velocity.col(i) - V + 0.5 * h * a) / (1 + 0.5 * h * c);
    }
  }
  state_.external_work += work;
  ++state_.steps;
}

Points ParticleSolver::displacement() const {
  return interpolate(to_interface_, state_.displacement);
}

Points ParticleSolver::velocity() const {
  return state_.interface_velocity;
}

Eigen::Vector3d ParticleSolver::displacement_at(const Eigen::Vector3d& X) const {
  return interpolate(interpolation(lattice_, X), state_.displacement);
}

Eigen::Vector3d ParticleSolver::velocity_at(const Eigen::Vector3d& X) const {
  return interpolate(interpolation(lattice_, X), state_.velocity);
}

Energy ParticleSolver::energy() const {
  Energy energy;
  for (Eigen::Index i = 0; i < lattice_.size(); ++i)
    if (lattice_.inside[static_cast<std::size_t>(i)])
      energy.kinetic += 0.5 * mass_ * state_.velocity.col(i).squaredNorm();
  energy.strain = model_->energy(state_.displacement);
  energy.external = state_.external_work;
  return energy;
}

void ParticleSolver::solve_static() {
  const Eigen::Matrix2Xd weight = (mass_ * parameters_.gravity.head<2>()).replicate(1, lattice_.size());
  state_.displacement = equilibrium(*model_, lattice_, case_force_ + weight);
  state_.velocity.setZero();
  state_.interface_velocity.setZero();
  state_.elastic_force = model_->force(state_.displacement);
}

std::vector<double> ParticleSolver::frequencies(int count) {
  const double scale =
      beam_frequencies(parameters_.plate, parameters_.material, BeamTheory::euler_bernoulli, 1).at(0);
  return natural_frequencies(*model_, lattice_, mass_, scale, count);
}

void ParticleSolver::write(Archive& archive) const {
  archive.real["particle.displacement"] = saved_.displacement;
  archive.real["particle.velocity"] = saved_.velocity;
  archive.real["particle.interface_velocity"] = saved_.interface_velocity;
  archive.real["particle.window_velocity"] = saved_.window_velocity;
  archive.real["particle.scalars"] = Eigen::Vector3d(saved_.time, saved_.external_work, saved_.window);
  archive.integer["particle.steps"] = {saved_.steps};
}

void ParticleSolver::read(const Archive& archive) {
  const auto& u = archive.real.at("particle.displacement");
  if (u.rows() != 2 || u.cols() != lattice_.size())
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
  state_.elastic_force = model_->force(state_.displacement);
  saved_ = state_;
}

//   Cauchy stress σ = P Fᵀ / det F, von Mises in plane strain with σ_zz = λ/(2(λ+μ)) (σ_xx + σ_yy) = ν (σ_xx
//   + σ_yy)
Frame ParticleSolver::frame() const {
  const Eigen::Matrix4Xd H = displacement_gradient(bonds_, state_.displacement);
  Eigen::MatrixXd stress(3, lattice_.size()), mises(1, lattice_.size());
  for (Eigen::Index i = 0; i < lattice_.size(); ++i) {
    const Eigen::Matrix2d F =
        Eigen::Matrix2d::Identity() + Eigen::Map<const Eigen::Matrix2d>(H.col(i).data());
    const Eigen::Matrix2d P = first_piola_kirchhoff<2>(parameters_.material, F);
    const Eigen::Matrix2d s = P * F.transpose() / F.determinant();
    const double zz = parameters_.material.poisson * s.trace();
    stress.col(i) << s(0, 0), s(1, 1), s(0, 1);
    mises(0, i) = std::sqrt(
        0.5 * (std::pow(s(0, 0) - s(1, 1), 2) + std::pow(s(1, 1) - zz, 2) + std::pow(zz - s(0, 0), 2)) +
        3 * s(0, 1) * s(0, 1));
  }
  Frame frame;
  frame.time = state_.time;
  frame.position = in_space(lattice_.position + state_.displacement);
  frame.point_data = {{"displacement", "m", in_space(state_.displacement)},
                      {"velocity", "m/s", in_space(state_.velocity)},
                      {"stress", "Pa", stress},
                      {"von_mises", "Pa", mises}};
  return frame;
}

std::vector<std::string> ParticleSolver::lines() const {
  const auto inside = std::count(lattice_.inside.begin(), lattice_.inside.end(), 1);
  const double c = wave_speed(parameters_.material);
  return {
      fmt::format("particle ({})   {} layers, {} particles (+ {} in the clamps)   spacing {:.4g} mm",
                  model_name(parameters_.particle.model), lattice_.layers, inside, lattice_.size() - inside,
                  1e3 * lattice_.spacing),
      fmt::format("mass {:.4g} kg/m   {}", mass_ * static_cast<double>(inside),
                  beam_line(parameters_.plate, parameters_.material)),
      fmt::format("elastic limit {:.4g} s = {:.3f} spacing / c_P (c_P {:.0f} m/s), sub-step at most {:.4g} s",
                  elastic_limit_, elastic_limit_ * c / lattice_.spacing, c, largest_step_)};
}

}  // namespace strake::structure
