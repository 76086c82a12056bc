#pragma once

#include "fluid/air/air_columns.hpp"
#include "fluid/boundary/boundary.hpp"

#include <vector>

namespace strake::fluid {

/// Lower faces of a body that hang together, and the columns of air below them. `points` are the wet points
/// over each column, at least one.
template <int plane>
struct AirField {
  AirColumns<plane> columns;
  std::vector<std::vector<int>> points;
};

/// Returns the fields under the faces of a body that look down by more than 30° against the level, in the
/// body's place now. In the plane `per_point` columns of equal width stand under each wet point, about l0
/// wide together. In space there is one to about l0², whatever `per_point`: the
/// columns are the cells of a grid, cut along the borders of the faces; small pieces belong to the column
/// beside them. The borders of a field are open, but at walls of the tank nearer than l0/2 and at
/// seams over which the body goes on. Each of several bodies has fields of its own.
template <int dim>
std::vector<AirField<dim - 1>> lower_faces(const Boundary<dim>&, double spacing, int per_point = 1);

/// The columns under a surface of triangles in space, seen from above. `looks_down` are the triangles;
/// `points_of` the wet points of each triangle of the mesh, in places point_place, 2×n (x, z).
std::vector<AirField<2>> columns_under_triangles(const InterfaceMesh& mesh, const Points& place,
                                                 const std::vector<int>& looks_down,
                                                 const std::vector<std::vector<int>>& points_of,
                                                 const Eigen::Matrix2Xd& point_place, double spacing);

}  // namespace strake::fluid
