#include "fluid/viscous_stage.hpp"

#include <Eigen/Eigenvalues>

#include <cassert>
#include <cmath>

#include "fluid/number_density.hpp"
#include "fluid/viscosity.hpp"

namespace strake::fluid {
namespace {

using std::size_t;

/// A neighbourhood this flat or this small has no gradient, as in `gradient_correction`.
constexpr double smallest_determinant = 0.05, largest_condition = 20;

/// Place of (a, b) among the components of a symmetric tensor, row by row of its upper half.
template <int dim>
constexpr int at(int a, int b) {
  if (a > b) return at<dim>(b, a);
  return dim == 2 ? a + b : (a == 0 ? b : a + b + 1);
}

/// Whether λ_max/λ_min ≤ c. In the plane (λ1 + λ2)²/(λ1 λ2) = c + 2 + 1/c where the condition is c; in space
/// λ_min ≥ 4 det/tr² and λ_max ≤ tr accept what is far from the limit without its eigenvalues.
template <int dim>
bool well_conditioned(const Tensor<dim>& moment, double determinant) {
  constexpr double c = largest_condition;
  const double trace = moment.trace();
  if constexpr (dim == 2) return trace * trace <= determinant * (1 + c) * (1 + c) / c;
  if (trace * trace * trace <= 4 * c * determinant) return true;
  Eigen::SelfAdjointEigenSolver<Tensor<dim>> spectrum;
  spectrum.computeDirect(moment, Eigen::EigenvaluesOnly);
  const auto& values = spectrum.eigenvalues();
  return values[0] > 0 && values[dim - 1] <= c * values[0];
}

}  // namespace

template <int dim>
void ViscousStage<dim>::compute(const Parameters& parameters, const ViscousFlow<dim>& flow, double dt,
                                Eigen::VectorXd& k) {
  const Scheme& scheme = parameters.scheme;
  const auto n = flow.position.cols();
  assert(k.size() == n && flow.walls.first + flow.walls.size() == n);
  acceleration.setZero(dim, n);
  production.setZero(n);
  eddy_viscosity.setZero(n);
  if (scheme.turbulence == Turbulence::none) {
    k.setZero();
    if (parameters.kinematic_viscosity == 0) return;
  }
  if (scheme.sps == SpsForm::joint) {
    const auto lattice = lattice_constants<dim>(scheme.radius_gradient, parameters.spacing);
    behind_.extend(flow.position, flow.velocity, flow.near, lattice.radius, flow.walls, flow.wet);
    gather_gradient(flow, lattice);
    close(parameters, flow, lattice, dt, k);
    gather_force(scheme.gradient == Gradient::corrected, flow, lattice);
  } else {
    separate(parameters, flow, dt, k);
  }
}

// G = (d/n0) Σ (u_j − u_i)⊗r_ij w/r² · C_i, C_i = [(d/n0) Σ r⊗r w/r²]⁻¹ of the same neighbours.
template <int dim>
void ViscousStage<dim>::gather_gradient(const ViscousFlow<dim>& flow, const LatticeConstants& lattice) {
  const auto n = flow.position.cols();
  const std::int64_t water = flow.walls.first;
  sample_.resize(static_cast<size_t>(n));
  stress_.resize(static_cast<size_t>(water));
  correction_.resize(static_cast<size_t>(water));
  neighbours_.resize(static_cast<size_t>(water));
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i)
    for (int a = 0; a < dim; ++a) {
      sample_[static_cast<size_t>(i)].x[a] = flow.position(a, i);
      sample_[static_cast<size_t>(i)].u[a] = i < water ? flow.velocity(a, i) : behind_.velocity(a, i - water);
    }
  const double scale = dim / lattice.n0;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    const Sample here = sample_[static_cast<size_t>(i)];
    const auto columns = flow.near.row(i);
    const auto inverses = flow.near.inverses(i);
    double sum[dim * dim]{}, moment[components]{};
    int count = 0;
    for (size_t e = 0; e < columns.size(); ++e) {
      const std::int32_t j = columns[e];
      const double w = lattice.radius * inverses[e] - 1;
      if (w <= 0 || (j >= water && flow.dry(j))) continue;
      const Sample& there = sample_[static_cast<size_t>(j)];
      const double s = w * inverses[e] * inverses[e];
      for (int b = 0; b < dim; ++b) {
        const double r = there.x[b] - here.x[b], sr = s * r;
        for (int a = 0; a < dim; ++a) sum[a * dim + b] += (there.u[a] - here.u[a]) * sr;
        for (int a = 0; a <= b; ++a) moment[at<dim>(a, b)] += (there.x[a] - here.x[a]) * sr;
      }
      ++count;
    }
    Tensor<dim> m, g;
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) {
        m(a, b) = scale * moment[at<dim>(a, b)];
        g(a, b) = scale * sum[a * dim + b];
      }
    const double determinant = m.determinant();
    Stress& stress = stress_[static_cast<size_t>(i)];
    neighbours_[static_cast<size_t>(i)] = count;
    if (determinant < smallest_determinant || !well_conditioned<dim>(m, determinant)) {
      stress = {};
      neighbours_[static_cast<size_t>(i)] = -1;
      continue;
    }
    const Tensor<dim> inverse = m.inverse(), corrected = g * inverse;
    double pr = 0;  // 2 S:S = ½ Σ (∂u_a/∂x_b + ∂u_b/∂x_a)²
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) {
        stress.g[a * dim + b] = corrected(a, b);
        pr += 0.5 * (corrected(a, b) + corrected(b, a)) * (corrected(a, b) + corrected(b, a));
        if (a <= b) correction_[static_cast<size_t>(i)].c[at<dim>(a, b)] = inverse(a, b);
      }
    production[i] = pr;
  }
}

