#include "structure/fem/element/assembly.hpp"
#include "structure/fem/element/cell_sums.hpp"
#include "structure/fem/element/energy_balance.hpp"
#include "structure/fem/element/enhanced.hpp"
#include "structure/fem/element/solid_shell.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <array>

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

}  // namespace

template <int dim>
template <int n>
std::array<Tensor<dim>, static_cast<std::size_t>(n)> Assembly<dim>::strains(const Eigen::VectorXd& u,
                                                                            int cell) const {
  const CellView<dim, n> view{mesh_};
  const Material& m = of(cell);
  const auto values = view.gather(u, cell);
  if constexpr (dim == 3 && n == SolidShell::n)
    if (const int thin = thin_axis(cell); thin >= 0) return SolidShell(mesh_, cell, thin).strains(values, m);
  Strains<dim, n> E;
  for (int q = 0; q < n; ++q)
    E[static_cast<std::size_t>(q)] =
        strain_of<dim>(Tensor<dim>(values * view.gradient(cell * n + q)), is_large(m));
  if (is_enhanced(cell)) EnhancedStrain<dim, n>(mesh_, cell).add_to(E, m);
  return E;
}

template <int dim>
double Assembly<dim>::strain_energy(const Eigen::VectorXd& u) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    constexpr int n = nodes;
    double energy = 0;
    const auto compute = [&](int c, double& sum) {
      sum = 0;
      if (!mesh_.owns(c)) return;
      const Strains<dim, n> E = strains<n>(u, c);
      for (int q = 0; q < n; ++q)
        sum += mesh_.weight(c * n + q) * energy_of_strain<dim>(of(c), E[static_cast<std::size_t>(q)]);
    };
    sum_over_cells(mesh_.n_cells(), 0.0, compute, [&](int c, double sum) { energy += share(c) * sum; });
    return mesh_.division.sum(energy);
  });
}

template <int dim>
double Assembly<dim>::smallest_jacobian(const Eigen::VectorXd& u) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    const CellView<dim, decltype(nodes)::value> view{mesh_};
    double smallest = 1;
    for (int c = 0; c < mesh_.n_cells(); ++c) {
      if (!is_large(of(c))) continue;
      const auto values = view.gather(u, c);
      for (int q = c * mesh_.n_quadrature; q < (c + 1) * mesh_.n_quadrature; ++q) {
        const Tensor<dim> F = Tensor<dim>::Identity() + values * view.gradient(q);
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
    const CellView<dim, n> view{mesh_};
    const Material& m = of(cell);
    const auto values = view.gather(u, cell);
    const Strains<dim, n> E = strains<n>(u, cell);
    Eigen::MatrixXd state(n_state, n);
    for (int q = 0; q < n; ++q) {
      const Tensor<dim>& strain = E[static_cast<std::size_t>(q)];
      const Tensor<dim> H = values * view.gradient(cell * n + q);
      const Eigen::Matrix3d stress = share(cell) * cauchy_stress<dim>(m, H, strain);
      state.col(q) << stress(0, 0), stress(0, 1), stress(0, 2), stress(1, 1), stress(1, 2), stress(2, 2),
          share(cell) * energy_of_strain<dim>(m, strain);
    }
    return state;
  });
}

template <int dim>
CellMean<dim> Assembly<dim>::mean(const Eigen::VectorXd& u, int c) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    const CellView<dim, decltype(nodes)::value> view{mesh_};
    const Material& m = material(c);
    const auto values = view.gather(u, c);
    CellMean<dim> mean;
    double volume = 0;
    for (int q = c * mesh_.n_quadrature; q < (c + 1) * mesh_.n_quadrature; ++q) {
      const Tensor<dim> H = values * view.gradient(q), E = strain_of<dim>(H, is_large(m));
      const double weight = mesh_.weight(q);
      mean.energy += weight * energy_of_strain<dim>(m, E);
      mean.stress += weight * cauchy_stress<dim>(m, H, E);
      volume += weight;
    }
    mean.energy /= volume;
    mean.stress /= volume;
    return mean;
  });
}

template double Assembly<2>::strain_energy(const Eigen::VectorXd&) const;
template double Assembly<2>::smallest_jacobian(const Eigen::VectorXd&) const;
template Eigen::MatrixXd Assembly<2>::cell_state(const Eigen::VectorXd&, int) const;
template CellMean<2> Assembly<2>::mean(const Eigen::VectorXd&, int) const;
template double Assembly<3>::strain_energy(const Eigen::VectorXd&) const;
template double Assembly<3>::smallest_jacobian(const Eigen::VectorXd&) const;
template Eigen::MatrixXd Assembly<3>::cell_state(const Eigen::VectorXd&, int) const;
template CellMean<3> Assembly<3>::mean(const Eigen::VectorXd&, int) const;

}  // namespace strake::structure::fem
