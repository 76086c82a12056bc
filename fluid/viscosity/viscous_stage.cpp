#include "fluid/viscosity/viscous_stage.hpp"

#include "fluid/mps/number_density.hpp"
#include "fluid/particles/pair_loop.hpp"
#include "fluid/viscosity/viscosity.hpp"

#include <Eigen/Eigenvalues>

#include <cassert>

namespace strake::fluid {
namespace {

/// Whether the pressure gradient is exact for linear fields, and momentum is not. The stresses then have that
/// form too.
bool consistent(const Scheme& scheme) {
  return scheme.gradient == Gradient::corrected || scheme.gradient == Gradient::least_squares;
}

using std::size_t;

/// Limits of a neighbourhood that has a gradient: smallest determinant and largest condition. The lattice's
/// corner has the determinant 0.25 in the plane and 0.04 in space.
template <int dim>
constexpr double smallest_determinant = dim == 2 ? 0.05 : 0.01;
constexpr double largest_condition = 20;

/// Calls body(j, 1/r, w) for the pairs within the radius.
template <class Body>
inline void each_pair(std::span<const std::int32_t> columns, const InverseRow& inverses, double radius,
                      Body&& body) {
  for (size_t e = 0; e < columns.size(); ++e)
    if (const double w = radius * inverses[e] - 1; w > 0) body(columns[e], inverses[e], w);
}

/// Rearranges the lanes {r, u} of a pair, in space {r, 0, u, 0}. `twice` repeats all of them; `arms` has r in
/// every place.
inline Double8 twice(const Double4& d) {
  return __builtin_shufflevector(d, d, 0, 1, 2, 3, 0, 1, 2, 3);
}
inline Double8 arms(const Double4& d) {
  return __builtin_shufflevector(d, d, 0, 1, 0, 1, 0, 1, 0, 1);
}
inline Double8 arms(const Double8& d) {
  return __builtin_shufflevector(d, d, 0, 1, 2, 3, 0, 1, 2, 3);
}

/// Whether λ_max/λ_min ≤ c. In the plane (λ1 + λ2)²/(λ1 λ2) = c + 2 + 1/c where the condition is c. In space
/// λ_min ≥ 4 det/tr² and λ_max ≤ tr accept tensors far from the limit without their eigenvalues.
template <int dim>
bool well_conditioned(const Tensor<dim>& moment, double determinant) {
  constexpr double c = largest_condition;
  const double trace = moment.trace();
  constexpr double least = (1 + c) * (1 + c) / c;
  if constexpr (dim == 2) return trace * trace <= determinant * least;
  if (trace * trace * trace <= 4 * c * determinant) return true;
  Eigen::SelfAdjointEigenSolver<Tensor<dim>> spectrum;
  spectrum.computeDirect(moment, Eigen::EigenvaluesOnly);
  const auto& values = spectrum.eigenvalues();
  return values[0] > 0 && values[dim - 1] <= c * values[0];
}

template <int dim>
inline void invert(const Tensor<dim>& m, double determinant, Tensor<dim>& inverse) {
  const double scale = 1 / determinant;
  if constexpr (dim == 2) {
    inverse(0, 0) = scale * m(1, 1);
    inverse(1, 0) = -scale * m(1, 0);
    inverse(0, 1) = -scale * m(0, 1);
    inverse(1, 1) = scale * m(0, 0);
  } else {
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) {
        const int p = (b + 1) % dim, q = (b + 2) % dim, r = (a + 1) % dim, t = (a + 2) % dim;
        inverse(a, b) = scale * (m(p, r) * m(q, t) - m(p, t) * m(q, r));
      }
  }
}

}  // namespace

