#include "structure/body/loaded_faces.hpp"

#include "proto/error.hpp"
#include "structure/body/surface.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace strake::structure {
namespace {

/// Length of a segment [m], area of a triangle [m²].
double size_of(const InterfaceMesh& mesh, Eigen::Index face) {
  const auto corner = [&](Eigen::Index k) -> Eigen::Vector3d {
    return mesh.position.col(mesh.faces(k, face));
  };
  if (mesh.faces.rows() == 2) return (corner(1) - corner(0)).norm();
  return 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
}

/// A face of the surface lies in one facet with its middle.
bool lies_in(const Solid& solid, const std::vector<int>& facets, const InterfaceMesh& mesh, Eigen::Index face,
             double near) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < mesh.faces.rows(); ++k)
    middle += mesh.position.col(mesh.faces(k, face)) / static_cast<double>(mesh.faces.rows());
  return std::any_of(facets.begin(), facets.end(),
                     [&](int facet) { return on_facet(solid, facet, middle, near); });
}

}  // namespace

LoadedFaces loaded_faces(const Parameters& p, const InterfaceMesh& mesh) {
  const char* unit = mesh.dimension == 3 ? "m^2" : "m";
  LoadedFaces loaded;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) loaded.whole += size_of(mesh, f);
  if (p.loaded_faces.empty()) {
    loaded.size = loaded.whole;
    loaded.line = fmt::format("wet: the whole outer surface, {:.5g} {}", loaded.whole, unit);
    return loaded;
  }
  const Solid solid = elastic_solid(p);
  const Eigen::Vector3d extent = solid.node.rowwise().maxCoeff() - solid.node.rowwise().minCoeff();
  const double near = 1e-9 * extent.maxCoeff();  // [m] round-off of the coordinates, far below any spacing
  std::vector<int> facets;
  std::string names;
  for (const std::string& name : p.loaded_faces) {
    const std::vector<int> named = facets_named(solid, name);
    facets.insert(facets.end(), named.begin(), named.end());
    names += (names.empty() ? "" : ", ") + name;
  }
  loaded.share = Eigen::VectorXd::Zero(mesh.position.cols());
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    if (!lies_in(solid, facets, mesh, f, near)) continue;
    const double size = size_of(mesh, f);
    loaded.size += size;
    for (Eigen::Index k = 0; k < mesh.faces.rows(); ++k)
      loaded.share[mesh.faces(k, f)] += size / static_cast<double>(mesh.faces.rows());
  }
  const Eigen::VectorXd whole = point_sizes(mesh);
  for (Eigen::Index i = 0; i < whole.size(); ++i)
    if (whole[i] > 0) loaded.share[i] = std::min(1.0, loaded.share[i] / whole[i]);
  loaded.line =
      fmt::format("wet: {}, {:.5g} {} of {:.5g} {}; water that presses elsewhere is kept out and not felt",
                  names, loaded.size, unit, loaded.whole, unit);
  return loaded;
}

}  // namespace strake::structure
