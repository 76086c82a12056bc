#pragma once

#include "structure/fem/element/energy_balance.hpp"

#include <Eigen/Cholesky>

// Forces of a cell over a step from u0 to u1, weighted α to its start, and how they change with u1: the same
// sums for all elements, which are a Continuum or a SolidShell.

namespace strake::structure::fem {

/// α E0 + (1−α) E1, with the strains that the element adds.
template <class Element, class All = Strains<Element::dimension, Element::nodes>>
All strains_of_step(const Element& element, const All& E0, const All& E1, double alpha, const Material& m) {
  All E;
  for (std::size_t q = 0; q < E.size(); ++q) E[q] = alpha * E0[q] + (1 - alpha) * E1[q];
  if (element.added) element.added->add_to(E, m);
  return E;
}

/// Σ w Bᵅᵀ S, and for neo-Hookean S + m/s ΔE in place of S (energy_balance.hpp).
template <class Element>
typename Element::Values force_of_step(const Element& element, const typename Element::Values& u0,
                                       const typename Element::Values& u1, double alpha, const Material& m) {
  constexpr int dim = Element::dimension, n = Element::nodes;
  const bool large = is_large(m);
  const typename Element::Motion from = element.motion(u0), to = element.motion(u1);
  Strains<dim, n> E0 = element.strains(from, large), E1 = element.strains(to, large), S;
  const Strains<dim, n> E = strains_of_step(element, E0, E1, alpha, m);
  for (std::size_t q = 0; q < S.size(); ++q) S[q] = second_piola_kirchhoff<dim>(m, E[q]);
  if (balances_energy(m, alpha)) {
    Strains<dim, n> change;
    for (std::size_t q = 0; q < S.size(); ++q) change[q] = E1[q] - E0[q];
    if (element.added) element.added->add_to(E0, m);
    if (element.added) element.added->add_to(E1, m);
    const auto balance = element.added ? EnergyBalance<dim, n>(S, m, change, E0, E1, element.weight)
                                       : EnergyBalance<dim, n>(E0, E1, m, element.weight);
    for (std::size_t q = 0; q < S.size(); ++q) S[q] += balance.part * change[q];
  }
  return element.forces(alpha * from + (1 - alpha) * to, S, large);
}

/// The derivative of that by u1, over 1−α, with D = ∂S/∂E + 2 m/s 1⊙1 and B = ∂E/∂u at α and at the end:
///   Σ w Bᵅᵀ D B1 − Lᵅ H⁻¹ L1ᵀ + 2/s A ⊗ R + the change of the forces' directions,
///   L = Σ w Bᵀ D G and H = Σ w Gᵀ D G of added strains G,
///   A = Σ w Bᵅᵀ ΔE,  R = ∂m/∂u1 − 2 m/s Σ w B1ᵀ ΔE,  ∂m/∂u1 = Σ w B1ᵀ (S_1 − S − ½ ∂S/∂E:ΔE).
/// With added strains m/s is left out: what balances the energy is of third order in the step.
template <class Element, class Local>
void tangent_of_step(const Element& element, const typename Element::Values& u0,
                     const typename Element::Values& u1, double alpha, const Material& m, Local& local) {
  constexpr int dim = Element::dimension, n = Element::nodes, shear = components<dim> - dim;
  const bool large = is_large(m), balances = balances_energy(m, alpha) && !element.added;
  const typename Element::Motion from = element.motion(u0), to = element.motion(u1);
  const Strains<dim, n> E0 = element.strains(from, large), E1 = element.strains(to, large),
                        E = strains_of_step(element, E0, E1, alpha, m);
  double part = 0, size = 1;
  if (balances) {
    const EnergyBalance<dim, n> balance(E0, E1, m, element.weight);
    part = balance.part;
    size = balance.size;
  }
  const auto rows_alpha = element.rows(alpha * from + (1 - alpha) * to, large),
             rows_1 = element.rows(to, large);
  Eigen::Matrix<double, dim * n, 1> A = Eigen::Matrix<double, dim * n, 1>::Zero(), R = A;
  Eigen::MatrixXd L_alpha = Eigen::MatrixXd::Zero(dim * n, element.added ? element.added->count() : 0);
  Eigen::MatrixXd L1 = L_alpha;
  Strains<dim, n> S;
  local.setZero();
  for (int q = 0; q < n; ++q) {
    const auto at = static_cast<std::size_t>(q);
    const StrainRows<dim, n> B_alpha = rows_alpha(q), B1 = rows_1(q);
    auto D = moduli<dim>(m, E[at]);
    S[at] = second_piola_kirchhoff<dim>(m, E[at]);
    if (balances) {
      const Tensor<dim> change = E1[at] - E0[at], S1 = second_piola_kirchhoff<dim>(m, E1[at]);
      const Components<dim> turned = D * strain_components<dim>(change);
      A.noalias() += B_alpha.transpose() * (element.weight[q] * stress_components<dim>(change));
      R.noalias() +=
          B1.transpose() *
          (element.weight[q] * (stress_components<dim>(S1 - S[at] - 2 * part * change) - 0.5 * turned));
      S[at] += part * change;
      D.diagonal().template head<dim>().array() += 2 * part;
      D.diagonal().template tail<shear>().array() += part;
    }
    D *= element.weight[q];
    local.noalias() += B_alpha.transpose() * (D * B1).eval();
    if (!element.added) continue;
    const Eigen::MatrixXd DG = D * element.added->at(q);
    L_alpha.noalias() += B_alpha.transpose() * DG;
    L1.noalias() += B1.transpose() * DG;
  }
  if (element.added)
    local -= L_alpha * element.added->stiffness(m, E).ldlt().solve(L1.transpose().eval()).eval();
  if (balances) local.noalias() += 2 / size * A * R.transpose();
  if (!large) return;
  const Eigen::Matrix<double, n, n> between = element.geometric(S);
  for (int b = 0; b < n; ++b)
    for (int a = 0; a < n; ++a)
      local.template block<dim, dim>(dim * a, dim * b).diagonal().array() += between(a, b);
}

}  // namespace strake::structure::fem