template <int dim>
void ViscousStage<dim>::compute(const Parameters& parameters, const ViscousFlow<dim>& flow, double dt,
                                Eigen::VectorXd& k) {
  const Scheme& scheme = parameters.scheme;
  const auto n = flow.position.cols();
  assert(k.size() == n && flow.walls.first + flow.walls.size() == n);
  acceleration.setZero(dim, n);
  if (scheme.turbulence == Turbulence::none) {
    k.setZero();
    if (parameters.kinematic_viscosity == 0) return;
  }
  if (scheme.sps == SpsForm::joint) {
    const auto lattice = lattice_constants<dim>(scheme.radius_gradient, parameters.spacing);
    std::optional<WallLaw> law;
    if (scheme.turbulence != Turbulence::none)
      law = WallLaw{parameters.kinematic_viscosity, parameters.spacing};
    behind_.extend(flow, lattice.radius, law);
    model_ = sps_model(parameters);
    radius_ = lattice.radius;
    stress_scale_ = dim / lattice.n0;
    laplacian_scale_ = 2 * dim / (lattice.n0 * lattice.lambda0);
    kind_ = scheme.turbulence;
    if (kind_ == Turbulence::k) eddy_viscosity_.setZero(n);
    keeps_production_ = kind_ == Turbulence::k || flow.ranks.several();
    if (keeps_production_) production_.setZero(n);
    take_samples(flow);
    gather_gradient(flow, k);
    update_gradient(flow, k);
    if (kind_ == Turbulence::k) transport(flow, lattice, dt, k);
    gather_force(consistent(scheme), flow);
    behind_.add_friction(flow, lattice.radius, acceleration);
  } else {
    separate(parameters, flow, dt, k);
  }
}

/// Writes place and velocity of each particle side by side. Behind faces it writes the velocity that
/// continues the flow.
template <int dim>
void ViscousStage<dim>::take_samples(const ViscousFlow<dim>& flow) {
  const auto n = flow.position.cols();
  const std::int64_t water = flow.walls.first;
  sample_ = samples_.of<Sample>(static_cast<size_t>(n));
  stress_ = stresses_.of<Stress>(static_cast<size_t>(water));
  correction_.resize(static_cast<size_t>(water));
  viscosity_.resize(static_cast<size_t>(water));
  neighbours_.resize(static_cast<size_t>(water));
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const double* const place = flow.position.data() + dim * i;
    const double* const moves =
        i < water ? flow.velocity.data() + dim * i : behind_.velocity.data() + dim * (i - water);
    if constexpr (dim == 2)
      sample_[static_cast<size_t>(i)].lanes = Double4{place[0], place[1], moves[0], moves[1]};
    else
      sample_[static_cast<size_t>(i)].lanes =
          Double8{place[0], place[1], place[2], 0, moves[0], moves[1], moves[2], 0};
  }
}

