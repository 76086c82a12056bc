#include "structure/fem/element/assembly.hpp"
#include "structure/fem/element/cell_sums.hpp"
#include "structure/fem/element/energy_balance.hpp"
#include "structure/fem/element/enhanced.hpp"
#include "structure/fem/element/solid_shell.hpp"

#include <array>

namespace strake::structure::fem {

template <int dim>
Eigen::VectorXd Assembly<dim>::internal_force(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1,
                                              double alpha) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    constexpr int n = nodes;
    const CellView<dim, n> view{mesh_};
    Eigen::VectorXd force = Eigen::VectorXd::Zero(mesh_.n_unknowns());
    using Values = typename CellView<dim, n>::Values;
    const auto add = [&](int c, const Values& sum) {
      for (int a = 0; a < n; ++a) force.template segment<dim>(dim * mesh_.cell(a, c)) += sum.col(a);
    };
    const auto compute = [&](int c, Values& sum) {
      const Material& m = of(c);
      const bool large = is_large(m);
      const auto values0 = view.gather(u0, c), values1 = view.gather(u1, c);
      if constexpr (dim == 3 && n == SolidShell::n)
        if (const int thin = thin_axis(c); thin >= 0) {
          sum = SolidShell(mesh_, c, thin).force(values0, values1, alpha, m);
          return;
        }
      const double* weight = mesh_.weight.data() + c * n;
      Strains<dim, n> H, E, E0, E1, change, S;
      for (int q = 0; q < n; ++q) {
        const auto at = static_cast<std::size_t>(q);
        const auto gradient = view.gradient(c * n + q);
        const Tensor<dim> H0 = values0 * gradient, H1 = values1 * gradient;
        E0[at] = strain_of<dim>(H0, large);
        E1[at] = strain_of<dim>(H1, large);
        H[at] = alpha * H0 + (1 - alpha) * H1;
        E[at] = alpha * E0[at] + (1 - alpha) * E1[at];
        change[at] = E1[at] - E0[at];
      }
      const bool balances = balances_energy(m, alpha);
      if (is_enhanced(c)) {
        const EnhancedStrain<dim, n> enhanced(mesh_, c);
        enhanced.add_to(E, m);
        if (balances) enhanced.add_to(E0, m);
        if (balances) enhanced.add_to(E1, m);
      }
      for (std::size_t q = 0; q < S.size(); ++q) S[q] = second_piola_kirchhoff<dim>(m, E[q]);
      if (balances) {
        const auto balance = is_enhanced(c) ? EnergyBalance<dim, n>(S, m, change, E0, E1, weight)
                                            : EnergyBalance<dim, n>(E0, E1, m, weight);
        for (std::size_t q = 0; q < S.size(); ++q) S[q] += balance.part * change[q];
      }
      sum.setZero();
      for (int q = 0; q < n; ++q) {
        const auto at = static_cast<std::size_t>(q);
        Tensor<dim> P = S[at];
        if (large) P += H[at] * S[at];
        sum.noalias() += (share(c) * weight[q] * P) * view.gradient(c * n + q).transpose();
      }
    };
    sum_over_cells(mesh_.n_cells(), Values(), compute, add);
    return force;
  });
}

template Eigen::VectorXd Assembly<2>::internal_force(const Eigen::VectorXd&, const Eigen::VectorXd&,
                                                     double) const;
template Eigen::VectorXd Assembly<3>::internal_force(const Eigen::VectorXd&, const Eigen::VectorXd&,
                                                     double) const;

}  // namespace strake::structure::fem
