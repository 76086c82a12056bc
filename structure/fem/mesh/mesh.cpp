#include "structure/fem/mesh/mesh.hpp"

#include "proto/error.hpp"
#include "structure/fem/mesh/refinement.hpp"

#include <deal.II/base/multithread_info.h>
#include <deal.II/base/partitioner.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/distributed/fully_distributed_tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_dgq.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_tools.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q1.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/grid_tools_cache.h>
#include <deal.II/grid/tria.h>
#include <deal.II/grid/tria_description.h>
#include <deal.II/lac/full_matrix.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace strake::structure::fem {
namespace {

template <int dim>
dealii::Point<dim> point(const Eigen::Vector3d& X) {
  dealii::Point<dim> x;
  for (unsigned int k = 0; k < dim; ++k) x[k] = X(k);
  return x;
}

/// While it lives, deal.II computes the gradients of each cell from the cell itself. With one thread it would
/// copy them from the cell before where that has the same shape, and the last bits would be others.
struct EachCellItself {
  EachCellItself() { dealii::MultithreadInfo::set_thread_limit(2); }
  ~EachCellItself() { dealii::MultithreadInfo::set_thread_limit(threads); }
  unsigned int threads = dealii::MultithreadInfo::n_threads();
};

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
  using Cell = typename dealii::DoFHandler<dim>::active_cell_iterator;
  explicit Parts(unsigned int degree)
      : element(degree),
        // Exact for the mass matrix and for Saint Venant–Kirchhoff up to the quartic terms, which vanish with
        // the strain.
        quadrature(degree + 1),
        lexicographic(dealii::FETools::lexicographic_to_hierarchic_numbering<dim>(degree)) {}
  std::unique_ptr<dealii::Triangulation<dim>> triangulation;
  dealii::FE_Q<dim> element;
  dealii::QGauss<dim> quadrature;
  dealii::MappingQ1<dim> mapping;
  dealii::DoFHandler<dim> dofs;
  std::vector<unsigned int> lexicographic;  // place in the cell's unknowns of each lexicographic node
  std::vector<Cell> cells;                  // as the mesh numbers them
  const dealii::Utilities::MPI::Partitioner* unknowns = nullptr;  // of several ranks

  dealii::types::global_dof_index n_nodes() const {
    if (unknowns == nullptr) return dofs.n_dofs();
    return (unknowns->locally_owned_size() + unknowns->n_ghost_indices()) / dim;
  }
  /// Nodes of a cell as the mesh numbers them, in deal.II's order.
  std::vector<int> nodes(const Cell& cell) const {
    std::vector<dealii::types::global_dof_index> index(element.n_dofs_per_cell());
    cell->get_dof_indices(index);
    std::vector<int> nodes(index.begin(), index.end());
    if (unknowns != nullptr)
      for (std::size_t a = 0; a < index.size(); ++a)
        nodes[a] = static_cast<int>(unknowns->global_to_local(dim * index[a]) / dim);
    return nodes;
  }
};

template <int dim>
Discretisation<dim>::Discretisation(const Solid& solid, int degree, int refinement, double along,
                                    Communicator* ranks)
    : solid_(solid), parts_(std::make_unique<Parts>(static_cast<unsigned int>(degree))) {
  assert(solid.dimension == dim);
  const Solid cells = refined(solid, refinement, along);
  Parts& parts = *parts_;
  if (ranks != nullptr && ranks->size() > 1) {
    divide(cells, *ranks);
  } else {
    parts.triangulation = std::make_unique<dealii::Triangulation<dim>>();
    create(*parts.triangulation, cells);
    take_cells();
  }
  copy_element(degree);
  copy_cells();
  constrain_all(refinement);
}

/// The cells of this rank, in the order of the whole body: so each sum over cells has the order of one rank.
template <int dim>
void Discretisation<dim>::take_cells() {
  parts_->dofs.reinit(*parts_->triangulation);
  parts_->dofs.distribute_dofs(parts_->element);
  for (const auto& cell : parts_->dofs.active_cell_iterators())
    if (!cell->is_artificial()) parts_->cells.push_back(cell);
  const auto number = [](const auto& cell) { return static_cast<int>(cell->id().get_coarse_cell_id()); };
  std::ranges::sort(parts_->cells, {}, number);
  for (const auto& cell : parts_->cells) {
    mesh_.number.push_back(number(cell));
    mesh_.own.push_back(cell->is_locally_owned());
  }
  mesh_.cells_of_body = static_cast<int>(parts_->triangulation->n_global_active_cells());
}