// Computes G = (d/n0) Σ (u_j − u_i)⊗r_ij w/r² · C_i, C_i = [(d/n0) Σ r⊗r w/r²]⁻¹ of the same neighbours.
template <int dim>
void ViscousStage<dim>::gather_gradient(const ViscousFlow<dim>& flow, Eigen::VectorXd& k) {
  const std::int64_t water = flow.walls.first;
  const bool seams = flow.periodic.any();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (!flow.ranks.owns(i)) continue;
    const auto here = sample_[static_cast<size_t>(i)].lanes;
    const auto columns = flow.near.row(i);
    const auto inverses = flow.near.inverses(i);
    // Σ r_b {r, u} w/r²: moments and gradient, column by column; both columns in one in the plane.
    Double8 sum[dim == 2 ? 1 : dim]{};
    int count = 0;
    const auto add = [&](std::int32_t j, double inverse, double w) {
      auto d = sample_[static_cast<size_t>(j)].lanes - here;
      if (seams) over_seams<dim>(flow.periodic, d);
      const double s = w * inverse * inverse;
      if constexpr (dim == 2)
        sum[0] += twice(d) * halves(s * d[0], s * d[1]);
      else
        for (int b = 0; b < dim; ++b) sum[b] += d * (s * d[b]);
      ++count;
    };
    const size_t inner = water_pairs(columns, water);
    each_pair(columns.first(inner), inverses, radius_, add);
    each_pair(columns.subspan(inner), inverses.subspan(inner), radius_,
              [&](std::int32_t j, double inverse, double w) {
                if (!flow.dry(j)) add(j, inverse, w);
              });
    // Entry by entry, because a copy or product of whole tensors would stall on the numbers just written.
    Tensor<dim> m;
    double raw[dim][dim];
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) {
        m(a, b) = stress_scale_ * (dim == 2 ? sum[0][4 * b + a] : sum[dim == 2 ? 0 : b][a]);
        raw[a][b] = stress_scale_ * (dim == 2 ? sum[0][4 * b + 2 + a] : sum[dim == 2 ? 0 : b][4 + a]);
      }
    const double determinant = m.determinant();
    double pr = 0;
    neighbours_[static_cast<size_t>(i)] = -1;
    Tensor<dim> g;
    if (determinant >= smallest_determinant<dim> && well_conditioned<dim>(m, determinant)) {
      neighbours_[static_cast<size_t>(i)] = count;
      Tensor<dim>& correction = correction_[static_cast<size_t>(i)];
      invert<dim>(m, determinant, correction);
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) {
          double entry = raw[a][0] * correction(0, b);
          for (int c = 1; c < dim; ++c) entry += raw[a][c] * correction(c, b);
          g(a, b) = entry;
        }
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) pr += 0.5 * (g(a, b) + g(b, a)) * (g(a, b) + g(b, a));  // 2 S:S
    } else {
      g.setZero();
    }
    if (keeps_production_) production_[i] = pr;
    if (kind_ == Turbulence::statics) k[i] = model_.equilibrium(pr);
    close(i, g, k[i], pr, flow);
  }
}

// Computes ν_t by the model from its energy, and τ = (ν + ν_t)(G + Gᵀ) − (2/3) k I.
template <int dim>
void ViscousStage<dim>::close(std::int64_t i, const Tensor<dim>& g, double energy, double production,
                              const ViscousFlow<dim>& flow) {
  double eddy = 0;
  if (kind_ != Turbulence::none) {
    if (neighbours_[static_cast<size_t>(i)] >= fewest_neighbours) eddy = model_.eddy_viscosity(energy);
    if (model_.wall_damping) eddy *= model_.damping(flow.wall_distance[static_cast<size_t>(i)], production);
  }
  const double viscosity = model_.kinematic_viscosity + eddy;
  if (kind_ == Turbulence::k) eddy_viscosity_[i] = eddy;
  viscosity_[static_cast<size_t>(i)] = viscosity;
  Stress stress{};
  for (int a = 0; a < dim; ++a)
    for (int b = 0; b < dim; ++b) {
      stress.set(a, b, viscosity * (g(a, b) + g(b, a)) - (a == b ? 2.0 / 3.0 * energy : 0.0));
      stress.set(dim + a, b, g(a, b));
    }
  stress_[static_cast<size_t>(i)] = stress;
}

// Advances k of the k model with the ν_t of the old k. Then ν_t and the stress follow from the new k.
template <int dim>
void ViscousStage<dim>::transport(const ViscousFlow<dim>& flow, const LatticeConstants& lattice, double dt,
                                  Eigen::VectorXd& k) {
  advance_k<dim>(flow, model_, lattice, production_, eddy_viscosity_, dt, k, scratch_);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < flow.walls.first; ++i) {
    Tensor<dim> g;
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) g(a, b) = stress_[static_cast<size_t>(i)].g(a, b);
    close(i, g, k[i], production_[i], flow);
  }
}

