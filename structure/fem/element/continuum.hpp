#pragma once

#include "structure/fem/element/enhanced.hpp"

#include <optional>

namespace strake::structure::fem {

/// An element whose strains are those of its displacement, perhaps with strains that it adds.
template <int dim, int n>
class Continuum {
 public:
  static constexpr int dimension = dim, nodes = n;
  using Values = NodeValues<dim, n>;

  Continuum(const Mesh<dim>& mesh, int cell, bool enhanced)
      : weight(mesh.weight.data() + cell * n), mesh_(mesh), first_(cell * n) {
    if (enhanced) added.emplace(mesh, cell);
  }
  const double* weight;  // of the points of quadrature
  std::optional<EnhancedStrain<dim, n>> added;

  /// ∂N_a/∂X in a point of quadrature, one row for each node.
  auto gradient(int q) const {
    return Eigen::Map<const Eigen::Matrix<double, n, dim>>(mesh_.gradient.col(first_ + q).data());
  }

  /// Gradients H of the displacement in the points, side by side: linear in it, so that each is made once.
  using Motion = Eigen::Matrix<double, dim, dim * n>;
  Motion motion(const Values& u) const {
    Motion H;
    for (int q = 0; q < n; ++q) H.template middleCols<dim>(dim * q) = u * gradient(q);
    return H;
  }

  /// Of the displacement alone.
  Strains<dim, n> strains(const Motion& H, bool large) const {
    Strains<dim, n> E;
    for (int q = 0; q < n; ++q)
      E[static_cast<std::size_t>(q)] =
          strain_of<dim>(Tensor<dim>(H.template middleCols<dim>(dim * q)), large);
    return E;
  }

  /// B of a point: ∂E_JK/∂u_ai = ½ (F_iJ g_aK + F_iK g_aJ),  g_a = ∇N_a.
  auto rows(const Motion& H, bool large) const {
    return [this, H, large](int q) {
      const auto g = gradient(q);
      Tensor<dim> F = Tensor<dim>::Identity();
      if (large) F += H.template middleCols<dim>(dim * q);
      StrainRows<dim, n> B;
      for (int a = 0; a < n; ++a)
        for (int i = 0; i < dim; ++i) {
          const Tensor<dim> half = 0.5 * F.row(i).transpose() * g.row(a);
          B.col(dim * a + i) = strain_components<dim>(half + half.transpose());
        }
      return B;
    };
  }

  /// f_a = Σ w F S g_a.
  Values forces(const Motion& H, const Strains<dim, n>& S, bool large) const {
    Values f = Values::Zero();
    for (int q = 0; q < n; ++q) {
      Tensor<dim> P = S[static_cast<std::size_t>(q)];
      if (large) P += H.template middleCols<dim>(dim * q) * S[static_cast<std::size_t>(q)];
      f.noalias() += (weight[q] * P) * gradient(q).transpose();
    }
    return f;
  }

  /// Σ w g_a·S g_b, the change of the forces' directions in each component.
  Eigen::Matrix<double, n, n> geometric(const Strains<dim, n>& S) const {
    Eigen::Matrix<double, n, n> between = Eigen::Matrix<double, n, n>::Zero();
    for (int q = 0; q < n; ++q)
      between.noalias() +=
          (weight[q] * gradient(q) * S[static_cast<std::size_t>(q)]).eval() * gradient(q).transpose();
    return between;
  }

 private:
  const Mesh<dim>& mesh_;
  int first_;  // point
};

}  // namespace strake::structure::fem
