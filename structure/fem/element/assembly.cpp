#include "structure/fem/element/assembly.hpp"

#include "structure/fem/element/cell_sums.hpp"
#include "structure/fem/element/solid_shell.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

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
  // Nodes that share a cell, ascending.
  const int per_cell = static_cast<int>(mesh.cell.rows());
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(mesh.n_nodes()));
  for (int c = 0; c < mesh.n_cells(); ++c)
    for (int a = 0; a < per_cell; ++a)
      for (int b = 0; b < per_cell; ++b)
        neighbours[static_cast<std::size_t>(mesh.cell(a, c))].push_back(mesh.cell(b, c));
  pattern_.resize(mesh.n_unknowns(), mesh.n_unknowns());
  int* const begin = pattern_.outerIndexPtr();
  for (int a = 0; a < mesh.n_nodes(); ++a) {
    auto& row = neighbours[static_cast<std::size_t>(a)];
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    for (int i = dim * a; i < dim * (a + 1); ++i)
      begin[i + 1] = begin[i] + dim * static_cast<int>(row.size());
  }
  pattern_.resizeNonZeros(begin[mesh.n_unknowns()]);
  pattern_.coeffs().setZero();
  int* column = pattern_.innerIndexPtr();
  for (const auto& row : neighbours)
    for (int i = 0; i < dim; ++i)
      for (const int b : row)
        for (int j = 0; j < dim; ++j) *column++ = dim * b + j;
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
void Assembly<dim>::damage(Eigen::VectorXd integrity) {
  assert(!any_enhanced());
  integrity_ = std::move(integrity);
}

template class Assembly<2>;
template class Assembly<3>;

}  // namespace strake::structure::fem
