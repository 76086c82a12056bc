#include "coupler/mapping/mapping_parts.hpp"
#include "coupler/mapping/point_tree.hpp"
#include "proto/error.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace strake {
namespace {

using namespace mapping_parts;
using Eigen::Index;
using Eigen::Vector3d;

/// A point of a face nearest to some p.
struct Foot {
  std::array<double, 3> weight = {0, 0, 0};  // of the face's vertices
  std::array<double, 3> beyond = {0, 0, 0};  // the same on the face's line or plane, negative beyond an edge
  double distance = 0;                       // [m]
  bool inside = true;                        // of the face, not beyond an edge
};

/// x = (1 − t) a + t b, t = (p − a)·(b − a)/|b − a|² limited to [0, 1].
Foot on_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d ab = b - a;
  const double free = (p - a).dot(ab) / ab.squaredNorm();
  double t = std::clamp(free, 0.0, 1.0);
  if (t < round_off) t = 0;
  if (t > 1 - round_off) t = 1;
  return {
      {1 - t, t, 0}, {1 - free, free, 0}, (p - a - t * ab).norm(), free > -round_off && free < 1 + round_off};
}

/// Barycentric coordinates of the foot of the perpendicular, from the normal equations of the two edge
/// vectors. If one is negative, the nearest point lies on an edge.
Foot on_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d e1 = b - a, e2 = c - a, d = p - a;
  const double g11 = e1.dot(e1), g12 = e1.dot(e2), g22 = e2.dot(e2), d1 = d.dot(e1), d2 = d.dot(e2);
  const double determinant = g11 * g22 - g12 * g12;
  double u = (g22 * d1 - g12 * d2) / determinant, v = (g11 * d2 - g12 * d1) / determinant;
  if (std::abs(u) < round_off) u = 0;
  if (std::abs(v) < round_off) v = 0;
  double w = 1 - u - v;
  if (std::abs(w) < round_off) {
    w = 0;
    u = 1 - v;
  }
  if (u >= 0 && v >= 0 && w >= 0) return {{w, u, v}, {w, u, v}, (d - u * e1 - v * e2).norm(), true};
  const std::array<Foot, 3> edge = {on_segment(p, a, b), on_segment(p, b, c), on_segment(p, c, a)};
  std::size_t best = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (edge[k].distance < edge[best].distance) best = k;
  Foot foot;
  foot.weight[best] = edge[best].weight[0];
  foot.weight[(best + 1) % 3] = edge[best].weight[1];
  foot.beyond = {w, u, v};
  foot.distance = edge[best].distance;
  foot.inside = false;
  return foot;
}

/// The structure's faces with a tree over their centres.
class Surface {
 public:
  explicit Surface(const InterfaceMesh& mesh) : mesh_(mesh), centre_(3, mesh.faces.cols()) {
    const Index n = mesh.position.cols();
    for (Index f = 0; f < mesh.faces.cols(); ++f) {
      for (Index k = 0; k < mesh.faces.rows(); ++k)
        if (mesh.faces(k, f) < 0 || mesh.faces(k, f) >= n)
          throw Error(ExitCode::case_file, name(f),
                      fmt::format("names point {}, the mesh has {}", mesh.faces(k, f), n));
      centre_.col(f).setZero();
      for (Index k = 0; k < mesh.faces.rows(); ++k)
        centre_.col(f) += vertex(f, k) / static_cast<double>(mesh.faces.rows());
      double size = 0;
      for (Index k = 0; k < mesh.faces.rows(); ++k)
        size = std::max(size, (vertex(f, k) - centre_.col(f)).norm());
      const double measure =
          mesh.faces.rows() == 2
              ? (vertex(f, 1) - vertex(f, 0)).norm() / (2 * size)
              : (vertex(f, 1) - vertex(f, 0)).cross(vertex(f, 2) - vertex(f, 0)).norm() / (size * size);
      if (!(measure > round_off))
        throw Error(ExitCode::case_file, name(f), "its points coincide or lie on one line",
                    "repair the mesh");
      reach_ = std::max(reach_, size);
    }
  }
  const Points& centres() const { return centre_; }
  /// No point of a face lies farther from its centre [m].
  double reach() const { return reach_; }
  Foot foot(const Vector3d& p, Index f) const {
    if (mesh_.faces.rows() == 2) return on_segment(p, vertex(f, 0), vertex(f, 1));
    return on_triangle(p, vertex(f, 0), vertex(f, 1), vertex(f, 2));
  }

