#include "fluid/viscosity/turbulence.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace strake::fluid {
namespace {

using std::size_t;

constexpr double van_driest_a = 26;  // A⁺

}  // namespace

double SpsModel::cs() const {
  return std::pow(c_nu * c_nu * c_nu / c_eps, 0.25);
}

double SpsModel::damping(double distance, double production) const {
  if (kinematic_viscosity <= 0) return 1;
  const double y_plus = std::max(distance, 0.0) * std::sqrt(std::sqrt(production) / kinematic_viscosity);
  const double factor = 1 - std::exp(-y_plus / van_driest_a);
  return factor * factor;
}

SpsModel sps_model(const Parameters& p) {
  return {p.scheme.c_nu, p.scheme.c_eps, p.spacing, p.kinematic_viscosity, p.scheme.wall_damping};
}

double viscous_limit(const Parameters& p, double largest_k) {
  double viscosity = p.kinematic_viscosity;
  if (p.scheme.turbulence != Turbulence::none)
    viscosity += sps_model(p).eddy_viscosity(std::max(0.0, largest_k));
  return viscosity > 0 ? 0.125 * p.spacing * p.spacing / viscosity : std::numeric_limits<double>::infinity();
}

template <int dim>
void advance_k(const ViscousFlow<dim>& flow, const SpsModel& model, const LatticeConstants& lattice,
               const Eigen::VectorXd& production, const Eigen::VectorXd& eddy_viscosity, double dt,
               Eigen::VectorXd& k, Eigen::VectorXd& scratch) {
  const WallLayers<dim>& walls = flow.walls;
  const double scale = dt * 2 * dim / (lattice.n0 * lattice.lambda0);
  const double b = 0.5 * model.c_eps / model.filter * dt;
  scratch.setZero(k.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < walls.first; ++i) {
    const double q = std::sqrt(k[i]), a = 0.5 * model.c_nu * model.filter * production[i] * dt;
    const double grown = (q + a) / (1 + b * q);
    scratch[i] = grown * grown;
  }
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < walls.first; ++i) {
    if (!flow.ranks.owns(i)) continue;
    const auto columns = flow.near.row(i);
    const auto inverses = flow.near.inverses(i);
    double inflow = 0, share = 0;
    for (size_t e = 0; e < columns.size(); ++e) {
      const std::int64_t j = columns[e];
      const double w = lattice.radius * inverses[e] - 1;
      if (w <= 0) continue;
      if (j < walls.first) {
        const double flux =
            scale * w * (model.kinematic_viscosity + 0.5 * (eddy_viscosity[i] + eddy_viscosity[j]));
        inflow += flux * scratch[j];
        share += flux;
      } else if (!flow.dry(j) && !walls.slip[static_cast<size_t>(j - walls.first)]) {
        // k is continued on the line through zero at the face: k_j = −k_i depth/distance.
        const auto normal = walls.normal.col(j - walls.first);
        const double depth = walls.depth[j - walls.first];
        const Vector<dim> r = flow.periodic.separation(flow.position.col(j), flow.position.col(i));
        const double distance = r.dot(normal) - depth;
        const double reach = 1 + depth / std::max(distance, 0.25 * model.filter);
        share += scale * w * reach * (model.kinematic_viscosity + 0.5 * eddy_viscosity[i]);
      }
    }
    k[i] = (scratch[i] + inflow) / (1 + share);
  }
  flow.ranks.update(k);  // the force is the next sum that reads it
}

// Returns Pr = 2 S_lm S_lm, S = ½(∇u + ∇uᵀ). In the plane this is 2[(∂u/∂x)² + (∂v/∂y)²] + (∂u/∂y + ∂v/∂x)².
template <int dim>
double production(const Tensor<dim>& velocity_gradient) {
  const Tensor<dim> strain_rate = 0.5 * (velocity_gradient + velocity_gradient.transpose());
  return 2 * strain_rate.squaredNorm();
}

