#include "proto/error.hpp"
#include "structure/body/beam.hpp"
#include "structure/material/material.hpp"
#include "structure/particle/solver.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>

// Output of a particle solver: checkpoints, frames, the lines of a run, columns of its own.

namespace strake::structure {
namespace {

std::string model_name(const ParticleKeys& keys) {
  if (keys.model == ParticleModel::total_lagrangian) return "total Lagrangian";
  return keys.rotation == Rotation::dynamic
             ? "pair model, rotation dynamic: angular momentum exact"
             : "pair model, rotation of the neighbourhood: angular momentum for small strains only";
}

/// Cauchy's stress of a displacement gradient H = F − 1, times the share that is intact:
///   σ = P Fᵀ / det F; across the plane stress_across
template <int dim>
Stress cauchy_of(const Material& material, const Eigen::Matrix<double, dim, dim>& H, double integrity) {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  const Matrix F = Matrix::Identity() + H;
  const Matrix s = integrity * first_piola_kirchhoff<dim>(material, F) * F.transpose() / F.determinant();
  Stress stress;
  if constexpr (dim == 2)
    stress << s(0, 0), s(0, 1), 0, s(1, 1), 0, stress_across(material, F, s.trace(), integrity);
  else
    stress << s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2);
  return stress;
}

}  // namespace

template <int dim>
void ParticleSolver<dim>::write(Archive& archive) const {
  archive.real["particle.displacement"] = saved_.displacement;
  archive.real["particle.velocity"] = saved_.velocity;
  archive.real["particle.interface_velocity"] = saved_.interface_velocity;
  archive.real["particle.window_velocity"] = saved_.window_velocity;
  archive.real["particle.scalars"] = Eigen::Vector3d(saved_.time, saved_.external_work, saved_.window);
  Eigen::Matrix<double, 3, 4> frame;
  frame << saved_.frame.displacement, saved_.frame.velocity, saved_.frame.acceleration, saved_.reaction;
  archive.real["particle.frame"] = frame;
  archive.integer["particle.steps"] = {saved_.steps};
  if (failure_) {
    const auto& damage = saved_.failure;
    archive.integer["particle.broken"] = {damage.broken.begin(), damage.broken.end()};
    archive.integer["particle.bonds"] = {damage.bonds};
    archive.real["particle.released"] = Eigen::MatrixXd::Constant(1, 1, damage.released);
    archive.real["particle.failure"] = damage.record.table();
    if (damage.peak.size() > 0) {
      archive.real["particle.onset"] = damage.onset;
      archive.real["particle.peak"] = damage.peak;
    }
  }
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
  const auto& frame = archive.real.at("particle.frame");
  state_.frame = {.displacement = frame.col(0), .velocity = frame.col(1), .acceleration = frame.col(2)};
  const FrameState told = frame_.prescribed(state_.time);
  state_.frame.angle = told.angle;
  state_.frame.angular_velocity = told.angular_velocity;
  state_.reaction = frame.col(3);
  state_.interface_velocity = archive.real.at("particle.interface_velocity");
  state_.window_velocity = archive.real.at("particle.window_velocity");
  state_.steps = static_cast<int>(archive.integer.at("particle.steps").at(0));
  if (failure_) {
    auto& damage = state_.failure;
    const auto& broken = archive.integer.at("particle.broken");
    damage.broken.assign(broken.begin(), broken.end());
    damage.bonds = archive.integer.at("particle.bonds").at(0);
    damage.released = archive.real.at("particle.released")(0);
    damage.record = FailureRecord::from(archive.real.at("particle.failure"));
    if (damage.peak.size() > 0) {
      damage.onset = archive.real.at("particle.onset");
      damage.peak = archive.real.at("particle.peak");
    }
    failure_->apply(damage);
  }
  if (model_->spins()) {
    state_.turn = archive.real.at("particle.turn");
    state_.spin = archive.real.at("particle.spin");
  }
  find_elastic_force();
  saved_ = state_;
}

template <int dim>
Eigen::MatrixXd ParticleSolver<dim>::cauchy_stress() const {
  const Tensors<dim> H = displacement_gradient<dim>(bonds_, state_.displacement);
  Eigen::MatrixXd stress(6, lattice_.size());
  for (Eigen::Index i = 0; i < lattice_.size(); ++i)
    stress.col(i) = cauchy_of<dim>(lattice_.material(i),
                                   Eigen::Map<const Eigen::Matrix<double, dim, dim>>(H.col(i).data()),
                                   bonds_.integrity[i]);
  return stress;
}

template <int dim>
Stress ParticleSolver<dim>::stress_at(const Eigen::Vector3d& X) const {
  const Eigen::MatrixXd stress = cauchy_stress();
  // Where bonds may break, few are left on all sides of the particles.
  if (!failure_)
    if (const auto weight = extrapolation<dim>(lattice_, bonds_, X)) return stress * *weight;
  return stress * interpolation<dim>(lattice_, X).transpose();
}

