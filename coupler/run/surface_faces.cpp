#include "coupler/run/surface_faces.hpp"

#include "coupler/mapping/point_tree.hpp"
#include "proto/error.hpp"
#include "proto/mesh_files/mesh_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Where two faces may meet: a point of a segment, an edge of a triangle (two points, the smaller first).
using Ridge = std::pair<int, int>;
/// A ridge with the sense in which its face passes it; neighbours of one direction pass it in two senses.
struct Passed {
  Ridge ridge;
  bool forward;
};

std::vector<Passed> ridges_of(const Eigen::MatrixXi& faces, Index f) {
  std::vector<Passed> passed;
  if (faces.rows() == 2) return {{{faces(0, f), -1}, false}, {{faces(1, f), -1}, true}};
  for (int k = 0; k < 3; ++k) {
    const int a = faces(k, f), b = faces((k + 1) % 3, f);
    passed.push_back({{std::min(a, b), std::max(a, b)}, a < b});
  }
  return passed;
}

void turn(Eigen::MatrixXi& faces, Index f) {
  std::swap(faces(0, f), faces(1, f));
}

/// Twice the area, or six times the volume, that a face adds to what its piece encloses.
double enclosed(const Eigen::MatrixXi& faces, Index f, const Points& position, const Vector3d& origin) {
  const auto at = [&](int k) -> Vector3d { return position.col(faces(k, f)) - origin; };
  const Vector3d normal = at(0).cross(at(1));
  return faces.rows() == 2 ? normal.z() : normal.dot(at(2));
}

/// Faces that share a ridge; at most two may.
std::map<Ridge, std::vector<Index>> neighbours(const Eigen::MatrixXi& faces) {
  std::map<Ridge, std::vector<Index>> meet;
  for (Index f = 0; f < faces.cols(); ++f)
    for (const Passed& passed : ridges_of(faces, f)) meet[passed.ridge].push_back(f);
  return meet;
}

bool passes_forward(const Eigen::MatrixXi& faces, Index f, const Ridge& ridge) {
  for (const Passed& passed : ridges_of(faces, f))
    if (passed.ridge == ridge) return passed.forward;
  return false;
}

// ---- from a file

class SurfaceFile {
 public:
  SurfaceFile(const std::filesystem::path& file, const InterfaceMesh& mesh)
      : file_(file), text_(read_mesh_text(file)), mesh_(mesh), tree_(mesh.position) {}

  Eigen::MatrixXi faces() {
    std::vector<int> corners;
    for (const MeshText::Element& element : text_.element) {
      const std::string& kind = element.kind;
      if (mesh_.dimension == 2 ? kind != "line" : kind != "triangle" && kind != "quadrilateral") continue;
      const std::vector<int> points = points_of(element);
      if (points.size() < 4) {
        corners.insert(corners.end(), points.begin(), points.end());
        continue;
      }
      const bool first = distance(points[0], points[2]) <= distance(points[1], points[3]);
      for (const int k : first ? std::array{0, 1, 2, 0, 2, 3} : std::array{0, 1, 3, 1, 2, 3})
        corners.push_back(points[static_cast<std::size_t>(k)]);
    }
    if (corners.empty())
      refuse(0, mesh_.dimension == 2 ? "holds no lines" : "holds no triangles and no quadrilaterals",
             "mesh the surface that meets the water, or give it a physical group");
    return Eigen::Map<Eigen::MatrixXi>(corners.data(), mesh_.dimension,
                                       static_cast<Index>(corners.size()) / mesh_.dimension);
  }
  [[noreturn]] void refuse(std::size_t line, const std::string& problem, const std::string& fix) const {
    const std::string where = line > 0 ? fmt::format("{}:{}", file_.string(), line) : file_.string();
    throw Error(ExitCode::case_file, where, problem, fix);
  }

 private:
  double distance(int a, int b) const { return (mesh_.position.col(a) - mesh_.position.col(b)).norm(); }

  std::vector<int> points_of(const MeshText::Element& element) {
    std::vector<int> points;
    for (const long node : element.node) {
      const int point = point_of(node, element.line);
      if (std::find(points.begin(), points.end(), point) != points.end())
        refuse(element.line,
               fmt::format("two corners of {} {} lie at one point", element.kind, element.number),
               "mesh the surface as the structure's solver has it");
      points.push_back(point);
    }
    return points;
  }

  int point_of(long node, std::size_t line) {
    if (const auto known = point_.find(node); known != point_.end()) return known->second;
    constexpr double tolerance = 1e-6;  // of the extent
    const auto& X = mesh_.position;
    const double extent = (X.rowwise().maxCoeff() - X.rowwise().minCoeff()).maxCoeff();
    const auto found = text_.node.find(node);
    if (found == text_.node.end())
      refuse(line, fmt::format("there is no node {}", node), "write the mesh anew");
    const Vector3d x(found->second[0], found->second[1], found->second[2]);
    const double away = tree_.nearest_distance(x);
    if (away > tolerance * extent)
      refuse(line,
             fmt::format(
                 "node {} at ({:g}, {:g}, {:g}) m lies {:.3g} m from the nearest point that the structure "
                 "sends, at most {:.3g} m is allowed",
                 node, x.x(), x.y(), x.z(), away, tolerance * extent),
             "the surface must have the structure's own points: mesh both from one file");
    return point_[node] = static_cast<int>(tree_.nearest(x, 0));
  }

  std::filesystem::path file_;
  MeshText text_;
  const InterfaceMesh& mesh_;
  PointTree tree_;
  std::map<long, int> point_;  // of a node
};

}  // namespace

bool orient(Eigen::MatrixXi& faces, const Points& position) {
  const auto meet = neighbours(faces);
  for (const auto& [ridge, sharing] : meet)
    if (sharing.size() > 2) return false;
  std::vector<char> seen(static_cast<std::size_t>(faces.cols()), 0);
  for (Index first = 0; first < faces.cols(); ++first) {
    if (seen[static_cast<std::size_t>(first)] != 0) continue;
    std::vector<Index> piece = {first};
    seen[static_cast<std::size_t>(first)] = 1;
    bool closed = true;
    for (std::size_t k = 0; k < piece.size(); ++k)
      for (const Passed& passed : ridges_of(faces, piece[k])) {
        const std::vector<Index>& sharing = meet.at(passed.ridge);
        if (sharing.size() < 2) {
          closed = false;
          continue;
        }
        const Index other = sharing[0] == piece[k] ? sharing[1] : sharing[0];
        const bool alike = passes_forward(faces, other, passed.ridge) != passed.forward;
        if (seen[static_cast<std::size_t>(other)] != 0) {
          if (!alike) return false;
          continue;
        }
        if (!alike) turn(faces, other);
        seen[static_cast<std::size_t>(other)] = 1;
        piece.push_back(other);
      }
    double inside = 0;
    for (const Index f : piece) inside += enclosed(faces, f, position, position.col(faces(0, first)));
    if (closed && inside < 0)
      for (const Index f : piece) turn(faces, f);
  }
  return true;
}

Eigen::MatrixXi faces_from_file(const std::filesystem::path& file, const InterfaceMesh& mesh) {
  SurfaceFile surface(file, mesh);
  Eigen::MatrixXi faces = surface.faces();
  if (!orient(faces, mesh.position))
    surface.refuse(0,
                   mesh.dimension == 2
                       ? "more than two lines meet at a point, or two lines lie on each other"
                       : "more than two faces meet at an edge, or its surface has one side only",
                   "mesh the outer surface of the structure alone");
  return faces;
}

}  // namespace strake
