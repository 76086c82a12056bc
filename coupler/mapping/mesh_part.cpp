#include "coupler/mapping/mesh_part.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

namespace strake {

using Eigen::Index;

MeshRange range_of(const InterfaceMesh& mesh, const std::string& name) {
  if (mesh.meshes.empty()) return {0, mesh.position.cols(), 0, mesh.faces.cols()};
  std::string names;
  for (std::size_t k = 0; k < mesh.meshes.size(); ++k) {
    const MeshPart& part = mesh.meshes[k];
    names += (names.empty() ? "" : ", ") + part.name;
    if (part.name != name) continue;
    const bool last = k + 1 == mesh.meshes.size();
    return {part.first_point,
            (last ? mesh.position.cols() : mesh.meshes[k + 1].first_point) - part.first_point,
            part.first_face, (last ? mesh.faces.cols() : mesh.meshes[k + 1].first_face) - part.first_face};
  }
  throw Error(ExitCode::solver_fault, mesh.name, fmt::format("has no mesh \"{}\"", name),
              "its meshes are " + names);
}

InterfaceMesh mesh_part(const InterfaceMesh& mesh, const std::string& name) {
  if (mesh.meshes.empty()) return mesh;
  const MeshRange range = range_of(mesh, name);
  InterfaceMesh part;
  part.name = name;
  part.dimension = mesh.dimension;
  part.position = mesh.position.middleCols(range.point, range.points);
  part.faces = mesh.faces.middleCols(range.face, range.faces).array() - static_cast<int>(range.point);
  if (mesh.mass.size() > 0) part.mass = mesh.mass.segment(range.point, range.points);
  return part;
}

Field on_part(const Field& field, const MeshRange& range) {
  if (range.points == field.value.cols()) return field;
  return {field.quantity, field.unit, field.conservative,
          Eigen::MatrixXd(field.value.middleCols(range.point, range.points))};
}

Mapping embedded(const Mapping& mapping, const InterfaceMesh& from, const MeshRange& source,
                 const InterfaceMesh& to, const MeshRange& target) {
  const Index n_from = from.position.cols(), n_to = to.position.cols();
  if (source.points == n_from && target.points == n_to) return mapping;
  return mapping.embedded({target.point, n_to}, {source.point, n_from});
}

}  // namespace strake
