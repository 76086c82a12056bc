#include "structure/fem/element/assembly.hpp"
#include "structure/fem/element/cell_sums.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace strake::structure::fem {
namespace {

/// σ = F S Fᵀ / det F [Pa]; out of the plane F = 1 and S_zz = λ tr E, neo-Hookean λ ln J.
template <int dim>
Eigen::Matrix3d cauchy_stress(const Material& m, const Tensor<dim>& H, const Tensor<dim>& E) {
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
  const Tensor<dim> S = second_piola_kirchhoff<dim>(m, E);
  stress.topLeftCorner<dim, dim>() = S;
  if (dim == 2 && !m.plane_stress)
    stress(2, 2) =
        m.lame_lambda() * (m.model == MaterialModel::neo_hookean ? log_jacobian<dim>(E) : E.trace());
  if (is_large(m)) {
    const Tensor<dim> F = Tensor<dim>::Identity() + H;
    stress.topLeftCorner<dim, dim>() = F * S * F.transpose();
    stress /= F.determinant();
  }
  return stress;
}

/// E in the points of quadrature, with the strains that the element adds.
template <class Element>
auto strains_at(const Element& element, const typename Element::Values& u, const Material& m) {
  auto E = element.strains(element.motion(u), is_large(m));
  if (element.added) element.added->add_to(E, m);
  return E;
}

}  // namespace

template <int dim>
double Assembly<dim>::strain_energy(const Eigen::VectorXd& u) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    constexpr int n = nodes;
    double energy = 0;
    const auto compute = [&](int c, double& sum) {
      sum = 0;
      if (!mesh_.owns(c)) return;
      with_element<n>(c, [&](const auto& element, const Material& m) {
        const Strains<dim, n> E = strains_at(element, gather<dim, n>(mesh_, u, c), m);
        for (int q = 0; q < n; ++q)
          sum += element.weight[q] * energy_of_strain<dim>(m, E[static_cast<std::size_t>(q)]);
      });
      sum *= share(c);
    };
    sum_over_cells(mesh_.n_cells(), 0.0, compute, [&](int, double sum) { energy += sum; });
    return mesh_.division.sum(energy);
  });
}

template <int dim>
double Assembly<dim>::smallest_jacobian(const Eigen::VectorXd& u) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    constexpr int n = nodes;
    double smallest = 1;
    for (int c = 0; c < mesh_.n_cells(); ++c) {
      if (!is_large(of(c))) continue;
      const auto values = gather<dim, n>(mesh_, u, c);
      const Continuum<dim, n> element(mesh_, c, false);
      for (int q = 0; q < n; ++q) {
        const Tensor<dim> F = Tensor<dim>::Identity() + values * element.gradient(q);
        smallest = std::min(smallest, F.determinant());
      }
    }
    return mesh_.division.min(smallest);
  });
}

template <int dim>
Eigen::MatrixXd Assembly<dim>::cell_state(const Eigen::VectorXd& u, int cell) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) -> Eigen::MatrixXd {
    constexpr int n = nodes;
    const auto values = gather<dim, n>(mesh_, u, cell);
    const Continuum<dim, n> place(mesh_, cell, false);
    Eigen::MatrixXd state(n_state, n);
    with_element<n>(cell, [&](const auto& element, const Material& m) {
      const Strains<dim, n> E = strains_at(element, values, m);
      for (int q = 0; q < n; ++q) {
        const Tensor<dim>& strain = E[static_cast<std::size_t>(q)];
        const Eigen::Matrix3d stress = cauchy_stress<dim>(m, values * place.gradient(q), strain);
        state.col(q) << stress(0, 0), stress(0, 1), stress(0, 2), stress(1, 1), stress(1, 2), stress(2, 2),
            energy_of_strain<dim>(m, strain);
      }
    });
    return share(cell) * state;
  });
}

template double Assembly<2>::strain_energy(const Eigen::VectorXd&) const;
template double Assembly<2>::smallest_jacobian(const Eigen::VectorXd&) const;
template Eigen::MatrixXd Assembly<2>::cell_state(const Eigen::VectorXd&, int) const;
template double Assembly<3>::strain_energy(const Eigen::VectorXd&) const;
template double Assembly<3>::smallest_jacobian(const Eigen::VectorXd&) const;
template Eigen::MatrixXd Assembly<3>::cell_state(const Eigen::VectorXd&, int) const;

}  // namespace strake::structure::fem