template <int dim>
void ViscousStage<dim>::gather_force(bool corrected, const ViscousFlow<dim>& flow) {
  const auto n = flow.position.cols();
#pragma omp parallel
  {
    // Water and layers are each divided evenly among the threads, because a layer particle costs little.
#pragma omp for schedule(static) nowait
    for (std::int64_t i = 0; i < flow.walls.first; ++i) {
      const auto at = static_cast<size_t>(i);
      if (!flow.ranks.owns(i)) continue;  // its owner sends the velocity
      const bool inside = neighbours_[at] > 0 && (flow.surface.empty() || !flow.surface[at]);
      acceleration.col(i) =
          corrected && inside ? force_on_water<true>(i, flow) : force_on_water<false>(i, flow);
    }
#pragma omp for schedule(static)
    for (std::int64_t j = flow.walls.first; j < n; ++j) acceleration.col(j) = force_on_layer(j, flow);
  }
}

// Computes the sum of f_ij over the neighbours of water particle i. τ_j and G_j are multiplied with the arms,
// lane by lane. The particle's own τ_i and G_i are multiplied once, with the sum of the arms.
template <int dim>
template <bool corrected>
Vector<dim> ViscousStage<dim>::force_on_water(std::int64_t i, const ViscousFlow<dim>& flow) const {
  const auto here = sample_[static_cast<size_t>(i)].lanes;
  const double viscosity = viscosity_[static_cast<size_t>(i)];
  const auto columns = flow.near.row(i);
  const auto inverses = flow.near.inverses(i);
  [[maybe_unused]] Double8 turn[dim];  // C_i for the rows of τ, the identity for those of G; by columns
  if constexpr (corrected) {
    const Tensor<dim>& c = correction_[static_cast<size_t>(i)];
    if constexpr (dim == 2) {
      turn[0] = Double8{c(0, 0), c(1, 0), c(0, 0), c(1, 0), 1, 0, 1, 0};
      turn[1] = Double8{c(0, 1), c(1, 1), c(0, 1), c(1, 1), 0, 1, 0, 1};
    } else {
      turn[0] = Double8{c(0, 0), c(1, 0), c(2, 0), 0, 1, 0, 0, 0};
      turn[1] = Double8{c(0, 1), c(1, 1), c(2, 1), 0, 0, 1, 0, 0};
      turn[dim - 1] = Double8{c(0, dim - 1), c(1, dim - 1), c(dim - 1, dim - 1), 0, 0, 0, 1, 0};
    }
  }
  Double8 sum[parts]{}, arm_sum{};
  const bool seams = flow.periodic.any();
  auto drag = here - here;  // Σ v {r, u}
  const size_t inner = water_pairs(columns, flow.walls.first);
  each_pair(columns.first(inner), inverses, radius_, [&](std::int32_t column, double inverse, double w) {
    const auto j = static_cast<size_t>(column);
    auto d = sample_[j].lanes - here;
    if (seams) over_seams<dim>(flow.periodic, d);
    const double v = 0.5 * laplacian_scale_ * w * (viscosity + viscosity_[j]);
    Double8 arm = arms(d);
    if constexpr (corrected) {
      arm = turn[0] * d[0];
      for (int b = 1; b < dim; ++b) arm += turn[b] * d[b];
    }
    arm *= halves(stress_scale_ * w * inverse * inverse, -0.5 * v);  // of τ, of G
    arm_sum += arm;
    if constexpr (dim == 2) {
      sum[0] += stress_[j].part[0] * arm;
    } else {
      sum[0] += stress_[j].part[0] * __builtin_shufflevector(arm, arm, 0, 1, 2, 3, 0, 1, 2, 3);
      sum[1] += stress_[j].part[1] * arm;
      sum[2] += stress_[j].part[2] * __builtin_shufflevector(arm, arm, 4, 5, 6, 7, 4, 5, 6, 7);
    }
    drag += v * d;
  });
  const Stress& own = stress_[static_cast<size_t>(i)];
  Vector<dim> force;
  for (int a = 0; a < dim; ++a) {
    double total = drag[width + a];
    for (int b = 0; b < dim; ++b) {
      const int t = a * width + b, g = (dim + a) * width + b;
      total += sum[t / 8][t % 8] + sum[g / 8][g % 8] + own.g(a, b) * arm_sum[4 + b];
      total += (corrected ? -own.tau(a, b) : own.tau(a, b)) * arm_sum[b];
    }
    force[a] = total;
  }
  each_pair(columns.subspan(inner), inverses.subspan(inner), radius_,
            [&](std::int32_t j, double inverse, double w) {
              if (!flow.dry(j)) force += pair_with_layer<corrected>(i, j, w, inverse, flow);
            });
  return force;
}

