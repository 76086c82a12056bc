#pragma once

#include "proto/files/json_file.hpp"
#include "proto/interface.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace strake::watch {

/// Named arrays and a few words about them as one block of bytes for the page:
///   4 bytes   length n of the head, little-endian
///   n bytes   JSON, {"arrays": {name: {"type": …, "at": offset [bytes], "count": …}}, …}, of the types f32,
///             f64, u32 and u8, with blanks behind it, so that 4 + n is a multiple of 8
///   the arrays, little-endian, each at its offset from the block's first byte, a multiple of 8: a page uses
///   them in place.
class ArrayMessage {
 public:
  Json head;
  void add(const std::string& name, std::span<const float>);
  void add(const std::string& name, std::span<const double>);
  void add(const std::string& name, std::span<const std::uint32_t>);
  void add(const std::string& name, std::span<const std::uint8_t>);
  std::string bytes() const;

 private:
  struct Array {
    std::string name, type;
    std::size_t count = 0, at = 0;  // at: from the first array
  };
  void add(const std::string& name, const char* type, const void* data, std::size_t count, std::size_t size);
  std::vector<Array> arrays_;
  std::string data_;
};

/// What is drawn of one frame, as an ArrayMessage:
///   position  f32 3·n  [m]
///   value     f32 n    of the field; NaN where there is none. Absent without such a field.
///   index     u32 n    of the point in its frame
///   kind      u8 n     0 water, 1 wall (fluid alone)
///   bend      f32 3·n  [m] displacement without the rigid motion of each body (structure alone)
///   triangle  u32 3·m  the cells' surface, as places in `position`; absent where points are all
///   edge      u32 2·k  its edges, likewise
/// Its head: time [s], field {name, unit, shown [lo, hi], all [lo, hi]}, fields [{name, unit}], low and high
/// corner of what is drawn [m]. The structure's has also bodies [{name, first, low, high}]: name, place of
/// the first point in the frame, and box [m] of each of several bodies; empty for one structure.
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