/// Each rank makes the mesh of the whole body, divides it by METIS into parts that touch in few nodes, and
/// keeps its own part, as a triangulation that no rank has as a whole.
template <int dim>
void Discretisation<dim>::divide(const Solid& cells, Communicator& ranks) {
  Parts& parts = *parts_;
  dealii::Triangulation<dim> whole;
  create(whole, cells);
  dealii::GridTools::partition_triangulation(static_cast<unsigned int>(ranks.size()), whole);
  auto made = std::make_unique<dealii::parallel::fullydistributed::Triangulation<dim>>(MPI_COMM_WORLD);
  auto& own = *made;
  parts.triangulation = std::move(made);
  own.create_triangulation(dealii::TriangulationDescription::Utilities::create_description_from_triangulation(
      whole, MPI_COMM_WORLD));
  take_cells();

  // Unknowns: own ones, then ghosts.
  const dealii::IndexSet components = dealii::complete_index_set(dim);
  const auto entries = std::make_shared<const dealii::Utilities::MPI::Partitioner>(
      parts.dofs.locally_owned_dofs().tensor_product(components),
      dealii::DoFTools::extract_locally_relevant_dofs(parts.dofs).tensor_product(components), MPI_COMM_WORLD);
  const auto division = std::make_shared<RankDivision::Parts>(RankDivision::Parts{ranks, entries, {}});
  parts.unknowns = entries.get();

  // Numbers of the same nodes on one rank.
  dealii::DoFHandler<dim> on_one_rank(whole);
  on_one_rank.distribute_dofs(parts.element);
  std::vector<dealii::types::global_dof_index> index(parts.element.n_dofs_per_cell());
  division->on_one_rank.resize(dim * parts.n_nodes());
  for (std::size_t c = 0; c < parts.cells.size(); ++c) {
    typename Parts::Cell(&whole, 0, mesh_.number[c], &on_one_rank)->get_dof_indices(index);
    const std::vector<int> nodes = parts.nodes(parts.cells[c]);
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (int k = 0; k < dim; ++k)
        division->on_one_rank[static_cast<std::size_t>(dim * nodes[a] + k)] =
            static_cast<int>(dim * index[a]) + k;
  }
  mesh_.division = RankDivision(division);
}

/// Supports, and parts that are constrained as a whole. An owner knows all that constrains its nodes.
template <int dim>
void Discretisation<dim>::constrain_all(int refinement) {
  const double near = 1e-6 * std::ldexp(thinnest(solid_), -refinement);
  for (const SupportedFace& face : solid_.supported)
    if (face.support != Support::free) constrain(face, near);
  for (int cell = 0; cell < mesh_.n_cells(); ++cell)
    if (solid_.parts[static_cast<std::size_t>(mesh_.part[static_cast<std::size_t>(cell)])].constrained)
      for (Eigen::Index a = 0; a < mesh_.cell.rows(); ++a)
        for (int k = 0; k < dim; ++k) mesh_.fixed.push_back(dim * mesh_.cell(a, cell) + k);
  Eigen::VectorXd is_fixed = Eigen::VectorXd::Zero(mesh_.n_unknowns());
  for (const int i : mesh_.fixed) is_fixed(i) = 1;
  mesh_.division.update(is_fixed);
  mesh_.fixed.clear();
  for (int i = 0; i < is_fixed.size(); ++i)
    if (is_fixed(i) != 0) mesh_.fixed.push_back(i);
}

