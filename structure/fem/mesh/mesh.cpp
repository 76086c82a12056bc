#include "structure/fem/mesh/mesh.hpp"

#include "proto/error.hpp"
#include "structure/fem/mesh/refinement.hpp"

#include <Eigen/LU>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_tools.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q1.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace strake::structure::fem {
namespace {

template <int dim>
dealii::Point<dim> point(const Eigen::Vector3d& X) {
  dealii::Point<dim> x;
  for (unsigned int k = 0; k < dim; ++k) x[k] = X(k);
  return x;
}

template <int dim>
Eigen::Vector3d in_space(const dealii::Point<dim>& x) {
  Eigen::Vector3d X = Eigen::Vector3d::Zero();
  for (unsigned int k = 0; k < dim; ++k) X(k) = x[k];
  return X;
}

/// The cells as deal.II takes them; the part stands in the material's number.
template <int dim>
void create(dealii::Triangulation<dim>& triangulation, const Solid& cells) {
  std::vector<dealii::Point<dim>> vertices;
  for (Eigen::Index i = 0; i < cells.node.cols(); ++i) vertices.push_back(point<dim>(cells.node.col(i)));
  std::vector<dealii::CellData<dim>> data(static_cast<std::size_t>(cells.cell.cols()));
  for (std::size_t c = 0; c < data.size(); ++c) {
    for (unsigned int k = 0; k < cells.cell.rows(); ++k)
      data[c].vertices[k] = static_cast<unsigned int>(cells.cell(k, static_cast<Eigen::Index>(c)));
    data[c].material_id = static_cast<dealii::types::material_id>(cells.part_of[c]);
  }
  if (!cells.along_axes()) dealii::GridTools::consistently_order_cells(data);
  triangulation.create_triangulation(vertices, data, {});
}

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
Discretisation<dim>::Discretisation(const Solid& solid, int degree, int refinement, double along)
    : solid_(solid), parts_(std::make_unique<Parts>(degree)) {
  assert(solid.dimension == dim);
  create(parts_->triangulation, refined(solid, refinement, along));
  parts_->dofs.distribute_dofs(parts_->element);
  parts_->lexicographic =
      dealii::FETools::lexicographic_to_hierarchic_numbering<dim>(static_cast<unsigned int>(degree));
  copy_cells(degree);

  // Supports, and parts that are constrained as a whole.
  const double near = 1e-6 * std::ldexp(thinnest(solid), -refinement);
  for (const SupportedFace& face : solid.supported)
    if (face.support != Support::free) constrain(face, near);
  for (int cell = 0; cell < mesh_.n_cells(); ++cell)
    if (solid.parts[static_cast<std::size_t>(mesh_.part[static_cast<std::size_t>(cell)])].constrained)
      for (Eigen::Index a = 0; a < mesh_.cell.rows(); ++a)
        for (int k = 0; k < dim; ++k) mesh_.fixed.push_back(dim * mesh_.cell(a, cell) + k);
  std::sort(mesh_.fixed.begin(), mesh_.fixed.end());
  mesh_.fixed.erase(std::unique(mesh_.fixed.begin(), mesh_.fixed.end()), mesh_.fixed.end());
}

// Nodes, cells, shape values and gradients of the Lagrange element.
template <int dim>
void Discretisation<dim>::copy_cells(int degree) {
  const Parts& parts = *parts_;
  const unsigned int per_cell = parts.element.n_dofs_per_cell();
  const auto n_cells = static_cast<Eigen::Index>(parts.triangulation.n_active_cells());
  const auto n_nodes = static_cast<Eigen::Index>(parts.dofs.n_dofs());

  // Gauss with degree + 1 points is exact for the mass matrix and for Saint Venant–Kirchhoff up to the
  // quartic terms, which vanish with the strain.
  const dealii::QGauss<dim> quadrature(static_cast<unsigned int>(degree) + 1);
  const dealii::Quadrature<dim> nodes(parts.element.get_unit_support_points());
  using namespace dealii;  // the update flags' operator|
  FEValues<dim> inside(parts.mapping, parts.element, quadrature,
                       update_values | update_gradients | update_JxW_values);
  FEValues<dim> in_nodes(parts.mapping, parts.element, nodes, update_quadrature_points);

  mesh_.degree = degree;
  mesh_.n_quadrature = static_cast<int>(quadrature.size());
  mesh_.node.resize(dim, n_nodes);
  mesh_.cell.resize(per_cell, n_cells);
  mesh_.gradient.resize(per_cell * dim, n_cells * mesh_.n_quadrature);
  mesh_.weight.resize(n_cells * mesh_.n_quadrature);
  mesh_.shape.resize(per_cell, mesh_.n_quadrature);
  mesh_.centre_inverse.resize(dim * dim, n_cells);
  mesh_.point.resize(dim, mesh_.n_quadrature);
  mesh_.reference_weight.resize(mesh_.n_quadrature);
  for (unsigned int q = 0; q < quadrature.size(); ++q) {
    mesh_.reference_weight(q) = quadrature.weight(q);
    for (unsigned int k = 0; k < dim; ++k) mesh_.point(k, q) = 2 * quadrature.point(q)[k] - 1;
  }

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
      }
      for (unsigned int q = 0; q < quadrature.size(); ++q) mesh_.shape(a, q) = inside.shape_value(place, q);
    }
    for (unsigned int q = 0; q < quadrature.size(); ++q)
      mesh_.weight(c * mesh_.n_quadrature + q) = inside.JxW(q);
    mesh_.part.push_back(static_cast<int>(cell->material_id()));
    Eigen::Matrix<double, dim, dim> J = Eigen::Matrix<double, dim, dim>::Zero();
    for (const unsigned int v : cell->vertex_indices())
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int l = 0; l < dim; ++l)
          J(k, l) += std::ldexp((v >> l) & 1 ? cell->vertex(v)[k] : -cell->vertex(v)[k], -dim);
    Eigen::Map<Eigen::Matrix<double, dim, dim>>(mesh_.centre_inverse.col(c).data()) = J.inverse();
    ++c;
  }
}