// ν_t and k by the model, τ = (ν + ν_t)(G + Gᵀ) − (2/3) k I.
template <int dim>
void ViscousStage<dim>::close(const Parameters& parameters, const ViscousFlow<dim>& flow,
                              const LatticeConstants& lattice, double dt, Eigen::VectorXd& k) {
  const std::int64_t water = flow.walls.first;
  const SpsModel model = sps_model(parameters);
  const Turbulence kind = parameters.scheme.turbulence;
  if (kind == Turbulence::k) {
    for (std::int64_t i = 0; i < water; ++i) eddy_viscosity[i] = model.eddy_viscosity(k[i]);
    advance_k<dim>(flow, model, lattice, production, eddy_viscosity, dt, k, scratch_);
  }
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    Stress& stress = stress_[static_cast<size_t>(i)];
    double energy = 0;
    if (kind != Turbulence::none) {
      if (kind == Turbulence::statics) k[i] = model.equilibrium(production[i]);
      energy = k[i];
      eddy_viscosity[i] =
          neighbours_[static_cast<size_t>(i)] < fewest_neighbours ? 0 : model.eddy_viscosity(energy);
      if (model.wall_damping)
        eddy_viscosity[i] *= model.damping(flow.wall_distance[static_cast<size_t>(i)], production[i]);
    }
    stress.viscosity = model.kinematic_viscosity + eddy_viscosity[i];
    for (int a = 0; a < dim; ++a)
      for (int b = a; b < dim; ++b)
        stress.tau[at<dim>(a, b)] = stress.viscosity * (stress.g[a * dim + b] + stress.g[b * dim + a]) -
                                    (a == b ? 2.0 / 3.0 * energy : 0.0);
  }
}

template <int dim>
void ViscousStage<dim>::gather_force(bool corrected, const ViscousFlow<dim>& flow,
                                     const LatticeConstants& lattice) {
  const auto n = flow.position.cols();
  const std::int64_t water = flow.walls.first;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    if (i >= water)
      acceleration.col(i) = force_on_row(i, flow, lattice);
    else if (corrected && neighbours_[static_cast<size_t>(i)] > 0 &&
             (flow.surface.empty() || !flow.surface[static_cast<size_t>(i)]))
      acceleration.col(i) = force_on_water<true>(i, flow, lattice);
    else
      acceleration.col(i) = force_on_water<false>(i, flow, lattice);
  }
}

