#include "coupler/mapping.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <nanoflann.hpp>

#include "proto/error.hpp"

namespace strake {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Triplet = Eigen::Triplet<double>;

// A weight or an overhang below this part of a face is round-off of the positions.
constexpr double round_off = 1e-12;

/// Points for nanoflann, which wants coordinates one by one.
struct Cloud {
  const Points& points;
  std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(points.cols()); }
  double kdtree_get_pt(std::size_t i, std::size_t d) const {
    return points(static_cast<Index>(d), static_cast<Index>(i));
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

class Tree {
 public:
  explicit Tree(const Points& points) : cloud_{points}, tree_(3, cloud_) { tree_.buildIndex(); }
  /// Indices of all points within `distance` of p, ascending.
  std::vector<Index> within(const Vector3d& p, double distance) const {
    std::vector<std::pair<std::size_t, double>> found;
    nanoflann::SearchParams unsorted;
    unsorted.sorted = false;
    const double squared = distance * distance;
    tree_.radiusSearch(p.data(), std::nextafter(squared, 2 * squared + 1), found, unsorted);
    std::vector<Index> index;
    for (const auto& f : found) index.push_back(static_cast<Index>(f.first));
    std::sort(index.begin(), index.end());
    return index;
  }
  double nearest_distance(const Vector3d& p) const {
    std::size_t index = 0;
    double squared = 0;
    nanoflann::KNNResultSet<double> result(1);
    result.init(&index, &squared);
    tree_.findNeighbors(result, p.data(), {});
    return std::sqrt(squared);
  }

 private:
  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::size_t>
      tree_;
};

std::string title(const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  return fmt::format("coupling, mapping from {} to {}",
                     structure.name.empty() ? "the structure" : structure.name,
                     fluid.name.empty() ? "the fluid" : fluid.name);
}

void check_meshes(const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  const std::string where = title(structure, fluid);
  if (structure.position.cols() == 0)
    throw Error(ExitCode::case_file, where, "the structure's interface has no points",
                "give the structure a surface that the fluid can wet, or coupling.surface away");
  if (fluid.position.cols() == 0)
    throw Error(ExitCode::case_file, where, "the fluid's interface has no points",
                "is the structure inside the tank?");
  if (structure.dimension != fluid.dimension)
    throw Error(ExitCode::case_file, where,
                fmt::format("the structure is {}-dimensional, the fluid {}-dimensional", structure.dimension,
                            fluid.dimension),
                "give both solvers the same dimension");
  for (const auto* mesh : {&structure, &fluid})
    for (Index i = 0; i < mesh->position.cols(); ++i)
      if (!mesh->position.col(i).allFinite())
        throw Error(ExitCode::case_file, where,
                    fmt::format("point {} of the {}'s interface has a position that is not finite", i,
                                mesh == &structure ? "structure" : "fluid"));
}

void check_distance(const MappingQuality& quality, double limit, const InterfaceMesh& structure,
                    const InterfaceMesh& fluid) {
  if (!(quality.largest_distance > limit)) return;
  const Vector3d p = fluid.position.col(quality.farthest);
  throw Error(
      ExitCode::case_file, title(structure, fluid),
      fmt::format("fluid point {} at ({:g}, {:g}, {:g}) m lies {:g} m from the structure's surface, at most "
                  "{:g} m is allowed",
                  quality.farthest, p.x(), p.y(), p.z(), quality.largest_distance, limit),
      "let both solvers take the shape from the same case file");
}

Mapping build(Index n_fluid, Index n_structure, const std::vector<Triplet>& entries, MappingQuality quality) {
  Mapping::Matrix weights(n_fluid, n_structure);
  weights.setFromTriplets(entries.begin(), entries.end());
  return Mapping(std::move(weights), quality);
}

/// A point of a face nearest to some p.
struct Foot {
  std::array<double, 3> weight = {0, 0, 0};  // of the face's vertices
  double distance = 0;                       // [m]
  bool inside = true;                        // of the face, not beyond an edge
};

/// x = (1 − t) a + t b, t = (p − a)·(b − a)/|b − a|² held in [0, 1].
Foot on_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d ab = b - a;
  const double free = (p - a).dot(ab) / ab.squaredNorm();
  double t = std::clamp(free, 0.0, 1.0);
  if (t < round_off) t = 0;
  if (t > 1 - round_off) t = 1;
  return {{1 - t, t, 0}, (p - a - t * ab).norm(), free > -round_off && free < 1 + round_off};
}

/// Barycentric coordinates of the foot of the perpendicular from the two edge vectors' normal equations;
/// where one is negative the nearest point lies on an edge.
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
  if (u >= 0 && v >= 0 && w >= 0) return {{w, u, v}, (d - u * e1 - v * e2).norm(), true};
  const std::array<Foot, 3> edge = {on_segment(p, a, b), on_segment(p, b, c), on_segment(p, c, a)};
  std::size_t best = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (edge[k].distance < edge[best].distance) best = k;
  Foot foot;
  foot.weight[best] = edge[best].weight[0];
  foot.weight[(best + 1) % 3] = edge[best].weight[1];
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

Field apply(const Mapping::Matrix& weights, const Field& field) {
  assert(field.value.cols() == weights.cols());
  Field mapped = {field.quantity, field.unit, field.conservative, {}};
  mapped.value.setZero(field.value.rows(), weights.rows());
  for (Index i = 0; i < weights.rows(); ++i)
    for (Mapping::Matrix::InnerIterator w(weights, i); w; ++w)
      mapped.value.col(i) += w.value() * field.value.col(w.col());
  return mapped;
}

}  // namespace

