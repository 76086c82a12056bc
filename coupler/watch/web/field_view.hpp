#pragma once

#include "coupler/watch/web/array_message.hpp"
#include "proto/interface.hpp"

#include <map>
#include <string>
#include <vector>

namespace strake::watch {

/// What is drawn of one frame, as an ArrayMessage:
///   position  f32 3·n  [m]
///   value     f32 n    of the field; NaN where there is none. Absent without such a field.
///   index     u32 n    of the point in its frame
///   kind      u8 n     0 water, 1 wall (fluid alone)
///   bend      f32 3·n  [m] displacement without the rigid motion of each body (structure alone)
///   triangle  u32 3·m, edge u32 2·k: the cells' surface, as places in `position`; absent where points are
///   all
/// Its head: time [s], field {name, unit, shown [lo, hi], all [lo, hi]}, fields [{name, unit}], low and high
/// corner of what is drawn [m]. The structure's has also bodies [{name, first, low, high}]: name, place of the
/// first point in the frame, and box [m] of each of several bodies; empty for one structure.
struct FieldRequest {
  std::string side;   // "fluid" | "structure"
  std::string field;  // "pressure", "speed", "von_mises" …; empty: the positions alone
  int dimension = 2;
  std::map<std::string, std::string> keys;  // of case.toml
  std::vector<MeshPart> parts = {};         // of several bodies in the frame; empty: one structure
};
ArrayMessage field_message(const Frame&, const FieldRequest&);

/// All that a frame says of one point: names, units and components. Throws Error(command_line) where there is
/// no such point.
Json point_values(const Frame&, Eigen::Index index);

/// Where the point with that id stands in a frame. Throws Error(case_file) where it is not among its points.
Eigen::Index place_of(const Frame&, std::int64_t id);

/// The outer faces of cells, as triangles, and the lines between the cells' corners. In the plane these are
/// all cells, in space the faces that only one cell has. Two corners are a line, eight a hexahedron whose two
/// faces are numbered alike, four a quadrilateral in the plane and a tetrahedron in space.
struct Surface {
  std::vector<std::uint32_t> triangle, edge;
};
Surface surface_of(const Eigen::MatrixXi& cells, int dimension);

}  // namespace strake::watch
