#pragma once

#include "structure/fem/element/cell.hpp"
#include "structure/fem/element/enhanced.hpp"
#include "structure/material/material.hpp"

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <limits>

// What makes the work of a neo-Hookean cell's stresses over a step the change of its energy (Gonzalez 2000,
// Comput. Methods Appl. Mech. Eng. 190:1763, cell by cell).

namespace strake::structure::fem {

/// Whether the stress of the mid-point alone does not work the change of energy.
inline bool balances_energy(const Material& m, double alpha) {
  return m.model == MaterialModel::neo_hookean && alpha == 0.5;
}

template <int dim, int n>
using Strains = std::array<Tensor<dim>, static_cast<std::size_t>(n)>;  // of a cell's points

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

/// Adds the derivative of the force Σ w F_α (m/s ΔE) g_a by component j of node b, over ½:
///   2 A ⊗ (R − 2 m/s Σ w F_1 ΔE g)/s + m/s Σ w {δ_ij g_a·ΔE g_b + (F_αi·F_1j)(g_a·g_b) +
///   (F_αi·g_b)(F_1j·g_a)}, A = Σ w F_α ΔE g,  R = ∂m/∂u = Σ w F_1 (S_1 − S − ½ ∂S/∂E:ΔE) g.
template <int dim, int n, class Local>
void add_balance_tangent(Local& local, const CellView<dim, n>& view, int cell, const Material& m,
                         const Strains<dim, n>& E0, const Strains<dim, n>& E1, const Strains<dim, n>& F_alpha,
                         const Strains<dim, n>& F1) {
  using Values = Eigen::Matrix<double, dim, n>;
  const double* weight = view.mesh.weight.data() + cell * n;
  Strains<dim, n> E, S, change;
  for (std::size_t q = 0; q < E.size(); ++q) {
    E[q] = 0.5 * (E0[q] + E1[q]);
    change[q] = E1[q] - E0[q];
    S[q] = second_piola_kirchhoff<dim>(m, E[q]);
  }
  const EnergyBalance<dim, n> balance(E0, E1, m, weight);
  Values A = Values::Zero(), R = Values::Zero();
  for (int q = 0; q < n; ++q) {
    const auto at = static_cast<std::size_t>(q);
    const auto g = view.gradient(cell * n + q);
    const Tensor<dim> turned =
        stress_tensor<dim>(Components<dim>(moduli<dim>(m, E[at]) * strain_components<dim>(change[at])));
    const Tensor<dim> beyond =
        second_piola_kirchhoff<dim>(m, E1[at]) - S[at] - 0.5 * turned - 2 * balance.part * change[at];
    A.noalias() += weight[q] * (F_alpha[at] * change[at]) * g.transpose();
    R.noalias() += weight[q] * (F1[at] * beyond) * g.transpose();
    const Values f_alpha = F_alpha[at] * g.transpose(), f1 = F1[at] * g.transpose();
    const Tensor<dim> FF = F_alpha[at] * F1[at].transpose();
    const double part = balance.part * weight[q];
    const Eigen::Matrix<double, n, n> gg = part * g * g.transpose(),
                                      gEg = part * g * change[at] * g.transpose();
    for (int b = 0; b < n; ++b)
      for (int a = 0; a < n; ++a)
        for (int j = 0; j < dim; ++j)
          for (int i = 0; i < dim; ++i)
            local(dim * a + i, dim * b + j) +=
                (i == j ? gEg(a, b) : 0.0) + FF(i, j) * gg(a, b) + part * f_alpha(i, b) * f1(j, a);
  }
  using Column = Eigen::Map<const Eigen::Matrix<double, dim * n, 1>>;
  local.noalias() += 2 / balance.size * Column(A.data()) * Column(R.data()).transpose();
}

}  // namespace strake::structure::fem
