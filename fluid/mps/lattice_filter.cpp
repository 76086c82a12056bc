#include "fluid/mps/lattice_filter.hpp"

#include "fluid/mps/operators.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace strake::fluid {

// Computes the change Δu_i of the filter (F23):
//   Δu_i = Δt (2d/(n0 λ)) Σ_j ν_ij δ_ij w,   δ_ij = u_j − u_i − ½ (∇u_i + ∇u_j) r_ij,
//   ν_ij = β l0 √(max(P_i + P_j, 0)/(2ρ)), bounded where the explicit step would overshoot.
template <int dim>
Vectors<dim> filter_lattice(const FilterTerms<dim>& t) {
  Vectors<dim> change = Vectors<dim>::Zero(dim, t.water);
  if (t.strength <= 0) return change;
  std::vector<std::uint8_t> is_water(static_cast<std::size_t>(t.position.cols()), 0);
  std::fill_n(is_water.begin(), t.water, std::uint8_t{1});
  const Masks among{is_water, is_water};
  const auto correction = gradient_correction<dim>(t.position, t.near, t.lattice, among);
  const auto explained = velocity_gradient<dim>(t.position, t.velocity, t.near, t.lattice, correction, among);
  const auto seams = t.near.template seams<dim>();
  const double factor = 2.0 * dim / (t.lattice.n0 * t.lattice.lambda0) * t.dt;
  constexpr double most_of_a_step = 0.2;
  const double bound = most_of_a_step / (factor * t.lattice.n0);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < t.water; ++i) {
    const auto columns = t.near.row(i);
    const auto inverses = t.near.inverses(i);
    Vector<dim> sum = Vector<dim>::Zero();
    for (std::size_t e = 0; e < columns.size() && columns[e] < t.water; ++e) {
      const std::int64_t j = columns[e];
      const double w = t.lattice.radius * inverses[e] - 1;
      if (w <= 0) continue;
      const double pressure = std::max(0.0, 0.5 * (t.pressure[i] + t.pressure[j]));
      const double viscosity = std::min(t.strength * t.spacing * std::sqrt(pressure / t.density), bound);
      const Vector<dim> r = seams.separation(t.position.col(i), t.position.col(j));
      const Tensor<dim> mean =
          0.5 * (explained[static_cast<std::size_t>(i)] + explained[static_cast<std::size_t>(j)]);
      sum += viscosity * w * (t.velocity.col(j) - t.velocity.col(i) - mean * r);
    }
    change.col(i) = factor * sum;
  }
  return change;
}

template Vectors<2> filter_lattice<2>(const FilterTerms<2>&);
template Vectors<3> filter_lattice<3>(const FilterTerms<3>&);

}  // namespace strake::fluid
