#include "fluid/turbulence.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "fluid/number_density.hpp"
#include "fluid/viscosity.hpp"

namespace strake::fluid {
namespace {

using std::size_t;

/// With fewer neighbours than this a particle is spray: its velocity gradient means nothing (PHYSICS §1).
constexpr int fewest_neighbours = 4;
constexpr double van_driest_a = 26;  // A⁺

/// 1 − exp(−y⁺/26), y⁺ = y u_τ/ν, with the friction velocity from the local shear, u_τ² = ν |S|.
double van_driest(double distance, double rate, double kinematic_viscosity) {
  if (kinematic_viscosity <= 0) return 1;
  const double y_plus = std::max(distance, 0.0) * std::sqrt(rate / kinematic_viscosity);
  return 1 - std::exp(-y_plus / van_driest_a);
}

/// Distance to the floor and the sides of the tank [m].
template <int dim>
Eigen::VectorXd distance_to_tank(const Vectors<dim>& position, const Box& tank) {
  Eigen::VectorXd distance = position.row(1).transpose().array() - tank.min[1];
  for (int d = 0; d < dim; ++d) {
    if (d == 1) continue;
    distance = distance.array()
                   .min(position.row(d).transpose().array() - tank.min[d])
                   .min(tank.max[d] - position.row(d).transpose().array());
  }
  return distance;
}

}  // namespace

double SpsModel::cs() const {
  return std::pow(c_nu * c_nu * c_nu / c_eps, 0.25);
}

// Pr = 2 S_lm S_lm, S = ½(∇u + ∇uᵀ). In the plane this is 2[(∂u/∂x)² + (∂v/∂y)²] + (∂u/∂y + ∂v/∂x)².
template <int dim>
double production(const Tensor<dim>& velocity_gradient) {
  const Tensor<dim> strain_rate = 0.5 * (velocity_gradient + velocity_gradient.transpose());
  return 2 * strain_rate.squaredNorm();
}

// k = (C_ν/C_ε) Δ² Pr and ν_t = (C_s Δ)² Pr^½ follow from production = dissipation. Damping acts on the
// length C_s Δ, so on ν_t with its square.
template <int dim>
SpsFields sps_fields(std::span<const Tensor<dim>> velocity_gradient, std::span<const std::int32_t> counts,
                     const SpsModel& model, const Eigen::VectorXd& wall_distance, const Masks& masks) {
  assert(counts.size() == velocity_gradient.size());
  assert(!model.wall_damping || wall_distance.size() == static_cast<Eigen::Index>(counts.size()));
  const auto n = static_cast<Eigen::Index>(velocity_gradient.size());
  const double mixing = model.cs() * model.filter;
  SpsFields fields{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto p = static_cast<size_t>(i);
    if ((!masks.row.empty() && !masks.row[p]) || counts[p] < fewest_neighbours) continue;
    const double pr = production<dim>(velocity_gradient[p]), rate = std::sqrt(pr);
    double length = mixing;
    if (model.wall_damping) length *= van_driest(wall_distance[i], rate, model.kinematic_viscosity);
    fields.production[i] = pr;
    fields.k[i] = model.c_nu / model.c_eps * model.filter * model.filter * pr;
    fields.eddy_viscosity[i] = length * length * rate;
  }
  return fields;
}

// F_sps = ∇·τ, τ_lm = 2 ν_t S_lm − (2/3) k δ_lm (6), (9).
template <int dim>
Vectors<dim> sps_acceleration(const Vectors<dim>& position, std::span<const Tensor<dim>> velocity_gradient,
                              const SpsFields& fields, const Neighbours& rows,
                              const LatticeConstants& gradient_lattice, const Masks& masks) {
  std::vector<Tensor<dim>> tau(velocity_gradient.size());
  for (size_t i = 0; i < tau.size(); ++i) {
    const auto p = static_cast<Eigen::Index>(i);
    tau[i] = fields.eddy_viscosity[p] * (velocity_gradient[i] + velocity_gradient[i].transpose()) -
             (2.0 / 3.0 * fields.k[p]) * Tensor<dim>::Identity();
  }
  return stress_divergence<dim>(position, tau, rows, gradient_lattice, masks);
}

// ∇·(2(ν+ν_t) S) = Σ ν_ij … + (∇u)ᵀ·∇ν_t for ∇·u = 0; gradients of ν_t and k by differences, (19) with φ̂_i =
// φ_i.
template <int dim>
Vectors<dim> sps_acceleration_laplacian(const Vectors<dim>& position, const Vectors<dim>& velocity,
                                        std::span<const Tensor<dim>> velocity_gradient,
                                        const SpsFields& fields, const SpsModel& model,
                                        const Neighbours& rows, const LatticeConstants& gradient_lattice,
                                        const LatticeConstants& laplacian_lattice, const Masks& masks) {
  Vectors<dim> acceleration = viscous_acceleration<dim>(
      velocity, rows, laplacian_lattice, model.kinematic_viscosity, fields.eddy_viscosity, masks);
  const std::vector<Tensor<dim>> plain(velocity_gradient.size(), Tensor<dim>::Identity());
  const auto slope =
      gradient_corrected<dim>(position, fields.eddy_viscosity, rows, gradient_lattice, plain, masks);
  const auto k_slope = gradient_corrected<dim>(position, fields.k, rows, gradient_lattice, plain, masks);
  for (Eigen::Index i = 0; i < acceleration.cols(); ++i)
    acceleration.col(i) +=
        velocity_gradient[static_cast<size_t>(i)].transpose() * slope.col(i) - 2.0 / 3.0 * k_slope.col(i);
  return acceleration;
}

template <int dim>
ViscousStage<dim> viscous_stage(const Vectors<dim>& position, const Vectors<dim>& velocity,
                                const Parameters& parameters, const Neighbours& near, const Neighbours& far,
                                const Masks& masks, const Eigen::VectorXd& wall_distance) {
  const auto& scheme = parameters.scheme;
  const double l0 = parameters.spacing, nu = parameters.kinematic_viscosity;
  const auto laplacian_lattice = lattice_constants<dim>(scheme.radius_laplacian, l0);
  ViscousStage<dim> stage;
  if (scheme.turbulence == Turbulence::none) {
    stage.acceleration = viscous_acceleration<dim>(velocity, far, laplacian_lattice, nu, masks);
    return stage;
  }
  assert(scheme.turbulence == Turbulence::statics);
  const auto gradient_lattice = lattice_constants<dim>(scheme.radius_gradient, l0);
  std::vector<Tensor<dim>> correction;
  if (scheme.gradient == Gradient::corrected)
    correction = gradient_correction<dim>(position, near, gradient_lattice, masks);
  const auto gradient = velocity_gradient<dim>(position, velocity, near, gradient_lattice, correction, masks);
  const SpsModel model{scheme.c_nu, scheme.c_eps, l0, nu, scheme.wall_damping};
  const bool needs_distance = model.wall_damping && wall_distance.size() == 0;
  stage.sps = sps_fields<dim>(
      gradient, neighbour_counts(near, gradient_lattice.radius), model,
      needs_distance ? distance_to_tank<dim>(position, parameters.tank) : wall_distance, masks);
  if (scheme.sps == SpsForm::laplacian) {
    stage.acceleration = sps_acceleration_laplacian<dim>(position, velocity, gradient, stage.sps, model, far,
                                                         gradient_lattice, laplacian_lattice, masks);
  } else {
    stage.acceleration = viscous_acceleration<dim>(velocity, far, laplacian_lattice, nu, masks);
    stage.acceleration += sps_acceleration<dim>(position, gradient, stage.sps, near, gradient_lattice, masks);
  }
  return stage;
}

template double production<2>(const Tensor<2>&);
template double production<3>(const Tensor<3>&);
template SpsFields sps_fields<2>(std::span<const Tensor<2>>, std::span<const std::int32_t>, const SpsModel&,
                                 const Eigen::VectorXd&, const Masks&);
template SpsFields sps_fields<3>(std::span<const Tensor<3>>, std::span<const std::int32_t>, const SpsModel&,
                                 const Eigen::VectorXd&, const Masks&);
template Vectors<2> sps_acceleration<2>(const Vectors<2>&, std::span<const Tensor<2>>, const SpsFields&,
                                        const Neighbours&, const LatticeConstants&, const Masks&);
template Vectors<3> sps_acceleration<3>(const Vectors<3>&, std::span<const Tensor<3>>, const SpsFields&,
                                        const Neighbours&, const LatticeConstants&, const Masks&);
template Vectors<2> sps_acceleration_laplacian<2>(const Vectors<2>&, const Vectors<2>&,
                                                  std::span<const Tensor<2>>, const SpsFields&,
                                                  const SpsModel&, const Neighbours&, const LatticeConstants&,
                                                  const LatticeConstants&, const Masks&);
template Vectors<3> sps_acceleration_laplacian<3>(const Vectors<3>&, const Vectors<3>&,
                                                  std::span<const Tensor<3>>, const SpsFields&,
                                                  const SpsModel&, const Neighbours&, const LatticeConstants&,
                                                  const LatticeConstants&, const Masks&);
template ViscousStage<2> viscous_stage<2>(const Vectors<2>&, const Vectors<2>&, const Parameters&,
                                          const Neighbours&, const Neighbours&, const Masks&,
                                          const Eigen::VectorXd&);
template ViscousStage<3> viscous_stage<3>(const Vectors<3>&, const Vectors<3>&, const Parameters&,
                                          const Neighbours&, const Neighbours&, const Masks&,
                                          const Eigen::VectorXd&);

}  // namespace strake::fluid
