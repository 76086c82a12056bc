#include "structure/fem/mesh.hpp"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_tools.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q1.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "proto/error.hpp"
#include "structure/fem/grading.hpp"

namespace strake::structure::fem {
namespace {

// Cell sizes along the plate, chosen on the clamped strips of VALIDATION B1: finer changes f1 by less than
// 0.05 %.
constexpr double smallest_size = 0.5;      // [cell height] at a held end
constexpr double size_growth = 0.25;       // per length
constexpr double largest_size = 0.5;       // [thickness] away from the ends
constexpr double largest_part = 1 / 32.0;  // [length]

}  // namespace

template <int dim>
struct Discretisation<dim>::Parts {
  explicit Parts(int degree) : element(degree), dofs(triangulation) {}
  dealii::Triangulation<dim> triangulation;
  dealii::FE_Q<dim> element;
  dealii::MappingQ1<dim> mapping;
  dealii::DoFHandler<dim> dofs;
  std::vector<unsigned int> lexicographic;  // place in the cell's unknowns of each lexicographic node
};

template <int dim>
Discretisation<dim>::Discretisation(const Plate& plate, int degree, int refinement)
    : parts_(std::make_unique<Parts>(degree)) {
  static_assert(dim == 2, "a plate is a rectangle: a slab needs its width");
  Parts& parts = *parts_;

  // 1. The rectangle, divided evenly through the thickness and graded along the length.
  const double half = plate.length / 2;
  const dealii::Point<dim> low(plate.bottom.x() - half, plate.bottom.y());
  const dealii::Point<dim> high(plate.bottom.x() + half, plate.bottom.y() + plate.thickness);
  const int through = 1 << refinement;
  const double height = plate.thickness / through;
  Grading grading{.smallest = smallest_size * height, .growth = size_growth};
  grading.largest =
      std::max(grading.smallest, std::min(largest_size * plate.thickness, largest_part * plate.length));
  grading.left = plate.left != Support::free;
  grading.right = plate.right != Support::free;
  const std::vector<std::vector<double>> sizes{
      graded_cells(plate.length, grading), std::vector<double>(static_cast<std::size_t>(through), height)};
  dealii::GridGenerator::subdivided_hyper_rectangle(parts.triangulation, sizes, low, high, true);

  // 2. The Lagrange element and its nodes.
  parts.dofs.distribute_dofs(parts.element);
  parts.lexicographic =
      dealii::FETools::lexicographic_to_hierarchic_numbering<dim>(static_cast<unsigned int>(degree));
  const unsigned int per_cell = parts.element.n_dofs_per_cell();
  const auto n_cells = static_cast<Eigen::Index>(parts.triangulation.n_active_cells());
  const auto n_nodes = static_cast<Eigen::Index>(parts.dofs.n_dofs());

  // 3. Shape values and gradients: Gauss with degree + 1 points is exact for the mass matrix and for Saint
  //    Venant–Kirchhoff up to the quartic terms, which vanish with the strain.
  const dealii::QGauss<dim> quadrature(static_cast<unsigned int>(degree) + 1);
  const dealii::QGauss<dim - 1> face_quadrature(static_cast<unsigned int>(degree) + 1);
  const dealii::Quadrature<dim> nodes(parts.element.get_unit_support_points());
  using namespace dealii;  // the update flags' operator|
  FEValues<dim> inside(parts.mapping, parts.element, quadrature,
                       update_values | update_gradients | update_JxW_values);
  FEValues<dim> in_nodes(parts.mapping, parts.element, nodes, update_gradients | update_quadrature_points);
  FEFaceValues<dim> on_face(parts.mapping, parts.element, face_quadrature, update_values | update_JxW_values);

  mesh_.degree = degree;
  mesh_.n_quadrature = static_cast<int>(quadrature.size());
  mesh_.node.resize(dim, n_nodes);
  mesh_.cell.resize(per_cell, n_cells);
  mesh_.gradient.resize(per_cell * dim, n_cells * mesh_.n_quadrature);
  mesh_.node_gradient.resize(per_cell * dim, n_cells * per_cell);
  mesh_.weight.resize(n_cells * mesh_.n_quadrature);
  mesh_.shape.resize(per_cell, mesh_.n_quadrature);
  for (auto& face : mesh_.face) face = Eigen::VectorXd::Zero(n_nodes);

  std::vector<types::global_dof_index> index(per_cell);
  Eigen::Index c = 0;
  for (const auto& cell : parts.dofs.active_cell_iterators()) {
    inside.reinit(cell);
    in_nodes.reinit(cell);
    cell->get_dof_indices(index);
    for (unsigned int a = 0; a < per_cell; ++a) {
      const unsigned int place = parts.lexicographic[a];
      const auto node = static_cast<Eigen::Index>(index[place]);
      mesh_.cell(a, c) = static_cast<int>(node);
      for (unsigned int k = 0; k < dim; ++k) {
        mesh_.node(k, node) = in_nodes.quadrature_point(place)[k];
        for (unsigned int q = 0; q < quadrature.size(); ++q)
          mesh_.gradient(k * per_cell + a, c * mesh_.n_quadrature + q) = inside.shape_grad(place, q)[k];
        for (unsigned int b = 0; b < per_cell; ++b)
          mesh_.node_gradient(k * per_cell + a, c * per_cell + b) =
              in_nodes.shape_grad(place, parts.lexicographic[b])[k];
      }
      for (unsigned int q = 0; q < quadrature.size(); ++q) mesh_.shape(a, q) = inside.shape_value(place, q);
    }
    for (unsigned int q = 0; q < quadrature.size(); ++q)
      mesh_.weight(c * mesh_.n_quadrature + q) = inside.JxW(q);
    for (const unsigned int f : cell->face_indices()) {
      if (!cell->face(f)->at_boundary()) continue;
      on_face.reinit(cell, f);
      Eigen::VectorXd& sum = mesh_.face[cell->face(f)->boundary_id()];
      for (unsigned int q = 0; q < face_quadrature.size(); ++q)
        for (unsigned int a = 0; a < per_cell; ++a)
          sum(static_cast<Eigen::Index>(index[a])) += on_face.shape_value(a, q) * on_face.JxW(q);
    }
    ++c;
  }

  // 4. Supports: all of an end face, or its node at mid-height.
  const double near = 1e-6 * height;
  const double middle = plate.bottom.y() + plate.thickness / 2;
  const auto hold = [&](Support support, double x) {
    if (support == Support::free) return;
    const std::size_t before = mesh_.fixed.size();
    for (int i = 0; i < mesh_.n_nodes(); ++i) {
      const bool on_end = std::abs(mesh_.node(0, i) - x) < near;
      if (!on_end || (support == Support::pinned && std::abs(mesh_.node(1, i) - middle) > near)) continue;
      for (int k = 0; k < dim; ++k) mesh_.fixed.push_back(dim * i + k);
    }
    if (mesh_.fixed.size() == before)
      throw Error(ExitCode::case_file, "structure.plate.supports",
                  "a pinned end needs a node at mid-height, and one layer of linear cells has none",
                  "structure.fem.refinement = 1 or more");
  };
  hold(plate.left, low[0]);
  hold(plate.right, high[0]);
  std::sort(mesh_.fixed.begin(), mesh_.fixed.end());
}

template <int dim>
Discretisation<dim>::~Discretisation() = default;

template <int dim>
NodeWeights Discretisation<dim>::shape_values(const Eigen::Vector3d& X) const {
  const Parts& parts = *parts_;
  dealii::Point<dim> x;
  for (unsigned int k = 0; k < dim; ++k) x[k] = X(k);

  // A linear search over the cells: once per point at set-up.
  typename dealii::DoFHandler<dim>::active_cell_iterator nearest;
  dealii::Point<dim> unit;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& cell : parts.dofs.active_cell_iterators()) {
    if (cell->barycenter().distance(x) - cell->diameter() > least) continue;
    const dealii::Point<dim> candidate =
        dealii::GeometryInfo<dim>::project_to_unit_cell(parts.mapping.transform_real_to_unit_cell(cell, x));
    const double distance = parts.mapping.transform_unit_to_real_cell(cell, candidate).distance(x);
    if (distance >= least) continue;
    least = distance;
    nearest = cell;
    unit = candidate;
    if (distance == 0) break;
  }
  std::vector<dealii::types::global_dof_index> index(parts.element.n_dofs_per_cell());
  nearest->get_dof_indices(index);
  NodeWeights weights;
  for (unsigned int a = 0; a < index.size(); ++a)
    weights.emplace_back(static_cast<int>(index[a]), parts.element.shape_value(a, unit));
  return weights;
}

std::string library() {
  return "deal.II " DEAL_II_PACKAGE_VERSION;
}

template class Discretisation<2>;

}  // namespace strake::structure::fem
