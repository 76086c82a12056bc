#include "coupler/run/surface_faces.hpp"

#include "coupler/mapping/point_tree.hpp"
#include "proto/error.hpp"
#include "proto/geometry/face_direction.hpp"
#include "proto/mesh_files/mesh_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace strake {
namespace {

using Eigen::Vector3d;

class SurfaceFile {
 public:
  SurfaceFile(const std::filesystem::path& file, const InterfaceMesh& mesh)
      : file_(file), text_(read_mesh_text(file)), mesh_(mesh), tree_(mesh.position) {}

  Eigen::MatrixXi faces() {
    std::vector<std::vector<int>> walks;
    for (const MeshText::Element& element : text_.element)
      if (is_face(element, mesh_.dimension)) walks.push_back(points_of(element));
    return faces_of(walks, mesh_.position, mesh_.dimension, file_.string());
  }
  [[noreturn]] void refuse(std::size_t line, const std::string& problem, const std::string& fix) const {
    const std::string where = line > 0 ? fmt::format("{}:{}", file_.string(), line) : file_.string();
    throw Error(ExitCode::case_file, where, problem, fix);
  }

 private:
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
