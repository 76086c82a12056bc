#pragma once

#include "proto/values.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace strake {

/// 3×n, one column per point. In two dimensions z = 0, and values are per metre of depth.
using Points = Eigen::Matrix3Xd;

/// Where one of several bodies, or of several meshes, begins in a mesh that holds them one after the other.
struct MeshPart {
  std::string name;
  Eigen::Index first_point = 0, first_face = 0;
};

/// The loaded surface (or, for volume coupling, all solid points) of one participant in its reference
/// configuration.
struct InterfaceMesh {
  std::string name;
  int dimension = 3;      // 2: faces are segments, per metre of depth; 3: triangles
  Points position;        // 3×n [m], reference configuration X
  Eigen::MatrixXi faces;  // dimension×m, point indices, normal into the fluid; none: volume coupling
                          // 2-D: for a segment (a, b) the normal into the fluid is (t_y, -t_x), t = x_b -
                          // x_a, that is, a closed body is walked counter-clockwise
  Eigen::VectorXd mass;   // n [kg], optional: inertia the fluid's pressure equation may use
  std::vector<MeshPart> parts = {};  // of several bodies, in order; none: one body
  /// Of several meshes that one solver has joined, in order (coupler/mapping/mesh_part.hpp); none: one mesh.
  std::vector<MeshPart> meshes = {};
};

/// One quantity on the points of a mesh.
struct Field {
  std::string quantity;       // "displacement", "velocity", "force", "traction", "pressure", "area", …
  std::string unit;           // "m", "m/s", "N", …
  bool conservative = false;  // true: mapped with the transpose, so that sums are kept (forces)
  Values value;               // components×n
};

/// How the points of a mesh have moved. Both are 3×n.
struct Motion {
  Values displacement;  // [m]
  Values velocity;      // [m/s]; 0×0 where it is not given
};

/// The field of that quantity, or nullptr.
inline const Field* find(const std::vector<Field>& fields, const std::string& quantity) {
  for (const Field& field : fields)
    if (field.quantity == quantity) return &field;
  return nullptr;
}

struct Sample {
  double time = 0;  // [s] absolute, in [t, t + dt]
  std::vector<Field> fields;
};
struct Input {
  /// One: constant (force) or end value (motion). More: a history, ascending, that ends with the window and
  /// may begin before it.
  std::vector<Sample> samples;
  bool wants_history = false;  // the partner takes a history: send Advanced::history
};
struct Window {
  double t = 0, dt = 0;  // [s]
};

/// A named scalar that a participant reports with each window; becomes a column of history.csv.
struct Column {
  std::string name, unit;
};

/// Everything that makes up a solver's state, by name: what a checkpoint writes and a resume reads.
struct Archive {
  std::map<std::string, Eigen::MatrixXd> real;
  std::map<std::string, std::vector<std::int64_t>> integer;
};

/// One picture in time of a solver's fields, as it is written to frames/.
struct Frame {
  struct Array {
    std::string name, unit;
    Eigen::MatrixXd value;  // components×n (points) or components×m (cells)
  };
  double time = 0;        // [s]
  Points position;        // 3×n [m], current
  Eigen::MatrixXi cells;  // nodes per cell × m: 1 vertices, 2 segments, 4 quadrilaterals (dimension 2), 8
                          // hexahedra; none: every point is a vertex
  std::vector<Array> point_data, cell_data;
};

}  // namespace strake
