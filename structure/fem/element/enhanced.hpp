#pragma once

#include "structure/fem/element/cell.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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
  // lines.
  using Modes =
      Eigen::Matrix<double, components<dim>, Eigen::Dynamic, Eigen::ColMajor, components<dim>, modes>;
  using Amplitudes = Eigen::VectorXd;
  using Strains = std::array<Tensor<dim>, static_cast<std::size_t>(n)>;

  EnhancedStrain(const Mesh<dim>& mesh, int cell) : weight_(mesh.weight.data() + cell * n) {
    double volume = 0;
    for (int q = 0; q < n; ++q) volume += weight_[q];
    const Tensor<dim> inverse = Eigen::Map<const Tensor<dim>>(mesh.centre_inverse.col(cell).data());
    for (int q = 0; q < n; ++q) {
      const double scale = volume * mesh.reference_weight(q) / weight_[q];
      Modes& G = modes_[static_cast<std::size_t>(q)];
      G.resize(components<dim>, modes);
      if constexpr (n == (1 << dim))
        fill_linear(G, inverse, mesh.point.col(q));
      else
        fill_quadratic(G, mesh.point.col(q));
      G *= scale;
    }
  }

  const Modes& at(int q) const { return modes_[static_cast<std::size_t>(q)]; }

  /// Σ w Gᵀ D G.
  Eigen::MatrixXd stiffness(const Material& m, const Strains& E) const {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(modes, modes);
    for (int q = 0; q < n; ++q)
      H.noalias() +=
          weight_[q] * at(q).transpose() * (moduli<dim>(m, E[static_cast<std::size_t>(q)]) * at(q));
    return H;
  }

  /// Adds them to the strains of the displacement. Not finite where there is no such state.
  void add_to(Strains& E, const Material& m) const {
    if (m.model != MaterialModel::neo_hookean) {
      E = sum(E, -stiffness(m, E).ldlt().solve(force(m, E)));
      return;
    }
    // Newton's method for the minimum of the cell's energy, which must fall along each step.
    Amplitudes alpha = Amplitudes::Zero(modes);
    double energy = energy_of(m, E);
    for (int i = 0; i < most_steps && std::isfinite(energy); ++i) {
      const Strains here = sum(E, alpha);
      const Amplitudes r = force(m, here);
      Amplitudes step = -downhill(stiffness(m, here), r);
      double largest = 0;
      for (int q = 0; q < n; ++q) largest = std::max(largest, (at(q) * step).cwiseAbs().maxCoeff());
      if (largest <= small_step) {
        E = sum(E, alpha + step);
        return;
      }
      double next = energy_of(m, sum(E, alpha + step));
      const auto falls = [&] { return next <= energy + enough * r.dot(step) + round_off * std::abs(energy); };
      for (int k = 0; k < most_halvings && !falls(); ++k) {
        step /= 2;
        next = energy_of(m, sum(E, alpha + step));
      }
      alpha += step;
      energy = next;
    }
    for (Tensor<dim>& strain : E) strain.setConstant(std::numeric_limits<double>::quiet_NaN());
  }

 private:
  // Of the strain. Newton's method squares its error, so that what is left after such a step is round-off.
  static constexpr double small_step = 1e-9;
  static constexpr int most_steps = 60, most_halvings = 30;
  static constexpr double enough = 1e-4;      // of the fall that the slope promises
  static constexpr double round_off = 1e-14;  // of the energy

  /// Σ w G:S.
  Amplitudes force(const Material& m, const Strains& E) const {
    Amplitudes r = Amplitudes::Zero(modes);
    for (int q = 0; q < n; ++q)
      r.noalias() += weight_[q] * at(q).transpose() *
                     stress_components<dim>(second_piola_kirchhoff<dim>(m, E[static_cast<std::size_t>(q)]));
    return r;
  }

  /// ∫ ψ; infinite where 2E + 1 is not positive definite.
  double energy_of(const Material& m, const Strains& E) const {
    double energy = 0;
    for (int q = 0; q < n; ++q) {
      const Tensor<dim>& strain = E[static_cast<std::size_t>(q)];
      const Eigen::LLT<Tensor<dim>> factors(2 * strain + Tensor<dim>::Identity());
      if (factors.info() != Eigen::Success || !strain.allFinite())
        return std::numeric_limits<double>::infinity();
      energy += weight_[q] * energy_of_strain<dim>(m, strain);
    }
    return energy;
  }

  /// Computes H⁻¹ r; if an eigenvalue of H is negative, with the magnitudes of the eigenvalues. A
  /// neo-Hookean's shear stiffness is μ − λ ln J, so a large stretch makes a saddle beside the minimum.
  static Amplitudes downhill(const Eigen::MatrixXd& H, const Amplitudes& r) {
    const auto factors = H.ldlt();
    if (factors.isPositive()) return factors.solve(r);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(H);
    const Amplitudes size =
        eigen.eigenvalues().cwiseAbs().cwiseMax(1e-6 * eigen.eigenvalues().cwiseAbs().maxCoeff());
    return eigen.eigenvectors() *
           Amplitudes(Amplitudes(eigen.eigenvectors().transpose() * r).cwiseQuotient(size));
  }

  Strains sum(const Strains& E, const Amplitudes& alpha) const {
    Strains result;
    for (int q = 0; q < n; ++q)
      result[static_cast<std::size_t>(q)] =
          E[static_cast<std::size_t>(q)] + strain_tensor<dim>(at(q) * alpha);
    return result;
  }

  template <class Place>
  static void fill_linear(Modes& G, const Tensor<dim>& inverse, const Place& xi) {
    int k = 0;
    const auto add = [&](int i, int j, double value) {
      Tensor<dim> M = Tensor<dim>::Zero();
      M(i, j) += 0.5 * value;
      M(j, i) += 0.5 * value;
      G.col(k++) = strain_components<dim>(inverse.transpose() * M * inverse);
    };
    for (int i = 0; i < dim; ++i) add(i, i, xi(i));
    for (int i = 0; i < dim; ++i)
      for (int j = i + 1; j < dim; ++j) {
        add(i, j, xi(i));
        add(i, j, xi(j));
      }
    if constexpr (dim == 3)
      for (int i = 0; i < dim; ++i)
        G.col(k++) = strain_components<dim>(xi(i) * xi((i + 1) % dim) * Tensor<dim>::Identity());
  }

  template <class Place>
  static void fill_quadratic(Modes& G, const Place& xi) {
    const auto legendre = [](int degree, double x) {
      return degree == 0 ? 1 : degree == 1 ? x : 0.5 * (3 * x * x - 1);
    };
    int k = 0;
    for (int c = 0; c < (dim == 3 ? 3 : 1); ++c)
      for (int b = 0; b < 3; ++b)
        for (int a = 0; a < 3; ++a) {
          if (a + b + c < 2) continue;
          double p = legendre(a, xi(0)) * legendre(b, xi(1));
          if constexpr (dim == 3) p *= legendre(c, xi(2));
          G.col(k++) = strain_components<dim>(p * Tensor<dim>::Identity());
        }
  }

  const double* weight_;
  std::array<Modes, static_cast<std::size_t>(n)> modes_;
};

}  // namespace strake::structure::fem
