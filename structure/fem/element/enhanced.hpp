#pragma once

#include "structure/fem/element/cell.hpp"

#include <Eigen/LU>

#include <array>

namespace strake::structure::fem {

/// Independent components of a symmetric tensor: xx, yy, xy; in space xx, yy, zz, xy, yz, xz. Strains have
/// their shear doubled, so that the product with a stress is S:E.
template <int dim>
inline constexpr int components = dim*(dim + 1) / 2;
template <int dim>
using Components = Eigen::Matrix<double, components<dim>, 1>;

template <int dim>
Components<dim> stress_components(const Tensor<dim>& S) {
  if constexpr (dim == 2)
    return {S(0, 0), S(1, 1), S(0, 1)};
  else
    return (Components<dim>() << S(0, 0), S(1, 1), S(2, 2), S(0, 1), S(1, 2), S(0, 2)).finished();
}

template <int dim>
Components<dim> strain_components(const Tensor<dim>& E) {
  Components<dim> c = stress_components<dim>(E);
  c.template tail<components<dim> - dim>() *= 2;
  return c;
}

template <int dim>
Tensor<dim> stress_tensor(const Components<dim>& c) {
  Tensor<dim> S;
  if constexpr (dim == 2)
    S << c(0), c(2), c(2), c(1);
  else
    S << c(0), c(3), c(5), c(3), c(1), c(4), c(5), c(4), c(2);
  return S;
}

template <int dim>
Tensor<dim> strain_tensor(Components<dim> c) {
  c.template tail<components<dim> - dim>() /= 2;
  return stress_tensor<dim>(c);
}

/// Components of ∂S/∂E = λ B⊗B + 2μ B⊙B with B = 1. Neo-Hookean: B = C⁻¹, and μ − λ ln J replaces μ.
template <int dim>
Eigen::Matrix<double, components<dim>, components<dim>> moduli(const Material& m, const Tensor<dim>& E) {
  Eigen::Matrix<double, components<dim>, components<dim>> D;
  Tensor<dim> B = Tensor<dim>::Identity();
  double mu = m.lame_mu();
  if (m.model == MaterialModel::neo_hookean) {
    B = Tensor<dim>(2 * E + B).inverse();
    mu -= m.lame_lambda() * log_jacobian<dim>(E);
  }
  for (int k = 0; k < components<dim>; ++k) {
    const Tensor<dim> unit = strain_tensor<dim>(Components<dim>::Unit(k));
    D.col(k) =
        stress_components<dim>(m.lame_lambda() * B.cwiseProduct(unit).sum() * B + 2 * mu * B * unit * B);
  }
  return D;
}

/// Enhanced assumed strains (Simo & Rifai 1990), here with Green-Lagrange's strain. A cell adds them to the
/// strains of its displacement, so that it locks neither in bending nor where the material keeps its volume:
///   Ê = E(u) + Σ_k α_k G_k,   the amplitudes from   Σ_q w_q G_k:S(Ê_q) = 0   for each k.
/// The amplitudes minimise the cell's energy and are no unknowns of the system. So forces stay the gradient
/// of an energy of u, which is invariant under rotation since E(u) is. For a quadratic energy α is linear in
/// E. Hence the mean strain of a step gets the mean of the amplitudes, and the work of its force is exactly
/// the change of energy.
///
/// With ξ, η, ζ in [−1, 1], V/j the cell's volume over the Jacobian and J_0 the map's gradient at its centre:
///   Q1  J_0⁻ᵀ M J_0⁻¹ V/j: M = ξ in xx, η in yy, ξ and η in xy (and their like in z): the strains of bending
///       that bilinear displacements lack; in space beside them ξη 1, ηζ 1 and ζξ 1, which the volume's
///       change has from the hourglass displacement alone (Simo, Armero & Taylor 1993)
///   Q2  p 1 V/j with each product p of Legendre's polynomials up to the second but 1, ξ, η, ζ: the pressure
///       becomes linear in the cell (Q2/P-1)
/// All have the mean 0 over the cell, so that uniform strains stay exact on any mesh.
template <int dim, int n>
class EnhancedStrain {
 public:
  static constexpr int modes = dim == 2 ? (n == 4 ? 4 : 6) : (n == 8 ? 12 : 23);
  // Sizes that the compiler does not see: it would unroll products of twenty-three modes by the thousand
  // lines. One type for all elements of a dimension.
  using Modes = Eigen::Matrix<double, components<dim>, Eigen::Dynamic, Eigen::ColMajor, components<dim>,
                              dim == 2 ? 6 : 23>;
  using Amplitudes = Eigen::VectorXd;
  using Strains = std::array<Tensor<dim>, static_cast<std::size_t>(n)>;

  EnhancedStrain(const Mesh<dim>&, int cell);
  /// The seven of a solid shell that is thin along an axis (solid_shell.hpp).
  EnhancedStrain(const Mesh<dim>&, int cell, int thin) requires(dim == 3 && n == 8);

  int count() const { return static_cast<int>(modes_[0].cols()); }
  const Modes& at(int q) const { return modes_[static_cast<std::size_t>(q)]; }

  /// Σ w Gᵀ D G.
  Eigen::MatrixXd stiffness(const Material&, const Strains&) const;

  /// Adds them to the strains of the displacement. Not finite where there is no such state.
  void add_to(Strains&, const Material&) const;

 private:
  Amplitudes force(const Material&, const Strains&) const;
  double energy_of(const Material&, const Strains&) const;
  Strains sum(const Strains&, const Amplitudes&) const;
  template <class Fill>
  void fill(const Mesh<dim>&, int cell, int count, const Fill&);
  template <class Place>
  static void fill_shell(Modes&, const Tensor<dim>& inverse, const Place& xi, int thin) requires(dim == 3);
  template <class Place>
  static void fill_linear(Modes&, const Tensor<dim>& inverse, const Place& xi);
  template <class Place>
  static void fill_quadratic(Modes&, const Place& xi);

  const double* weight_;
  std::array<Modes, static_cast<std::size_t>(n)> modes_;
};

/// L H⁻¹ L1ᵀ with the stiffness H of the added strains: what their freedom takes from a cell's stiffness.
Eigen::MatrixXd condensed(const Eigen::MatrixXd& L, const Eigen::MatrixXd& H, const Eigen::MatrixXd& L1);

}  // namespace strake::structure::fem
