#include "structure/fem/element/assembly.hpp"
#include "structure/fem/element/cell_sums.hpp"
#include "structure/fem/element/energy_balance.hpp"
#include "structure/fem/element/enhanced.hpp"
#include "structure/fem/element/solid_shell.hpp"

#include <array>

namespace strake::structure::fem {
namespace {

/// −Lᵅ H⁻¹ L1ᵀ: what the added strains take from a cell's stiffness, with L(k; a) = Σ w F (∂S/∂E:G_k) g_a.
template <int dim, int n, class Local>
void soften(Local& local, const EnhancedStrain<dim, n>& enhanced, const CellView<dim, n>& view, int cell,
            const Material& m, const Strains<dim, n>& E, const Strains<dim, n>& F_alpha,
            const Strains<dim, n>& F1) {
  constexpr int modes = EnhancedStrain<dim, n>::modes;
  Eigen::MatrixXd L_alpha = Eigen::MatrixXd::Zero(dim * n, modes), L1 = L_alpha;
  for (int q = 0; q < n; ++q) {
    const auto at = static_cast<std::size_t>(q);
    const auto g = view.gradient(cell * n + q);
    const auto stress = (view.mesh.weight(cell * n + q) * moduli<dim>(m, E[at]) * enhanced.at(q)).eval();
    for (int k = 0; k < modes; ++k) {
      const Eigen::Matrix<double, dim, n> Tg = stress_tensor<dim>(stress.col(k)) * g.transpose();
      Eigen::Map<Eigen::Matrix<double, dim, n>>(L_alpha.col(k).data()).noalias() += F_alpha[at] * Tg;
      Eigen::Map<Eigen::Matrix<double, dim, n>>(L1.col(k).data()).noalias() += F1[at] * Tg;
    }
  }
  local -= condensed(L_alpha, enhanced.stiffness(m, E), L1);
}

/// Adds the tangent of a solid shell; false where the cell is none.
template <int dim, int n, class Local, class Values>
bool add_shell(Local& local, const Mesh<dim>& mesh, int cell, int thin, const Values& u0, const Values& u1,
               double alpha, const Material& m) {
  if constexpr (dim == 3 && n == SolidShell::n) {
    if (thin >= 0) SolidShell(mesh, cell, thin).add_tangent(local, u0, u1, alpha, m);
    return thin >= 0;
  }
  return false;
}

}  // namespace

// With g_a = ∇N_a and F_i the row i of F, the derivative of F_α S_α g_a by component j of node b is
//   δ_ij g_a·S_α g_b + λ (F_αi·g_a)(F_1j·g_b) + μ [(F_αi·F_1j)(g_a·g_b) + (F_αi·g_b)(F_1j·g_a)].
// Neo-Hookean: ∂S/∂E = λ B⊗B + 2(μ − λ ln J) B⊙B with B = C_α⁻¹ stands in place of λ 1⊗1 + 2μ 1⊙1, which puts
// B between each F and g, and what balances its energy adds its own; with added strains that is left out.
template <int dim>
Matrix Assembly<dim>::tangent(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1, double alpha) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    constexpr int n = nodes;
    const CellView<dim, n> view{mesh_};
    using Local = Eigen::Matrix<double, dim * n, dim * n>;
    return scatter(Local(), [&](int c, Local& local) {
      const Material& m = of(c);
      const bool large = is_large(m);
      const auto values0 = view.gather(u0, c), values1 = view.gather(u1, c);
      local.setZero();
      if (add_shell<dim, n>(local, mesh_, c, thin_axis(c), values0, values1, alpha, m)) return;
      Strains<dim, n> E, E0, E1, F_of_alpha, F_of_1;
      for (int q = 0; q < n; ++q) {
        const auto at = static_cast<std::size_t>(q), g = static_cast<std::size_t>(c) * n + at;
        const Tensor<dim> H0 = values0 * view.gradient(static_cast<int>(g)),
                          H1 = values1 * view.gradient(static_cast<int>(g));
        F_of_alpha[at] = F_of_1[at] = Tensor<dim>::Identity();
        if (large) F_of_alpha[at] += alpha * H0 + (1 - alpha) * H1;
        if (large) F_of_1[at] += H1;
        E0[at] = strain_of<dim>(H0, large);
        E1[at] = strain_of<dim>(H1, large);
        E[at] = alpha * E0[at] + (1 - alpha) * E1[at];
      }
      if (is_enhanced(c)) {
        const EnhancedStrain<dim, n> enhanced(mesh_, c);
        enhanced.add_to(E, m);
        soften<dim, n>(local, enhanced, view, c, m, E, F_of_alpha, F_of_1);
      } else if (balances_energy(m, alpha)) {
        add_balance_tangent<dim, n>(local, view, c, m, E0, E1, F_of_alpha, F_of_1);
        local *= share(c);
      }
      for (int q = 0; q < n; ++q) {
        const auto at = static_cast<std::size_t>(q);
        const auto g = view.gradient(c * n + q);
        const double weight = share(c) * mesh_.weight(c * n + q);
        const Tensor<dim>&F_alpha = F_of_alpha[at], &F1 = F_of_1[at];
        Tensor<dim> S = Tensor<dim>::Zero(), B = Tensor<dim>::Identity();
        double lambda = m.lame_lambda(), mu = m.lame_mu();
        if (large) S = second_piola_kirchhoff<dim>(m, E[at]);
        if (m.model == MaterialModel::neo_hookean) {
          B = Tensor<dim>(2 * E[at] + B).inverse();
          mu -= lambda * log_jacobian<dim>(E[at]);
        }
        const Tensor<dim> FB = F_alpha * B, F1B = F1 * B;
        const Eigen::Matrix<double, dim, n> f_alpha = FB * g.transpose(), f1 = F1B * g.transpose();
        const Tensor<dim> FF = FB * F1.transpose();
        const Eigen::Matrix<double, n, n> gg = weight * mu * g * B * g.transpose(),
                                          gSg = weight * g * S * g.transpose();
        for (int b = 0; b < n; ++b)
          for (int a = 0; a < n; ++a)
            for (int j = 0; j < dim; ++j)
              for (int i = 0; i < dim; ++i)
                local(dim * a + i, dim * b + j) +=
                    (i == j ? gSg(a, b) : 0.0) + FF(i, j) * gg(a, b) +
                    weight * (lambda * f_alpha(i, a) * f1(j, b) + mu * f_alpha(i, b) * f1(j, a));
      }
    });
  });
}

template Matrix Assembly<2>::tangent(const Eigen::VectorXd&, const Eigen::VectorXd&, double) const;
template Matrix Assembly<3>::tangent(const Eigen::VectorXd&, const Eigen::VectorXd&, double) const;

}  // namespace strake::structure::fem