template <int dim>
SpsFields sps_fields(std::span<const Tensor<dim>> velocity_gradient, std::span<const std::int32_t> counts,
                     const SpsModel& model, std::span<const double> wall_distance, const Masks& masks) {
  assert(counts.size() == velocity_gradient.size());
  const auto n = static_cast<Eigen::Index>(velocity_gradient.size());
  SpsFields fields{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto p = static_cast<size_t>(i);
    if ((!masks.row.empty() && !masks.row[p]) || counts[p] < fewest_neighbours) continue;
    fields.production[i] = production<dim>(velocity_gradient[p]);
    fields.k[i] = model.equilibrium(fields.production[i]);
    fields.eddy_viscosity[i] = model.eddy_viscosity(fields.k[i]);
    if (model.wall_damping)
      fields.eddy_viscosity[i] *=
          model.damping(p < wall_distance.size() ? wall_distance[p] : 0, fields.production[i]);
  }
  return fields;
}

template <int dim>
void advance_fields(const ViscousFlow<dim>& flow, const SpsModel& model, const LatticeConstants& lattice,
                    std::span<const std::int32_t> counts, double dt, Eigen::VectorXd& k,
                    Eigen::VectorXd& scratch, SpsFields& fields) {
  const auto eddy_viscosity = [&](Eigen::Index i) {
    const auto at = static_cast<size_t>(i);
    const double eddy = model.eddy_viscosity(k[i]);
    if (!model.wall_damping || at >= flow.wall_distance.size()) return eddy;
    return eddy * model.damping(flow.wall_distance[at], fields.production[i]);
  };
  for (Eigen::Index i = 0; i < k.size(); ++i) fields.eddy_viscosity[i] = eddy_viscosity(i);
  advance_k<dim>(flow, model, lattice, fields.production, fields.eddy_viscosity, dt, k, scratch);
  fields.k = k;
  for (Eigen::Index i = 0; i < k.size(); ++i)
    fields.eddy_viscosity[i] = counts[static_cast<size_t>(i)] < fewest_neighbours ? 0 : eddy_viscosity(i);
}

// Computes ∇·τ, τ_lm = 2 ν_t S_lm − (2/3) k δ_lm (F3).
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

template double production<2>(const Tensor<2>&);
template double production<3>(const Tensor<3>&);
template SpsFields sps_fields<2>(std::span<const Tensor<2>>, std::span<const std::int32_t>, const SpsModel&,
                                 std::span<const double>, const Masks&);
template SpsFields sps_fields<3>(std::span<const Tensor<3>>, std::span<const std::int32_t>, const SpsModel&,
                                 std::span<const double>, const Masks&);
template void advance_fields<2>(const ViscousFlow<2>&, const SpsModel&, const LatticeConstants&,
                                std::span<const std::int32_t>, double, Eigen::VectorXd&, Eigen::VectorXd&,
                                SpsFields&);
template Vectors<2> sps_acceleration<2>(const Vectors<2>&, std::span<const Tensor<2>>, const SpsFields&,
                                        const Neighbours&, const LatticeConstants&, const Masks&);
template void advance_fields<3>(const ViscousFlow<3>&, const SpsModel&, const LatticeConstants&,
                                std::span<const std::int32_t>, double, Eigen::VectorXd&, Eigen::VectorXd&,
                                SpsFields&);
template Vectors<3> sps_acceleration<3>(const Vectors<3>&, std::span<const Tensor<3>>, const SpsFields&,
                                        const Neighbours&, const LatticeConstants&, const Masks&);
template void advance_k<2>(const ViscousFlow<2>&, const SpsModel&, const LatticeConstants&,
                           const Eigen::VectorXd&, const Eigen::VectorXd&, double, Eigen::VectorXd&,
                           Eigen::VectorXd&);
template void advance_k<3>(const ViscousFlow<3>&, const SpsModel&, const LatticeConstants&,
                           const Eigen::VectorXd&, const Eigen::VectorXd&, double, Eigen::VectorXd&,
                           Eigen::VectorXd&);

}  // namespace strake::fluid