/// τ·r w/r² and the Laplacian's remainder of one pair, u and G as the pair reads them.
template <int dim>
template <bool corrected>
Vector<dim> ViscousStage<dim>::force_on_water(std::int64_t i, const ViscousFlow<dim>& flow,
                                              const LatticeConstants& lattice) const {
  const std::int64_t water = flow.walls.first;
  const Sample here = sample_[static_cast<size_t>(i)];
  const Stress own = stress_[static_cast<size_t>(i)];
  const Symmetric* c = &correction_[static_cast<size_t>(i)];
  const double stress_scale = dim / lattice.n0, remainder_scale = 2 * dim / (lattice.n0 * lattice.lambda0);
  const auto columns = flow.near.row(i);
  const auto inverses = flow.near.inverses(i);
  double sum[dim]{};
  size_t e = 0;
  for (; e < columns.size() && columns[e] < water; ++e) {
    const double inverse = inverses[e], w = lattice.radius * inverse - 1;
    if (w <= 0) continue;
    const Sample& there = sample_[static_cast<size_t>(columns[e])];
    const Stress& other = stress_[static_cast<size_t>(columns[e])];
    const double s = stress_scale * w * inverse * inverse;
    const double v = 0.5 * remainder_scale * w * (own.viscosity + other.viscosity);
    double r[dim], arm[dim];
    for (int a = 0; a < dim; ++a) r[a] = there.x[a] - here.x[a];
    for (int a = 0; a < dim; ++a) {
      arm[a] = 0;
      if constexpr (corrected)
        for (int b = 0; b < dim; ++b) arm[a] += c->c[at<dim>(a, b)] * r[b];
      else
        arm[a] = r[a];
    }
    for (int a = 0; a < dim; ++a) {
      double push = 0, linear = 0;
      for (int b = 0; b < dim; ++b) {
        const double mine = own.tau[at<dim>(a, b)], its = other.tau[at<dim>(a, b)];
        push += (corrected ? its - mine : its + mine) * arm[b];
        linear += (own.g[a * dim + b] + other.g[a * dim + b]) * r[b];
      }
      sum[a] += s * push + v * (there.u[a] - here.u[a] - 0.5 * linear);
    }
  }
  Vector<dim> force;
  for (int a = 0; a < dim; ++a) force[a] = sum[a];
  for (; e < columns.size(); ++e) {
    const double w = lattice.radius * inverses[e] - 1;
    if (w > 0 && !flow.dry(columns[e]))
      force += pair_with_row<corrected>(i, columns[e], w, inverses[e], flow, lattice);
  }
  return force;
}

/// f of water i by row j. A corrected sum has no (τ_j − τ_i), and reads the flow that a smooth wall mirrors.
template <int dim>
template <bool corrected>
Vector<dim> ViscousStage<dim>::pair_with_row(std::int64_t i, std::int64_t j, double w, double inverse,
                                             const ViscousFlow<dim>& flow,
                                             const LatticeConstants& lattice) const {
  const Sample &here = sample_[static_cast<size_t>(i)], &there = sample_[static_cast<size_t>(j)];
  const Stress& own = stress_[static_cast<size_t>(i)];
  const double s = 2 * dim / lattice.n0 * w * inverse * inverse;
  const double v = 2 * dim / (lattice.n0 * lattice.lambda0) * w * own.viscosity;
  Vector<dim> force;
  for (int a = 0; a < dim; ++a) {
    double push = 0, linear = 0;
    for (int b = 0; b < dim; ++b) {
      const double r = there.x[b] - here.x[b];
      push += own.tau[at<dim>(a, b)] * r;
      linear += own.g[a * dim + b] * r;
    }
    force[a] = (corrected ? 0.0 : s * push) + v * (there.u[a] - here.u[a] - linear);
  }
  if (corrected || !flow.walls.slip[static_cast<size_t>(j - flow.walls.first)]) return force;
  const auto normal = flow.walls.normal.col(j - flow.walls.first);
  if (normal.squaredNorm() > 0) force = normal * normal.dot(force);
  return force;
}

