#pragma once

#include "structure/fem/element/cell.hpp"

#include <array>

namespace strake::structure::fem {

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

  /// `thin`: axis along which a solid shell is thin (solid_shell.hpp); it has seven of its own.
  EnhancedStrain(const Mesh<dim>&, int cell, int thin = -1);

  int count() const { return static_cast<int>(modes_[0].cols()); }
  const Modes& at(int q) const { return modes_[static_cast<std::size_t>(q)]; }

  /// Σ w Gᵀ D G.
  Eigen::MatrixXd stiffness(const Material&, const Strains<dim, n>&) const;

  /// Adds them to the strains of the displacement. Not finite where there is no such state.
  void add_to(Strains<dim, n>&, const Material&) const;

 private:
  Amplitudes force(const Material&, const Strains<dim, n>&) const;
  double energy_of(const Material&, const Strains<dim, n>&) const;
  Strains<dim, n> sum(const Strains<dim, n>&, const Amplitudes&) const;
  const double* weight_;
  std::array<Modes, static_cast<std::size_t>(n)> modes_;
};

}  // namespace strake::structure::fem
