#pragma once

#include "structure/fem/mesh/mesh.hpp"
#include "structure/material/material.hpp"

#include <Eigen/Core>

#include <cassert>
#include <type_traits>

namespace strake::structure::fem {

template <int dim>
using Tensor = Eigen::Matrix<double, dim, dim>;

/// E of the displacement gradient H: ½(H + Hᵀ), for large deformation + ½ HᵀH.
template <int dim>
Tensor<dim> strain_of(const Tensor<dim>& gradient, bool large) {
  Tensor<dim> E = 0.5 * (gradient + gradient.transpose());
  if (large) E += 0.5 * gradient.transpose() * gradient;
  return E;
}

inline bool is_large(const Material& m) {
  return m.model != MaterialModel::linear;
}

/// One cell's view of the mesh for elements of `n` nodes: fixed sizes, so that the small products unroll.
template <int dim, int n>
struct CellView {
  using Values = Eigen::Matrix<double, dim, n>;
  using Gradient = Eigen::Map<const Eigen::Matrix<double, n, dim>>;
  const Mesh<dim>& mesh;

  Values gather(const Eigen::VectorXd& u, int cell) const {
    Values values;
    for (int a = 0; a < n; ++a) values.col(a) = u.template segment<dim>(dim * mesh.cell(a, cell));
    return values;
  }
  Gradient gradient(int point) const { return Gradient(mesh.gradient.col(point).data()); }
};

/// Calls `kernel` with the number of nodes per cell as a constant; as many are its points of quadrature.
template <int dim, class Kernel>
auto with_nodes(int degree, const Kernel& kernel) {
  constexpr int linear = dim == 2 ? 4 : 8, quadratic = dim == 2 ? 9 : 27;
  assert(degree == 1 || degree == 2);
  return degree == 1 ? kernel(std::integral_constant<int, linear>{})
                     : kernel(std::integral_constant<int, quadratic>{});
}

}  // namespace strake::structure::fem