template <int dim>
Vector<dim> ViscousStage<dim>::force_on_row(std::int64_t j, const ViscousFlow<dim>& flow,
                                            const LatticeConstants& lattice) const {
  Vector<dim> force = Vector<dim>::Zero();
  if (flow.dry(j)) return force;
  const auto columns = flow.near.row(j);
  const auto inverses = flow.near.inverses(j);
  for (size_t e = 0; e < columns.size() && columns[e] < flow.walls.first; ++e) {
    const double w = lattice.radius * inverses[e] - 1;
    if (w > 0) force -= pair_with_row<false>(columns[e], j, w, inverses[e], flow, lattice);
  }
  return force;
}

// Operator by operator, the walls' own velocity at their rows.
template <int dim>
void ViscousStage<dim>::separate(const Parameters& parameters, const ViscousFlow<dim>& flow, double dt,
                                 Eigen::VectorXd& k) {
  const Scheme& scheme = parameters.scheme;
  const double l0 = parameters.spacing, nu = parameters.kinematic_viscosity;
  // Smooth walls: their terms are dropped (PHYSICS §1).
  seen_.assign(static_cast<size_t>(flow.position.cols()), 1);
  for (std::int64_t i = flow.walls.first; i < flow.position.cols(); ++i)
    if (flow.dry(i) || flow.walls.slip[static_cast<size_t>(i - flow.walls.first)])
      seen_[static_cast<size_t>(i)] = 0;
  const Masks masks{seen_, seen_};
  const auto laplacian_lattice = lattice_constants<dim>(scheme.radius_laplacian, l0);
  if (scheme.turbulence == Turbulence::none) {
    acceleration = viscous_acceleration<dim>(flow.velocity, flow.far, laplacian_lattice, nu, masks);
    return;
  }
  const auto lattice = lattice_constants<dim>(scheme.radius_gradient, l0);
  std::vector<Tensor<dim>> correction;
  if (scheme.gradient == Gradient::corrected)
    correction = gradient_correction<dim>(flow.position, flow.near, lattice, masks);
  const auto gradient =
      velocity_gradient<dim>(flow.position, flow.velocity, flow.near, lattice, correction, masks);
  const SpsModel model = sps_model(parameters);
  const auto counts = neighbour_counts(flow.near, lattice.radius);
  SpsFields fields = sps_fields<dim>(gradient, counts, model, flow.wall_distance, masks);
  if (scheme.turbulence == Turbulence::k) {
    for (Eigen::Index i = 0; i < k.size(); ++i) fields.eddy_viscosity[i] = model.eddy_viscosity(k[i]);
    advance_k<dim>(flow, model, lattice, fields.production, fields.eddy_viscosity, dt, k, scratch_);
    fields.k = k;
    for (Eigen::Index i = 0; i < k.size(); ++i)
      fields.eddy_viscosity[i] =
          counts[static_cast<size_t>(i)] < fewest_neighbours ? 0 : model.eddy_viscosity(k[i]);
  }
  if (scheme.sps == SpsForm::laplacian) {
    acceleration = sps_acceleration_laplacian<dim>(flow.position, flow.velocity, gradient, fields, model,
                                                   flow.far, lattice, laplacian_lattice, masks);
  } else {
    acceleration = viscous_acceleration<dim>(flow.velocity, flow.far, laplacian_lattice, nu, masks) +
                   sps_acceleration<dim>(flow.position, gradient, fields, flow.near, lattice, masks);
  }
  k = fields.k;
  production = fields.production;
  eddy_viscosity = fields.eddy_viscosity;
}

template class ViscousStage<2>;
template class ViscousStage<3>;

}  // namespace strake::fluid
