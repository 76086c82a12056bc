#include "proto/mesh_files/mesh_text.hpp"

#include "proto/error.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace strake {

namespace {

// New nodes are numbered from the largest on.
constexpr long largest_number = 1'000'000'000'000'000;

MeshText read_of_its_kind(const std::filesystem::path& path) {
  const std::string ending = lower_case(path.extension().string());
  if (ending == ".msh") return read_gmsh(path);
  if (ending == ".inp") return read_abaqus(path);
  throw Error(ExitCode::case_file, path.string(), "a mesh file ends in .msh (Gmsh) or .inp (Abaqus)",
              "gmsh -2 -format msh41 FILE.geo");
}

}  // namespace

MeshText read_mesh_text(const std::filesystem::path& path) {
  MeshText mesh = read_of_its_kind(path);
  if (!mesh.node.empty() && mesh.node.rbegin()->first > largest_number)
    throw Error(
        ExitCode::case_file, path.string(),
        fmt::format("has a node of number {}, the largest is {}", mesh.node.rbegin()->first, largest_number),
        "number the nodes anew: 1, 2, 3 …");
  return mesh;
}

bool is_face(const MeshText::Element& element, int dimension) {
  if (dimension == 2) return element.kind == "line";
  return element.kind == "triangle" || element.kind == "quadrilateral";
}

// A side in several groups stands there once for each.
Eigen::MatrixXi faces_of(const std::vector<std::vector<int>>& walks, const Points& position, int dimension,
                         const std::string& file) {
  const auto distance = [&](int a, int b) { return (position.col(a) - position.col(b)).norm(); };
  std::vector<int> corners;
  std::set<std::vector<int>> known;
  for (const std::vector<int>& p : walks) {
    std::vector<int> points = p;
    std::sort(points.begin(), points.end());
    if (!known.insert(std::move(points)).second) continue;
    if (p.size() < 4)
      corners.insert(corners.end(), p.begin(), p.end());
    else if (distance(p[0], p[2]) <= distance(p[1], p[3]))
      corners.insert(corners.end(), {p[0], p[1], p[2], p[0], p[2], p[3]});
    else
      corners.insert(corners.end(), {p[0], p[1], p[3], p[1], p[2], p[3]});
  }
  if (corners.empty())
    throw Error(ExitCode::case_file, file,
                dimension == 2 ? "holds no lines" : "holds no triangles and no quadrilaterals",
                "mesh the surface that meets the water, or give it a physical group");
  return Eigen::Map<Eigen::MatrixXi>(corners.data(), dimension,
                                     static_cast<Eigen::Index>(corners.size()) / dimension);
}

}  // namespace strake