// Constrains a pinned or rolling face along the line at its middle. In space this is the line along the
// longer of its two directions.
template <int dim>
void Discretisation<dim>::constrain(const SupportedFace& face, double near) {
  const auto on_face = [&](const Eigen::Vector3d& X) {
    return std::any_of(face.facet.begin(), face.facet.end(),
                       [&](int f) { return on_facet(solid_, f, X, near); });
  };
  const Eigen::Vector3d middle = middle_of(solid_, face);
  const bool line = face.support == Support::pinned || face.support == Support::roller;
  // A clamped or pinned face may lie in any direction; the others act along the axes.
  const bool along_axes = face.support == Support::roller || face.support == Support::symmetry;
  const Eigen::Index along = along_axes ? axis_of(solid_, face) : 0;  // of the normal
  const Eigen::Vector3d shorter = line ? shorter_direction(solid_, face) : Eigen::Vector3d::Zero();
  Eigen::Index across = 0;
  shorter.cwiseAbs().maxCoeff(&across);
  const std::size_t before = mesh_.fixed.size();
  for (int i = 0; i < mesh_.n_nodes(); ++i) {
    const Eigen::Vector3d X = mesh_.place(i);
    if (!on_face(X) || (line && std::abs(shorter.dot(X - middle)) > near)) continue;
    for (int k = 0; k < dim; ++k)
      if (face.support == Support::clamped || face.support == Support::pinned ||
          (face.support == Support::roller && k == across) ||
          (face.support == Support::symmetry && k == along))
        mesh_.fixed.push_back(dim * i + k);
  }
  if (mesh_.fixed.size() == before)
    throw Error(ExitCode::case_file, "structure, support \"" + face.name + "\"",
                "a pinned or rolling end needs a node at mid-height, and one layer of linear cells has none",
                "structure.fem.refinement = 1 or more");
}