 private:
  Vector3d vertex(Index f, Index k) const { return mesh_.position.col(mesh_.faces(k, f)); }
  std::string name(Index f) const {
    return fmt::format("face {} of the interface mesh {}", f,
                       mesh_.name.empty() ? "of the structure" : mesh_.name);
  }
  const InterfaceMesh& mesh_;
  Points centre_;
  double reach_ = 0;
};

/// The face that carries a fluid point, and where on it.
struct Carrier {
  Index face = -1;
  Foot foot;
};

/// How far a point lies beyond a face, in parts of the face: 0 inside.
double overhang(const Foot& foot, Index corners) {
  double lowest = 0;
  for (Index k = 0; k < corners; ++k) lowest = std::min(lowest, foot.beyond[static_cast<std::size_t>(k)]);
  return -lowest;
}

class FaceSearch {
 public:
  explicit FaceSearch(const InterfaceMesh& mesh)
      : surface_(mesh), tree_(surface_.centres()), corners_(mesh.faces.rows()) {}
  Carrier carrier(const Vector3d& p) {
    // The nearest face is no farther than the nearest centre, and its own centre at most `reach` beyond.
    const double far = tree_.nearest_distance(p) + surface_.reach();
    tree_.within(p, far * (1 + round_off), near_);
    const double tie = round_off * far;
    Carrier best;
    for (const Index f : near_) {
      const Foot foot = surface_.foot(p, f);
      if (best.face >= 0 && foot.distance > best.foot.distance + tie) continue;
      // Among equally near faces the one that the point overhangs least, then the first.
      if (best.face < 0 || foot.distance < best.foot.distance - tie ||
          overhang(foot, corners_) < overhang(best.foot, corners_) - round_off)
        best = {f, foot};
    }
    return best;
  }

 private:
  Surface surface_;
  PointTree tree_;
  Index corners_;
  std::vector<Index> near_;
};

void check_faces(const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  check_meshes(structure, fluid);
  if (structure.faces.cols() == 0)
    throw Error(ExitCode::case_file, title(structure, fluid),
                "the structure's interface has no faces to project on",
                "coupling.surface.mapping.kind = \"nearest-neighbour\" or \"radial-basis\"");
  if (structure.faces.rows() != structure.dimension)
    throw Error(
        ExitCode::case_file, title(structure, fluid),
        fmt::format("faces of {} points in {} dimensions", structure.faces.rows(), structure.dimension),
        "faces are segments in 2-D and triangles in 3-D");
}

/// beyond: the largest overhang [parts of a face] over which the face's linear function is extended.
Mapping by_faces(const InterfaceMesh& structure, const InterfaceMesh& fluid, double limit, double beyond) {
  check_faces(structure, fluid);
  FaceSearch search(structure);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(fluid.position.cols() * structure.faces.rows()));
  MappingQuality quality;
  for (Index i = 0; i < fluid.position.cols(); ++i) {
    const Carrier on = search.carrier(fluid.position.col(i));
    const bool goes_on = !on.foot.inside && overhang(on.foot, structure.faces.rows()) <= beyond;
    const auto& weight = goes_on ? on.foot.beyond : on.foot.weight;
    for (Index k = 0; k < structure.faces.rows(); ++k)
      if (weight[static_cast<std::size_t>(k)] != 0)
        entries.emplace_back(i, structure.faces(k, on.face), weight[static_cast<std::size_t>(k)]);
    if (!on.foot.inside) ++quality.outside;
    note_distance(quality, i, on.foot.distance);
  }
  check_distance(quality, limit, structure, fluid);
  return build(fluid.position.cols(), structure.position.cols(), entries, quality);
}

}  // namespace

Mapping nearest_projection(const InterfaceMesh& structure, const InterfaceMesh& fluid, double limit) {
  return by_faces(structure, fluid, limit, 0);
}

Mapping linear_cell(const InterfaceMesh& structure, const InterfaceMesh& fluid, double limit) {
  return by_faces(structure, fluid, limit, 1);
}

}  // namespace strake
