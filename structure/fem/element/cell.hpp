#pragma once

#include "structure/fem/mesh/mesh.hpp"
#include "structure/material/material.hpp"

#include <Eigen/Core>
#include <Eigen/LU>

#include <array>
#include <cassert>
#include <type_traits>

// Strains and stresses of a cell, and their components.

namespace strake::structure::fem {

template <int dim>
using Tensor = Eigen::Matrix<double, dim, dim>;
template <int dim, int n>
using Strains = std::array<Tensor<dim>, static_cast<std::size_t>(n)>;  // of a cell's points
template <int dim, int n>
using NodeValues = Eigen::Matrix<double, dim, n>;  // of a cell's nodes

/// E of the displacement gradient H: ½(H + Hᵀ), for large deformation + ½ HᵀH. Always inlined: a call for
/// each point of quadrature makes a step of a small body in the plane 18 % longer.
template <int dim>
[[gnu::always_inline]] inline Tensor<dim> strain_of(const Tensor<dim>& gradient, bool large) {
  Tensor<dim> E = 0.5 * (gradient + gradient.transpose());
  if (large) E += 0.5 * gradient.transpose() * gradient;
  return E;
}

inline bool is_large(const Material& m) {
  return m.model != MaterialModel::linear;
}

/// Independent components of a symmetric tensor: xx, yy, xy; in space xx, yy, zz, xy, yz, xz. Strains have
/// their shear doubled, so that the product with a stress is S:E.
template <int dim>
inline constexpr int components = dim*(dim + 1) / 2;
template <int dim>
using Components = Eigen::Matrix<double, components<dim>, 1>;
/// B = ∂E/∂u: the change of the strain's components by component i of node a, in column dim·a + i.
template <int dim, int n>
using StrainRows = Eigen::Matrix<double, components<dim>, dim * n>;

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
Tensor<dim> strain_tensor(Components<dim> c) {
  c.template tail<components<dim> - dim>() /= 2;
  Tensor<dim> E;
  if constexpr (dim == 2)
    E << c(0), c(2), c(2), c(1);
  else
    E << c(0), c(3), c(5), c(3), c(1), c(4), c(5), c(4), c(2);
  return E;
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

/// Values of a cell's nodes.
template <int dim, int n>
NodeValues<dim, n> gather(const Mesh<dim>& mesh, const Eigen::VectorXd& u, int cell) {
  NodeValues<dim, n> values;
  for (int a = 0; a < n; ++a) values.col(a) = u.template segment<dim>(dim * mesh.cell(a, cell));
  return values;
}

/// Calls `kernel` with the number of nodes per cell as a constant; as many are its points of quadrature.
template <int dim, class Kernel>
auto with_nodes(int degree, const Kernel& kernel) {
  constexpr int linear = dim == 2 ? 4 : 8, quadratic = dim == 2 ? 9 : 27;
  assert(degree == 1 || degree == 2);
  return degree == 1 ? kernel(std::integral_constant<int, linear>{})
                     : kernel(std::integral_constant<int, quadratic>{});
}

}  // namespace strake::structure::fem