template <int dim>
Eigen::VectorXd Discretisation<dim>::face_sizes(const std::vector<int>& facets) const {
  const Parts& parts = *parts_;
  const dealii::QGauss<dim - 1> quadrature(parts.element.degree + 1);
  using namespace dealii;  // the update flags' operator|
  FEFaceValues<dim> on_face(parts.mapping, parts.element, quadrature, update_values | update_JxW_values);
  const double near = 1e-6 * thinnest(solid_);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(mesh_.n_nodes());
  std::vector<types::global_dof_index> index(parts.element.n_dofs_per_cell());
  for (const auto& cell : parts.dofs.active_cell_iterators())
    for (const unsigned int f : cell->face_indices()) {
      if (!cell->face(f)->at_boundary()) continue;
      const Eigen::Vector3d middle = in_space(cell->face(f)->center());
      if (std::none_of(facets.begin(), facets.end(),
                       [&](int k) { return on_facet(solid_, k, middle, near); }))
        continue;
      on_face.reinit(cell, f);
      cell->get_dof_indices(index);
      for (unsigned int q = 0; q < quadrature.size(); ++q)
        for (unsigned int a = 0; a < index.size(); ++a)
          sum(static_cast<Eigen::Index>(index[a])) += on_face.shape_value(a, q) * on_face.JxW(q);
    }
  return sum;
}

template <int dim>
Eigen::VectorXd Discretisation<dim>::case_force(const CaseLoad& load) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(mesh_.n_unknowns());
  if (load.kind == LoadKind::traction) {
    const Eigen::VectorXd area = face_sizes(facets_named(solid_, load.face));
    for (int i = 0; i < mesh_.n_nodes(); ++i) force.segment<dim>(dim * i) = area(i) * load.value.head<dim>();
  } else if (load.kind == LoadKind::point) {
    for (const auto& [node, weight] : shape_values(load.at))
      force.segment<dim>(dim * node) += weight * load.value.head<dim>();
  }
  return force;
}

template <int dim>
Discretisation<dim>::~Discretisation() = default;

template <int dim>
typename Discretisation<dim>::Place Discretisation<dim>::locate(const Eigen::Vector3d& X) const {
  const Parts& parts = *parts_;
  const dealii::Point<dim> x = point<dim>(X);

  // A linear search over the cells: once per point at set-up.
  typename dealii::DoFHandler<dim>::active_cell_iterator nearest;
  dealii::Point<dim> unit;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& cell : parts.dofs.active_cell_iterators()) {
    if (cell->barycenter().distance(x) - cell->diameter() > least) continue;
    // Far from a distorted cell its map has no inverse; its middle is then used.
    dealii::Point<dim> candidate;
    for (int axis = 0; axis < dim; ++axis) candidate[static_cast<unsigned>(axis)] = 0.5;
    try {
      candidate =
          dealii::GeometryInfo<dim>::project_to_unit_cell(parts.mapping.transform_real_to_unit_cell(cell, x));
    } catch (const typename dealii::Mapping<dim>::ExcTransformationFailed&) {
    }
    const double distance = parts.mapping.transform_unit_to_real_cell(cell, candidate).distance(x);
    if (distance >= least) continue;
    least = distance;
    nearest = cell;
    unit = candidate;
    if (distance == 0) break;
  }
  std::vector<dealii::types::global_dof_index> index(parts.element.n_dofs_per_cell());
  nearest->get_dof_indices(index);
  Place place{.cell = static_cast<int>(nearest->active_cell_index()), .weights = {}};
  for (unsigned int a = 0; a < index.size(); ++a)
    place.weights.emplace_back(static_cast<int>(index[a]), parts.element.shape_value(a, unit));
  return place;
}

std::string library() {
  return "deal.II " DEAL_II_PACKAGE_VERSION;
}

template class Discretisation<2>;
template class Discretisation<3>;

}  // namespace strake::structure::fem