/// Shape values and quadrature in the reference cell.
template <int dim>
void Discretisation<dim>::copy_element(int degree) {
  const Parts& parts = *parts_;
  const unsigned int points = parts.quadrature.size();
  const auto per_cell = static_cast<Eigen::Index>(parts.lexicographic.size());
  mesh_.degree = degree;
  mesh_.n_quadrature = static_cast<int>(points);
  mesh_.shape.resize(per_cell, points);
  mesh_.point.resize(dim, points);
  mesh_.reference_weight.resize(points);
  // The L2 fit of degree one to values in the points of quadrature.
  const dealii::FE_DGQ<dim> linear(1);
  dealii::FullMatrix<double> fit(linear.n_dofs_per_cell(), points);
  dealii::FETools::compute_projection_from_quadrature_points_matrix(linear, parts.quadrature,
                                                                    parts.quadrature, fit);
  mesh_.fit = Eigen::MatrixXd::Zero(per_cell, points);
  for (unsigned int q = 0; q < points; ++q) {
    mesh_.reference_weight(q) = parts.quadrature.weight(q);
    for (unsigned int k = 0; k < dim; ++k) mesh_.point(k, q) = 2 * parts.quadrature.point(q)[k] - 1;
    for (Eigen::Index a = 0; a < per_cell; ++a) {
      const unsigned int place = parts.lexicographic[static_cast<std::size_t>(a)];
      mesh_.shape(a, q) = parts.element.shape_value(place, parts.quadrature.point(q));
      for (unsigned int k = 0; k < linear.n_dofs_per_cell(); ++k)
        mesh_.fit(a, q) += linear.shape_value(k, parts.element.unit_support_point(place)) * fit(k, q);
    }
  }
}

