#include "structure/fem/assembly.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace strake::structure::fem {
namespace {

template <int dim>
using Tensor = Eigen::Matrix<double, dim, dim>;

template <int dim>
Tensor<dim> strain_of(const Tensor<dim>& gradient, bool large) {
  Tensor<dim> E = 0.5 * (gradient + gradient.transpose());
  if (large) E += 0.5 * gradient.transpose() * gradient;
  return E;
}

bool is_large(const Material& m) {
  return m.model != MaterialModel::linear;
}

/// S_zz [Pa] that plane strain needs: λ tr E, neo-Hookean λ ln J (out of the plane C⁻¹ = 1).
template <int dim>
double out_of_plane(const Material& m, const Tensor<dim>& E) {
  if (m.plane_stress) return 0;
  if (m.model != MaterialModel::neo_hookean) return m.lame_lambda() * E.trace();
  return m.lame_lambda() * log_jacobian<dim>(E);
}

/// S between two strains, so that at α = ½ its work is the change of energy.
template <int dim>
Tensor<dim> stress_between(const Material& m, const Tensor<dim>& E0, const Tensor<dim>& E1, double alpha) {
  Tensor<dim> S = second_piola_kirchhoff<dim>(m, Tensor<dim>(alpha * E0 + (1 - alpha) * E1));
  if (m.model != MaterialModel::neo_hookean || alpha != 0.5) return S;
  const Tensor<dim> change = E1 - E0;
  // ψ carries a round-off of ε |E| μ, so that the quotient is noise where ΔE is small; the addition is of
  // third order and nothing there.
  constexpr double noise = 1e-10;  // ΔE:ΔE
  S += (energy_of_strain<dim>(m, E1) - energy_of_strain<dim>(m, E0) - S.cwiseProduct(change).sum()) /
       (change.squaredNorm() + noise) * change;
  return S;
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

/// Calls `kernel` with the number of nodes per cell as a constant.
template <int dim, class Kernel>
auto with_nodes(int degree, const Kernel& kernel) {
  constexpr int linear = dim == 2 ? 4 : 8, quadratic = dim == 2 ? 9 : 27;
  assert(degree == 1 || degree == 2);
  return degree == 1 ? kernel(std::integral_constant<int, linear>{})
                     : kernel(std::integral_constant<int, quadratic>{});
}

}  // namespace

template <int dim>
Assembly<dim>::Assembly(const Mesh<dim>& mesh, const std::vector<Part>& parts) : mesh_(mesh), part_(parts) {
  for (const Part& part : parts) {
    eroded_.push_back(part.material);
    eroded_.back().model = MaterialModel::linear;
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
      const auto values0 = view.gather(u0, c), values1 = view.gather(u1, c);
      typename CellView<dim, n>::Values sum = CellView<dim, n>::Values::Zero();
      for (int q = c * mesh_.n_quadrature; q < (c + 1) * mesh_.n_quadrature; ++q) {
        const auto gradient = view.gradient(q);
        const Tensor<dim> H0 = values0 * gradient, H1 = values1 * gradient;
        const bool large = is_large(m);
        Tensor<dim> P = stress_between<dim>(m, strain_of<dim>(H0, large), strain_of<dim>(H1, large), alpha);
        if (large) P += ((alpha * H0 + (1 - alpha) * H1) * P).eval();
        sum.noalias() += (share(c) * mesh_.weight(q) * P) * gradient.transpose();
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

// With g_a = ∇N_a and F_i the row i of F, the derivative of F_α S_α g_a by component j of node b is
//   δ_ij g_a·S_α g_b + λ (F_αi·g_a)(F_1j·g_b) + μ [(F_αi·F_1j)(g_a·g_b) + (F_αi·g_b)(F_1j·g_a)].
// Neo-Hookean: ∂S/∂E = λ B⊗B + 2(μ − λ ln J) B⊙B with B = C_α⁻¹ stands in place of λ 1⊗1 + 2μ 1⊙1, which puts
// B between each F and g; Gonzalez' addition, of second order in the step, is left out of it.
template <int dim>
Matrix Assembly<dim>::tangent(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1, double alpha) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    constexpr int n = nodes;
    const CellView<dim, n> view{mesh_};
    Eigen::Matrix<double, dim * n, dim * n> local;
    return scatter([&](int c) -> const auto& {
      const Material& m = of(c);
      const auto values0 = view.gather(u0, c), values1 = view.gather(u1, c);
      local.setZero();
      for (int q = c * mesh_.n_quadrature; q < (c + 1) * mesh_.n_quadrature; ++q) {
        const auto g = view.gradient(q);
        const double weight = share(c) * mesh_.weight(q);
        Tensor<dim> F_alpha = Tensor<dim>::Identity(), F1 = F_alpha, S = Tensor<dim>::Zero(), B = F_alpha;
        double lambda = m.lame_lambda(), mu = m.lame_mu();
        if (is_large(m)) {
          const Tensor<dim> H0 = values0 * g, H1 = values1 * g;
          F_alpha += alpha * H0 + (1 - alpha) * H1;
          F1 += H1;
          const Tensor<dim> E = alpha * strain_of<dim>(H0, true) + (1 - alpha) * strain_of<dim>(H1, true);
          S = second_piola_kirchhoff<dim>(m, E);
          if (m.model == MaterialModel::neo_hookean) {
            const Tensor<dim> C = 2 * E + Tensor<dim>::Identity();
            B = C.inverse();
            mu -= lambda * log_jacobian<dim>(E);
          }
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
double Assembly<dim>::strain_energy(const Eigen::VectorXd& u) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    const CellView<dim, decltype(nodes)::value> view{mesh_};
    double energy = 0;
    for (int c = 0; c < mesh_.n_cells(); ++c) {
      const Material& m = of(c);
      const auto values = view.gather(u, c);
      for (int q = c * mesh_.n_quadrature; q < (c + 1) * mesh_.n_quadrature; ++q) {
        const Tensor<dim> E = strain_of<dim>(Tensor<dim>(values * view.gradient(q)), is_large(m));
        energy += share(c) * mesh_.weight(q) * energy_of_strain<dim>(m, E);
      }
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
Eigen::VectorXd Assembly<dim>::von_mises(const Eigen::VectorXd& u) const {
  const int n = static_cast<int>(mesh_.cell.rows());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(mesh_.n_nodes()), count = sum;
  Eigen::MatrixXd values(dim, n);
  for (int c = 0; c < mesh_.n_cells(); ++c) {
    const Material& m = of(c);
    for (int a = 0; a < n; ++a) values.col(a) = u.template segment<dim>(dim * mesh_.cell(a, c));
    for (int a = 0; a < n; ++a) {
      const Eigen::Map<const Eigen::MatrixXd> gradient(mesh_.node_gradient.col(c * n + a).data(), n, dim);
      const Tensor<dim> H = values * gradient;
      const Tensor<dim> E = strain_of<dim>(H, is_large(m));
      const Tensor<dim> S = second_piola_kirchhoff<dim>(m, E);
      Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
      if (dim == 2) stress(2, 2) = out_of_plane<dim>(m, E);
      if (is_large(m)) {
        const Tensor<dim> F = Tensor<dim>::Identity() + H;
        stress.template topLeftCorner<dim, dim>() = F * S * F.transpose();
        stress /= F.determinant();
      } else {
        stress.template topLeftCorner<dim, dim>() = S;
      }
      stress.diagonal().array() -= stress.trace() / 3;
      sum(mesh_.cell(a, c)) += share(c) * std::sqrt(1.5 * stress.squaredNorm());
      count(mesh_.cell(a, c)) += 1;
    }
  }
  return sum.cwiseQuotient(count);
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
      const Tensor<dim> H = values * view.gradient(q), E = strain_of<dim>(H, is_large(m)),
                        S = second_piola_kirchhoff<dim>(m, E);
      const double weight = mesh_.weight(q);
      Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
      if (dim == 2) stress(2, 2) = out_of_plane<dim>(m, E);
      stress.template topLeftCorner<dim, dim>() = S;
      if (is_large(m)) {
        const Tensor<dim> F = Tensor<dim>::Identity() + H;
        stress.template topLeftCorner<dim, dim>() = F * S * F.transpose();
        stress /= F.determinant();
      }
      mean.energy += weight * energy_of_strain<dim>(m, E);
      mean.stress += weight * stress;
      volume += weight;
    }
    mean.energy /= volume;
    mean.stress /= volume;
    return mean;
  });
}

template <int dim>
void Assembly<dim>::damage(Eigen::VectorXd held) {
  held_ = std::move(held);
}

template class Assembly<2>;
template class Assembly<3>;

}  // namespace strake::structure::fem