Mapping::Mapping(Matrix weights, MappingQuality quality) : weights_(std::move(weights)), quality_(quality) {
  weights_.makeCompressed();
  transpose_ = weights_.transpose();
  quality_.n_fluid = weights_.rows();
  quality_.n_structure = weights_.cols();
  quality_.row_sum_error = 0;
  for (Index i = 0; i < weights_.rows(); ++i) {
    double sum = 0;
    for (Matrix::InnerIterator w(weights_, i); w; ++w) sum += w.value();
    quality_.row_sum_error = std::max(quality_.row_sum_error, std::abs(sum - 1));
  }
  quality_.without_load = 0;
  for (Index j = 0; j < transpose_.rows(); ++j)
    if (transpose_.outerIndexPtr()[j] == transpose_.outerIndexPtr()[j + 1]) ++quality_.without_load;
}

// u_f = W u_s
Field Mapping::consistent(const Field& on_structure) const {
  return apply(weights_, on_structure);
}

// f_s = Wᵀ f_f, hence f_s·u_s = f_f·W u_s = f_f·u_f
Field Mapping::conservative(const Field& on_fluid) const {
  return apply(transpose_, on_fluid);
}

Mapping nearest_neighbour(const InterfaceMesh& structure, const InterfaceMesh& fluid, double limit) {
  check_meshes(structure, fluid);
  const Tree tree(structure.position);
  std::vector<Triplet> entries;
  MappingQuality quality;
  for (Index i = 0; i < fluid.position.cols(); ++i) {
    const Vector3d p = fluid.position.col(i);
    const double nearest = tree.nearest_distance(p);
    // Equally near points: the first, whatever order the tree has.
    entries.emplace_back(i, tree.within(p, nearest * (1 + round_off)).front(), 1.0);
    if (nearest > quality.largest_distance || quality.farthest < 0) {
      quality.largest_distance = nearest;
      quality.farthest = i;
    }
  }
  check_distance(quality, limit, structure, fluid);
  return build(fluid.position.cols(), structure.position.cols(), entries, quality);
}

Mapping nearest_projection(const InterfaceMesh& structure, const InterfaceMesh& fluid, double limit) {
  check_meshes(structure, fluid);
  if (structure.faces.cols() == 0)
    throw Error(ExitCode::case_file, title(structure, fluid),
                "the structure's interface has no faces to project on",
                "coupling.surface.mapping.kind = \"nearest-neighbour\"");
  if (structure.faces.rows() != structure.dimension)
    throw Error(
        ExitCode::case_file, title(structure, fluid),
        fmt::format("faces of {} points in {} dimensions", structure.faces.rows(), structure.dimension),
        "faces are segments in 2-D and triangles in 3-D");
  const Surface surface(structure);
  const Tree tree(surface.centres());
  std::vector<Triplet> entries;
  MappingQuality quality;
  for (Index i = 0; i < fluid.position.cols(); ++i) {
    const Vector3d p = fluid.position.col(i);
    // The nearest face is no farther than the nearest centre, and its own centre at most `reach` beyond.
    const double bound = tree.nearest_distance(p);
    Foot best;
    Index face = -1;
    for (const Index f : tree.within(p, (bound + surface.reach()) * (1 + round_off))) {
      const Foot foot = surface.foot(p, f);
      // Among equally near faces the one that contains the foot, then the first.
      const double tie = round_off * (bound + surface.reach());
      if (face < 0 || foot.distance < best.distance - tie ||
          (foot.distance <= best.distance + tie && foot.inside && !best.inside)) {
        best = foot;
        face = f;
      }
    }
    assert(face >= 0);
    for (Index k = 0; k < structure.faces.rows(); ++k)
      if (best.weight[static_cast<std::size_t>(k)] != 0)
        entries.emplace_back(i, structure.faces(k, face), best.weight[static_cast<std::size_t>(k)]);
    if (!best.inside) ++quality.outside;
    if (best.distance > quality.largest_distance || quality.farthest < 0) {
      quality.largest_distance = best.distance;
      quality.farthest = i;
    }
  }
  check_distance(quality, limit, structure, fluid);
  return build(fluid.position.cols(), structure.position.cols(), entries, quality);
}

Mapping identity(const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  check_meshes(structure, fluid);
  const Index n = structure.position.cols();
  if (fluid.position.cols() != n)
    throw Error(
        ExitCode::case_file, title(structure, fluid),
        fmt::format("the structure has {} points, the fluid {}: the identity needs the same points", n,
                    fluid.position.cols()),
        "coupling.interface = \"volume\" needs structure.solver = \"particle\" and fluid.solver = \"mps\"");
  MappingQuality quality;
  std::vector<Triplet> entries;
  for (Index i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 1.0);
    const double distance = (fluid.position.col(i) - structure.position.col(i)).norm();
    if (distance > quality.largest_distance || quality.farthest < 0) {
      quality.largest_distance = distance;
      quality.farthest = i;
    }
  }
  const double size =
      (structure.position.rowwise().maxCoeff() - structure.position.rowwise().minCoeff()).norm();
  check_distance(quality, round_off * (size + structure.position.cwiseAbs().maxCoeff()), structure, fluid);
  return build(n, n, entries, quality);
}

Mapping make_mapping(const std::string& kind, const InterfaceMesh& structure, const InterfaceMesh& fluid,
                     double limit) {
  if (kind == "nearest-neighbour") return nearest_neighbour(structure, fluid, limit);
  if (kind == "nearest-projection") return nearest_projection(structure, fluid, limit);
  if (kind == "identity") return identity(structure, fluid);
  throw Error(ExitCode::case_file, "coupling.surface.mapping.kind",
              fmt::format("\"{}\" is not a mapping", kind), "nearest-projection or nearest-neighbour");
}

}  // namespace strake