/// The cells and their nodes, and weights and gradients in the points of quadrature.
template <int dim>
void Discretisation<dim>::copy_cells() {
  const Parts& parts = *parts_;
  const EachCellItself no_copies;
  const unsigned int per_cell = parts.element.n_dofs_per_cell(), points = parts.quadrature.size();
  using namespace dealii;  // the update flags' operator|
  FEValues<dim> inside(parts.mapping, parts.element, parts.quadrature, update_gradients | update_JxW_values);
  FEValues<dim> at_centre(parts.mapping, parts.element, QMidpoint<dim>(), update_inverse_jacobians);

  const auto n_cells = std::ssize(parts.cells);
  mesh_.node.resize(dim, static_cast<Eigen::Index>(parts.n_nodes()));
  mesh_.cell.resize(per_cell, n_cells);
  mesh_.gradient.resize(per_cell * dim, n_cells * points);
  mesh_.weight.resize(n_cells * points);
  mesh_.outside.resize(2 * dim, n_cells);
  mesh_.centre_inverse.resize(dim * dim, n_cells);
  for (Eigen::Index c = 0; c < n_cells; ++c) {
    const auto& cell = parts.cells[static_cast<std::size_t>(c)];
    inside.reinit(cell);
    at_centre.reinit(cell);
    const std::vector<int> nodes = parts.nodes(cell);
    for (unsigned int a = 0; a < per_cell; ++a) {
      const unsigned int place = parts.lexicographic[a];
      const Point<dim> X =
          parts.mapping.transform_unit_to_real_cell(cell, parts.element.unit_support_point(place));
      mesh_.cell(a, c) = nodes[place];
      for (unsigned int k = 0; k < dim; ++k) {
        mesh_.node(k, nodes[place]) = X[k];
        for (unsigned int q = 0; q < points; ++q)
          mesh_.gradient(k * per_cell + a, c * points + q) = inside.shape_grad(place, q)[k];
      }
    }
    for (unsigned int q = 0; q < points; ++q) mesh_.weight(c * points + q) = inside.JxW(q);
    mesh_.part.push_back(static_cast<int>(cell->material_id()));
    for (const unsigned int f : cell->face_indices()) mesh_.outside(f, c) = cell->face(f)->at_boundary();
    for (unsigned int k = 0; k < dim; ++k)  // deal.II's reference cell is [0, 1]
      for (unsigned int l = 0; l < dim; ++l)
        mesh_.centre_inverse(l * dim + k, c) = 2 * at_centre.inverse_jacobian(0)[k][l];
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
  if (mesh_.division.sum(static_cast<double>(mesh_.fixed.size() - before)) == 0)
    throw Error(ExitCode::case_file, "structure, support \"" + face.name + "\"",
                "a pinned or rolling end needs a node at mid-height, and one layer of linear cells has none",
                "structure.fem.refinement = 1 or more");
}

template <int dim>
Eigen::VectorXd Discretisation<dim>::face_sizes(const std::vector<int>& facets) const {
  const Parts& parts = *parts_;
  const EachCellItself no_copies;
  const dealii::QGauss<dim - 1> quadrature(parts.element.degree + 1);
  using namespace dealii;  // the update flags' operator|
  FEFaceValues<dim> on_face(parts.mapping, parts.element, quadrature, update_values | update_JxW_values);
  const double near = 1e-6 * thinnest(solid_);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(mesh_.n_nodes());
  for (const auto& cell : parts.cells) {
    const std::vector<int> index = parts.nodes(cell);
    for (const unsigned int f : cell->face_indices()) {
      if (!cell->face(f)->at_boundary()) continue;
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (unsigned int k = 0; k < dim; ++k) middle(k) = cell->face(f)->center()[k];
      if (std::none_of(facets.begin(), facets.end(),
                       [&](int k) { return on_facet(solid_, k, middle, near); }))
        continue;
      on_face.reinit(cell, f);
      for (unsigned int q = 0; q < quadrature.size(); ++q)
        for (unsigned int a = 0; a < index.size(); ++a)
          sum(index[a]) += on_face.shape_value(a, q) * on_face.JxW(q);
    }
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
    const Place at = locate(load.at).front();
    for (const auto& [node, weight] : at.weights)
      force.segment<dim>(dim * node) += weight * load.value.head<dim>();
  }
  return force;
}

template <int dim>
Discretisation<dim>::~Discretisation() = default;

// The nearest cell of all, of equally near ones the first; no cell is nearer than the box around it. Each
// rank looks in its own cells.
template <int dim>
std::vector<typename Discretisation<dim>::Place> Discretisation<dim>::locate(const Points& X) const {
  const Parts& parts = *parts_;
  const auto place_in = [&](const auto& cell, const dealii::Point<dim>& x) {
    // Far from a distorted cell its map has no inverse; its middle is then used.
    dealii::Point<dim> unit;
    for (unsigned int axis = 0; axis < dim; ++axis) unit[axis] = 0.5;
    try {
      unit =
          dealii::GeometryInfo<dim>::project_to_unit_cell(parts.mapping.transform_real_to_unit_cell(cell, x));
    } catch (const typename dealii::Mapping<dim>::ExcTransformationFailed&) {
    }
    return unit;
  };
  const dealii::GridTools::Cache<dim> cache(*parts.triangulation, parts.mapping);
  const auto& boxes = cache.get_locally_owned_cell_bounding_boxes_rtree();
  std::vector<Place> places(static_cast<std::size_t>(X.cols()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const dealii::Point<dim> x = point<dim>(X.col(static_cast<Eigen::Index>(i)));
    Eigen::Vector2d nearest(-std::numeric_limits<double>::infinity(), 0);  // −distance, −number of the cell
    for (auto box = boxes.qbegin(boost::geometry::index::nearest(x, static_cast<unsigned int>(boxes.size())));
         box != boxes.qend() && -boost::geometry::distance(box->first, x) >= nearest(0); ++box) {
      const auto& cell = box->second;
      const double distance = parts.mapping.transform_unit_to_real_cell(cell, place_in(cell, x)).distance(x);
      const Eigen::Vector2d there(-distance, -static_cast<double>(cell->id().get_coarse_cell_id()));
      if (std::pair(there(0), there(1)) > std::pair(nearest(0), nearest(1))) nearest = there;
    }
    nearest = mesh_.division.largest(nearest);
    const auto found = std::ranges::lower_bound(mesh_.number, static_cast<int>(-nearest(1)));
    if (found == mesh_.number.end() || *found != -nearest(1)) continue;
    places[i].cell = static_cast<int>(found - mesh_.number.begin());
    const auto& cell = parts.cells[static_cast<std::size_t>(places[i].cell)];
    const dealii::Point<dim> unit = place_in(cell, x);
    const std::vector<int> nodes = parts.nodes(cell);
    for (unsigned int a = 0; a < nodes.size(); ++a)
      if (mesh_.division.owns(dim * nodes[a]))
        places[i].weights.emplace_back(nodes[a], parts.element.shape_value(a, unit));
  }
  return places;
}

void use_threads(int threads) {
  unsetenv("DEAL_II_NUM_THREADS");  // run.threads alone decides
  dealii::MultithreadInfo::set_thread_limit(static_cast<unsigned int>(threads));
}

std::string library() {
  return "deal.II " DEAL_II_PACKAGE_VERSION;
}

template class Discretisation<2>;
template class Discretisation<3>;

}  // namespace strake::structure::fem
