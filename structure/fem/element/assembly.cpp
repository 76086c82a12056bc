#include "structure/fem/element/assembly.hpp"

#include "structure/fem/element/cell_step.hpp"
#include "structure/fem/element/cell_sums.hpp"

#include <deal.II/lac/dynamic_sparsity_pattern.h>

#include <cassert>
#include <utility>
#include <vector>

namespace strake::structure::fem {

template <int dim>
Assembly<dim>::Assembly(const Mesh<dim>& mesh, const std::vector<Part>& parts, StrainField strain)
    : mesh_(mesh), part_(parts) {
  for (const Part& part : parts) {
    eroded_.push_back(part.material);
    eroded_.back().model = MaterialModel::linear;
    const bool locks = mesh.degree == 1 || part.material.poisson >= incompressible;
    enhanced_.push_back(
        strain == StrainField::enhanced || strain == StrainField::solid_shell ||
        (strain == StrainField::automatic && locks && part.material.model != MaterialModel::neo_hookean));
  }
  if constexpr (dim == 3)
    if (strain == StrainField::solid_shell) thin_ = thin_axes(mesh);
  // Nodes that share a cell, and between them a block of components.
  const auto n_nodes = static_cast<unsigned int>(mesh.n_nodes());
  dealii::DynamicSparsityPattern near(n_nodes, n_nodes);
  for (const auto& cell : mesh.cell.colwise()) {
    const std::vector<unsigned int> nodes(cell.begin(), cell.end());
    for (const unsigned int node : nodes) near.add_entries(node, nodes.begin(), nodes.end());
  }
  pattern_.resize(mesh.n_unknowns(), mesh.n_unknowns());
  pattern_.resizeNonZeros(dim * dim * static_cast<Eigen::Index>(near.n_nonzero_elements()));
  int *row_begin = pattern_.outerIndexPtr(), *column = pattern_.innerIndexPtr();
  for (unsigned int node = 0; node < n_nodes; ++node)
    for (int i = 0; i < dim; ++i) {
      for (auto entry = near.begin(node); entry != near.end(node); ++entry)
        for (int j = 0; j < dim; ++j) *column++ = dim * static_cast<int>(entry->column()) + j;
      *++row_begin = static_cast<int>(column - pattern_.innerIndexPtr());
    }
  pattern_.coeffs().setZero();
}

template <int dim>
template <class Local, class Compute>
Matrix Assembly<dim>::scatter(const Local& sample, const Compute& compute) const {
  Matrix result = pattern_;
  const int* const row_begin = result.outerIndexPtr();
  sum_over_cells(mesh_.n_cells(), sample, compute, [&](int c, const Local& local) {
    const auto nodes = mesh_.cell.col(c);
    for (int a = 0; a < nodes.size(); ++a)
      for (int b = 0; b < nodes.size(); ++b) {
        const int row = dim * nodes(a);
        double* const block = &result.coeffRef(row, dim * nodes(b));  // the rows of a node have one pattern
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            block[row_begin[row + i] - row_begin[row] + j] += local(dim * a + i, dim * b + j);
      }
  });
  return result;
}

template <int dim>
Eigen::VectorXd Assembly<dim>::internal_force(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1,
                                              double alpha) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    constexpr int n = nodes;
    using Values = NodeValues<dim, n>;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(mesh_.n_unknowns());
    const auto compute = [&](int c, Values& sum) {
      sum = share(c) * with_element<n>(c, [&](const auto& element, const Material& m) {
              return force_of_step(element, gather<dim, n>(mesh_, u0, c), gather<dim, n>(mesh_, u1, c), alpha,
                                   m);
            });
    };
    sum_over_cells(mesh_.n_cells(), Values(), compute, [&](int c, const Values& sum) {
      for (int a = 0; a < n; ++a) force.template segment<dim>(dim * mesh_.cell(a, c)) += sum.col(a);
    });
    return force;
  });
}

template <int dim>
Matrix Assembly<dim>::tangent(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1, double alpha) const {
  return with_nodes<dim>(mesh_.degree, [&](auto nodes) {
    constexpr int n = nodes;
    using Local = Eigen::Matrix<double, dim * n, dim * n>;
    return scatter(Local(), [&](int c, Local& local) {
      with_element<n>(c, [&](const auto& element, const Material& m) {
        tangent_of_step(element, gather<dim, n>(mesh_, u0, c), gather<dim, n>(mesh_, u1, c), alpha, m, local);
      });
      local *= share(c);
    });
  });
}

template <int dim>
Matrix Assembly<dim>::mass() const {
  const auto n = mesh_.cell.rows();
  return scatter(Eigen::MatrixXd(dim * n, dim * n), [&](int c, Eigen::MatrixXd& local) {
    const double density = of(c).density;
    local.setZero();
    for (int q = 0; q < mesh_.n_quadrature; ++q) {
      const double weight = density * mesh_.weight(c * mesh_.n_quadrature + q);
      for (Eigen::Index a = 0; a < n; ++a)
        for (Eigen::Index b = 0; b < n; ++b)
          for (int i = 0; i < dim; ++i)
            local(dim * a + i, dim * b + i) += weight * mesh_.shape(a, q) * mesh_.shape(b, q);
    }
  });
}

template <int dim>
int Assembly<dim>::shells() const {
  int count = 0;
  for (int c = 0; c < mesh_.n_cells(); ++c) count += thin_axis(c) >= 0 && mesh_.owns(c) ? 1 : 0;
  return static_cast<int>(mesh_.division.sum(count));
}

template <int dim>
void Assembly<dim>::damage(Eigen::VectorXd integrity) {
  assert(!any_enhanced());
  integrity_ = std::move(integrity);
}

template class Assembly<2>;
template class Assembly<3>;

}  // namespace strake::structure::fem