template <int dim>
Frame ParticleSolver<dim>::frame() const {
  const Eigen::MatrixXd stress = cauchy_stress();
  Frame frame;
  frame.time = state_.time;
  frame.position = in_space<dim>(lattice_.position + state_.displacement);
  frame.point_data = {{"displacement", "m", in_space<dim>(state_.displacement)},
                      {"velocity", "m/s", in_space<dim>(state_.velocity)},
                      {"stress", "Pa", stress},
                      {"von_mises", "Pa", von_mises_of(stress)}};
  if (failure_) frame.point_data.push_back({"damage", "1", failure_->damage(state_.failure)});
  return frame;
}

template <int dim>
Properties ParticleSolver<dim>::properties() {
  const MassProperties body = mass_of(lattice_);
  Properties result;
  result.mass = body.mass;
  result.centre = body.centre;
  result.inertia = body.inertia(2, 2);
  result.frequencies = frequencies(3);
  result.step = fmt::format("{:.3g} s", elastic_limit_);
  return result;
}

template <int dim>
std::vector<std::string> ParticleSolver<dim>::lines() const {
  const Eigen::Index inside = lattice_.count_inside();
  double fastest = 0, mass = 0;
  for (Eigen::Index i = 0; i < lattice_.size(); ++i) {
    fastest = std::max(fastest, wave_speed(lattice_.material(i)));
    if (lattice_.inside[static_cast<std::size_t>(i)]) mass += mass_[i];
  }
  const bool plate = parameters_.shape.kind == ShapeKind::plate && dim == 2;
  std::vector<std::string> lines = {
      fmt::format("particle ({})   {} layers, {} particles (+ {} in the clamps)   spacing {:.4g} mm",
                  model_name(parameters_.particle), lattice_.layers, inside, lattice_.size() - inside,
                  1e3 * lattice_.spacing),
      // The pair model has a law of its own.
      (parameters_.particle.model == ParticleModel::pair ? "" : material_law(lattice_.parts) + "   ") +
          fmt::format("mass {:.4g} {}", mass, dim == 2 ? "kg/m" : "kg") +
          (plate ? "   " + beam_line(parameters_.plate, parameters_.material) : std::string()),
      fmt::format("elastic limit {:.4g} s = {:.3f} spacing / c_P (c_P {:.0f} m/s), sub-step at most {:.4g} s",
                  elastic_limit_, elastic_limit_ * fastest / lattice_.spacing, fastest, largest_step_)};
  if (std::string line = frame_line(frame_, dim); !line.empty()) lines.push_back(std::move(line));
  if (failure_)
    for (std::string& line : failure_->lines(mesh_.faces.cols() > 0)) lines.push_back(std::move(line));
  return lines;
}

template <int dim>
std::vector<Column> ParticleSolver<dim>::columns() const {
  std::vector<Column> columns = frame_columns(frame_, dim);
  if (failure_)
    for (const Column& column :
         {Column{"failure.energy", "J"}, Column{"failure.bonds", "1"}, Column{"failure.damage", "1"}})
      columns.push_back(column);
  return columns;
}

template <int dim>
std::map<std::string, double> ParticleSolver<dim>::monitor() const {
  std::map<std::string, double> monitor = frame_monitor(frame_, dim, state_.frame, state_.reaction);
  if (failure_) {
    monitor["failure.energy"] = state_.failure.released;
    monitor["failure.bonds"] = static_cast<double>(state_.failure.bonds);
    monitor["failure.damage"] = failure_->damage(state_.failure).maxCoeff();
    state_.failure.record.report(monitor);
  }
  return monitor;
}

template void ParticleSolver<2>::write(Archive&) const;
template void ParticleSolver<3>::write(Archive&) const;
template void ParticleSolver<2>::read(const Archive&);
template void ParticleSolver<3>::read(const Archive&);
template Eigen::MatrixXd ParticleSolver<2>::cauchy_stress() const;
template Stress ParticleSolver<2>::stress_at(const Eigen::Vector3d&) const;
template Frame ParticleSolver<2>::frame() const;
template Eigen::MatrixXd ParticleSolver<3>::cauchy_stress() const;
template Stress ParticleSolver<3>::stress_at(const Eigen::Vector3d&) const;
template Frame ParticleSolver<3>::frame() const;
template Properties ParticleSolver<2>::properties();
template Properties ParticleSolver<3>::properties();
template std::vector<std::string> ParticleSolver<2>::lines() const;
template std::vector<std::string> ParticleSolver<3>::lines() const;
template std::vector<Column> ParticleSolver<2>::columns() const;
template std::vector<Column> ParticleSolver<3>::columns() const;
template std::map<std::string, double> ParticleSolver<2>::monitor() const;
template std::map<std::string, double> ParticleSolver<3>::monitor() const;

}  // namespace strake::structure
