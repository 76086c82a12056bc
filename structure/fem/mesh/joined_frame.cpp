#include "structure/fem/mesh/joined_frame.hpp"

#include <algorithm>
#include <vector>

namespace strake::structure::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// The same number on all ranks for a point: its node in the body on one rank, then its part.
template <int dim>
Eigen::RowVectorXd numbers_of_points(const Recovery<dim>& recovery, const Mesh<dim>& mesh) {
  const double parts = mesh.division.max(1 + *std::ranges::max_element(mesh.part));
  Eigen::RowVectorXd number(recovery.size());
  for (int c = 0; c < mesh.n_cells(); ++c)
    for (Index a = 0; a < mesh.cell.rows(); ++a)
      number(recovery.cell()(a, c)) = parts * (mesh.division.number(dim * mesh.cell(a, c)) / dim) +
                                      mesh.part[static_cast<std::size_t>(c)];
  return number;
}

}  // namespace

template <int dim>
Frame joined_frame(const Frame& own, const Recovery<dim>& recovery, const Mesh<dim>& mesh) {
  const Eigen::RowVectorXd number = numbers_of_points(recovery, mesh);
  Index rows = 4;
  for (const Frame::Array& array : own.point_data) rows += array.value.rows();
  MatrixXd points(rows, number.size());  // number, place, and the values in it
  points.row(0) = number;
  points.middleRows<3>(1) = own.position;
  Index row = 4;
  for (const Frame::Array& array : own.point_data) {
    points.middleRows(row, array.value.rows()) = array.value;
    row += array.value.rows();
  }
  const Index corners = own.cells.size() / mesh.n_cells();  // of all pieces of a cell
  MatrixXd cells(1 + corners, mesh.n_cells());              // number, and those of its corners
  std::vector<Index> own_points, own_cells;
  for (Index i = 0; i < number.size(); ++i)
    if (mesh.division.owns(dim * recovery.node()[static_cast<std::size_t>(i)])) own_points.push_back(i);
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    cells(0, c) = mesh.number[static_cast<std::size_t>(c)];
    for (Index k = 0; k < corners; ++k) cells(1 + k, c) = number(own.cells.data()[c * corners + k]);
    if (mesh.owns(static_cast<int>(c))) own_cells.push_back(c);
  }
  points = mesh.division.columns_on_first(points(Eigen::all, own_points));
  cells = mesh.division.columns_on_first(cells(Eigen::all, own_cells));

  Frame frame;
  if (!mesh.division.first()) return frame;
  frame.time = own.time;
  frame.position = points.middleRows<3>(1);
  row = 4;
  for (const Frame::Array& array : own.point_data) {
    frame.point_data.push_back({array.name, array.unit, points.middleRows(row, array.value.rows())});
    row += array.value.rows();
  }
  const Eigen::RowVectorXd all = points.row(0);
  frame.cells.resize(own.cells.rows(), cells.cols() * corners / own.cells.rows());
  for (Index c = 0; c < cells.cols(); ++c)
    for (Index k = 0; k < corners; ++k)
      frame.cells.data()[c * corners + k] =
          static_cast<int>(std::lower_bound(all.begin(), all.end(), cells(1 + k, c)) - all.begin());
  return frame;
}

template Frame joined_frame(const Frame&, const Recovery<2>&, const Mesh<2>&);
template Frame joined_frame(const Frame&, const Recovery<3>&, const Mesh<3>&);

}  // namespace strake::structure::fem