// Returns f of water particle i by layer particle j. A corrected sum has no (τ_j − τ_i), and reads the flow
// that a smooth wall mirrors.
template <int dim>
template <bool corrected>
Vector<dim> ViscousStage<dim>::pair_with_layer(std::int64_t i, std::int64_t j, double w, double inverse,
                                               const ViscousFlow<dim>& flow) const {
  auto d = sample_[static_cast<size_t>(j)].lanes - sample_[static_cast<size_t>(i)].lanes;
  over_seams<dim>(flow.periodic, d);
  const Stress& own = stress_[static_cast<size_t>(i)];
  const double s = 2 * stress_scale_ * w * inverse * inverse;
  const double v = laplacian_scale_ * w * viscosity_[static_cast<size_t>(i)];
  Vector<dim> force;
  for (int a = 0; a < dim; ++a) {
    double push = 0, linear = 0;
    for (int b = 0; b < dim; ++b) {
      push += own.tau(a, b) * d[b];
      linear += own.g(a, b) * d[b];
    }
    force[a] = (corrected ? 0.0 : s * push) + v * (d[width + a] - linear);
  }
  if (corrected || !behind_.slip[static_cast<size_t>(j - flow.walls.first)]) return force;
  const Vector<dim> normal = flow.walls.normal.col(j - flow.walls.first);
  return normal.squaredNorm() > 0 ? Vector<dim>(normal * normal.dot(force)) : force;
}

template <int dim>
Vector<dim> ViscousStage<dim>::force_on_layer(std::int64_t j, const ViscousFlow<dim>& flow) const {
  Vector<dim> force = Vector<dim>::Zero();
  if (flow.dry(j)) return force;
  const auto columns = flow.near.row(j);
  const auto inverses = flow.near.inverses(j);
  for (size_t e = 0; e < columns.size() && columns[e] < flow.walls.first; ++e)
    if (const double w = radius_ * inverses[e] - 1; w > 0)
      force -= pair_with_layer<false>(columns[e], j, w, inverses[e], flow);
  return force;
}

// Computes the paper's form operator by operator, with the walls' own velocity at their layers.
template <int dim>
void ViscousStage<dim>::separate(const Parameters& parameters, const ViscousFlow<dim>& flow, double dt,
                                 Eigen::VectorXd& k) {
  const Scheme& scheme = parameters.scheme;
  const double l0 = parameters.spacing, nu = parameters.kinematic_viscosity;
  // Terms of smooth walls are left out (fluid/THEORY.md, section 2).
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
  if (consistent(scheme)) correction = gradient_correction<dim>(flow.position, flow.near, lattice, masks);
  auto gradient = velocity_gradient<dim>(flow.position, flow.velocity, flow.near, lattice, correction, masks);
  const SpsModel model = sps_model(parameters);
  auto counts = neighbour_counts(flow.near, lattice.radius);
  update_gradients(flow, gradient, counts);
  SpsFields fields = sps_fields<dim>(gradient, counts, model, flow.wall_distance, masks);
  if (scheme.turbulence == Turbulence::k)
    advance_fields<dim>(flow, model, lattice, counts, dt, k, scratch_, fields);
  acceleration = viscous_acceleration<dim>(flow.velocity, flow.far, laplacian_lattice, nu, masks) +
                 sps_acceleration<dim>(flow.position, gradient, fields, flow.near, lattice, masks);
  k = fields.k;
}

template class ViscousStage<2>;
template class ViscousStage<3>;

}  // namespace strake::fluid
