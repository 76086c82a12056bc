#include "structure/fem/element/assembly.hpp"

#include "structure/fem/element/energy_balance.hpp"
#include "structure/fem/element/enhanced.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace strake::structure::fem {
namespace {

/// Where the mid-point's stress itself does not work the change of energy.
bool balances_energy(const Material& m, double alpha) {
  return m.model == MaterialModel::neo_hookean && alpha == 0.5;
}

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
  const Eigen::MatrixXd right = enhanced.stiffness(m, E).ldlt().solve(L1.transpose());
  local.noalias() -= L_alpha * right;
}

/// Cauchy stress σ = F S Fᵀ / det F [Pa]. Out of the plane F = 1 and S_zz = λ tr E, neo-Hookean λ ln J.
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
Assembly<dim>::Assembly(const Mesh<dim>& mesh, const std::vector<Part>& parts, StrainField strain)
    : mesh_(mesh), part_(parts) {
  for (const Part& part : parts) {
    eroded_.push_back(part.material);
    eroded_.back().model = MaterialModel::linear;
    const bool locks = mesh.degree == 1 || part.material.poisson >= incompressible;
    enhanced_.push_back(
        strain == StrainField::enhanced ||
        (strain == StrainField::automatic && locks && part.material.model != MaterialModel::neo_hookean));
  }
  // Nodes that share a cell, ascending.
  const int per_cell = static_cast<int>(mesh.cell.rows());
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(mesh.n_nodes()));
  for (int c = 0; c < mesh.n_cells(); ++c)
    for (int a = 0; a < per_cell; ++a)
      for (int b = 0; b < per_cell; ++b)
        neighbours[static_cast<std::size_t>(mesh.cell(a, c))].push_back(mesh.cell(b, c));
  std::vector<Eigen::Triplet<double>> entries;
  for (int a = 0; a < mesh.n_nodes(); ++a) {
    auto& row = neighbours[static_cast<std::size_t>(a)];
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    for (int i = 0; i < dim; ++i)
      for (const int b : row)
        for (int j = 0; j < dim; ++j) entries.emplace_back(dim * a + i, dim * b + j, 0.0);
  }
  pattern_.resize(mesh.n_unknowns(), mesh.n_unknowns());
  pattern_.setFromTriplets(entries.begin(), entries.end());
  pattern_.makeCompressed();
  slot_.reserve(static_cast<std::size_t>(mesh.n_cells() * per_cell * per_cell));
  for (int c = 0; c < mesh.n_cells(); ++c)
    for (int a = 0; a < per_cell; ++a) {
      const auto& row = neighbours[static_cast<std::size_t>(mesh.cell(a, c))];
      for (int b = 0; b < per_cell; ++b)
        slot_.push_back(
            dim * static_cast<int>(std::lower_bound(row.begin(), row.end(), mesh.cell(b, c)) - row.begin()));
    }
}

template <int dim>
Eigen::VectorXd Assembly<dim>::internal_force(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1,
                                              double alpha) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    constexpr int n = nodes;
    const CellView<dim, n> view{mesh_};
    Eigen::VectorXd force = Eigen::VectorXd::Zero(mesh_.n_unknowns());
    for (int c = 0; c < mesh_.n_cells(); ++c) {
      const Material& m = of(c);
      const bool large = is_large(m);
      const auto values0 = view.gather(u0, c), values1 = view.gather(u1, c);
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
      typename CellView<dim, n>::Values sum = CellView<dim, n>::Values::Zero();
      for (int q = 0; q < n; ++q) {
        const auto at = static_cast<std::size_t>(q);
        Tensor<dim> P = S[at];
        if (large) P += H[at] * S[at];
        sum.noalias() += (share(c) * weight[q] * P) * view.gradient(c * n + q).transpose();
      }
      for (int a = 0; a < n; ++a) force.template segment<dim>(dim * mesh_.cell(a, c)) += sum.col(a);
    }
    return force;
  });
}

template <int dim>
template <class Visit>
Matrix Assembly<dim>::scatter(const Visit& cell_matrix) const {
  Matrix result = pattern_;
  double* value = result.valuePtr();
  const int* row_begin = result.outerIndexPtr();
  const int per_cell = static_cast<int>(mesh_.cell.rows());
  std::size_t slot = 0;
  for (int c = 0; c < mesh_.n_cells(); ++c) {
    const auto& local = cell_matrix(c);
    for (int a = 0; a < per_cell; ++a)
      for (int b = 0; b < per_cell; ++b, ++slot)
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            value[row_begin[dim * mesh_.cell(a, c) + i] + slot_[slot] + j] += local(dim * a + i, dim * b + j);
  }
  return result;
}

// Computes the derivative of F_α S_α g_a by component j of node b. With g_a = ∇N_a and F_i the row i of F it
// is
//   δ_ij g_a·S_α g_b + λ (F_αi·g_a)(F_1j·g_b) + μ [(F_αi·F_1j)(g_a·g_b) + (F_αi·g_b)(F_1j·g_a)].
// Neo-Hookean: ∂S/∂E = λ B⊗B + 2(μ − λ ln J) B⊙B with B = C_α⁻¹ replaces λ 1⊗1 + 2μ 1⊙1, so that B stands
// between each F and g. The term that balances its energy is added; with enhanced strains it is left out.
template <int dim>
Matrix Assembly<dim>::tangent(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1, double alpha) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    constexpr int n = nodes;
    const CellView<dim, n> view{mesh_};
    Eigen::Matrix<double, dim * n, dim * n> local;
    return scatter([&](int c) -> const auto& {
      const Material& m = of(c);
      const bool large = is_large(m);
      const auto values0 = view.gather(u0, c), values1 = view.gather(u1, c);
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
      local.setZero();
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
      return local;
    });
  });
}

template <int dim>
template <int n>
std::array<Tensor<dim>, static_cast<std::size_t>(n)> Assembly<dim>::strains(const Eigen::VectorXd& u,
                                                                            int cell) const {
  const CellView<dim, n> view{mesh_};
  const Material& m = of(cell);
  const auto values = view.gather(u, cell);
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
    for (int c = 0; c < mesh_.n_cells(); ++c) {
      const Strains<dim, n> E = strains<n>(u, c);
      double sum = 0;
      for (int q = 0; q < n; ++q)
        sum += mesh_.weight(c * n + q) * energy_of_strain<dim>(of(c), E[static_cast<std::size_t>(q)]);
      energy += share(c) * sum;
    }
    return energy;
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
    return smallest;
  });
}

template <int dim>
Matrix Assembly<dim>::mass() const {
  const auto n = mesh_.cell.rows();
  Eigen::MatrixXd local(dim * n, dim * n);
  return scatter([&](int c) -> const Eigen::MatrixXd& {
    const double density = of(c).density;
    local.setZero();
    for (int q = 0; q < mesh_.n_quadrature; ++q) {
      const double weight = density * mesh_.weight(c * mesh_.n_quadrature + q);
      for (Eigen::Index a = 0; a < n; ++a)
        for (Eigen::Index b = 0; b < n; ++b)
          for (int i = 0; i < dim; ++i)
            local(dim * a + i, dim * b + i) += weight * mesh_.shape(a, q) * mesh_.shape(b, q);
    }
    return local;
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

template <int dim>
void Assembly<dim>::damage(Eigen::VectorXd held) {
  assert(!any_enhanced());
  held_ = std::move(held);
}

template class Assembly<2>;
template class Assembly<3>;

}  // namespace strake::structure::fem
