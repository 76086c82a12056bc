#pragma once

#include "structure/fem/element/cell.hpp"

#include <algorithm>
#include <limits>

// What makes the work of a neo-Hookean cell's stresses over a step the change of its energy (Gonzalez 2000,
// Comput. Methods Appl. Mech. Eng. 190:1763, cell by cell).

namespace strake::structure::fem {

/// Whether the stress of the mid-point alone does not work the change of energy.
inline bool balances_energy(const Material& m, double alpha) {
  return m.model == MaterialModel::neo_hookean && alpha == 0.5;
}

/// ψ1 − ψ0 − S((E0 + E1)/2):ΔE of neo-Hookean [Pa], of third order in ΔE. With C1 = C0 + 2ΔE and B the
/// inverse of their mean,
///   (λ (ln J0 + ln J1)/2 − μ) ln(J1/J0) − (λ ln J − μ) B:ΔE,  ln(J1/J0) = ½ ln det(1 + 2 C0⁻¹ΔE):
/// round-off is that of ΔE, where ψ1 − ψ0 has that of E.
template <int dim>
double energy_beyond_midpoint(const Material& m, const Tensor<dim>& E0, const Tensor<dim>& E1) {
  const Tensor<dim> one = Tensor<dim>::Identity(), change = E1 - E0;
  const double log_ratio = log_jacobian<dim>(Tensor<dim>(2 * E0 + one).inverse() * change);
  const double along = Tensor<dim>(E0 + E1 + one).inverse().cwiseProduct(change).sum();
  const double lambda = m.lame_lambda(), mu = m.lame_mu();
  const double mean = log_jacobian<dim>(E0) + 0.5 * log_ratio, middle = log_jacobian<dim>(0.5 * (E0 + E1));
  return (lambda * mean - mu) * log_ratio - (lambda * middle - mu) * along;
}

/// S + m/s ΔE in place of S between two strains, with
///   m = Σ w (ψ1 − ψ0 − S:ΔE),  s = Σ w ΔE:ΔE.
template <int dim, int n>
struct EnergyBalance {
  double size = 0, part = 0;  // s, m/s

  EnergyBalance(const Strains<dim, n>& E0, const Strains<dim, n>& E1, const Material& m,
                const double* weight) {
    double missing = 0;
    for (std::size_t q = 0; q < E0.size(); ++q) {
      missing += weight[q] * energy_beyond_midpoint<dim>(m, E0[q], E1[q]);
      size += weight[q] * (E1[q] - E0[q]).squaredNorm();
    }
    size = std::max(size, std::numeric_limits<double>::min());
    part = missing / size;
  }
  /// With enhanced strains. S is the stress of the mean of E0 and E1 with its own enhanced strain; E0 and E1
  /// include theirs.
  EnergyBalance(const Strains<dim, n>& S, const Material& m, const Strains<dim, n>& change,
                const Strains<dim, n>& E0, const Strains<dim, n>& E1, const double* weight) {
    // ψ carries a round-off of ε |E| μ, so that the quotient is noise if ΔE is small. The addition is of
    // third order and negligible there.
    constexpr double noise = 1e-10;  // ΔE:ΔE
    double missing = 0;
    for (std::size_t q = 0; q < S.size(); ++q) {
      missing += weight[q] * (energy_of_strain<dim>(m, E1[q]) - energy_of_strain<dim>(m, E0[q]) -
                              S[q].cwiseProduct(change[q]).sum());
      size += weight[q] * (change[q].squaredNorm() + noise);
    }
    part = missing / size;
  }
};

}  // namespace strake::structure::fem
