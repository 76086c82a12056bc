#include "proto/mesh_files/mesh_text.hpp"

#include <fmt/format.h>

namespace strake {

std::string gmsh_text(const InterfaceMesh& mesh, const std::vector<Field>& fields) {
  constexpr int line = 1, triangle = 2;  // Gmsh's numbers of elements
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  const auto n = mesh.position.cols(), m = mesh.faces.cols();
  text += fmt::format("$Nodes\n{}\n", n);
  for (Eigen::Index i = 0; i < n; ++i)
    text +=
        fmt::format("{} {} {} {}\n", i + 1, mesh.position(0, i), mesh.position(1, i), mesh.position(2, i));
  text += fmt::format("$EndNodes\n$Elements\n{}\n", m);
  for (Eigen::Index f = 0; f < m; ++f) {
    text += fmt::format("{} {} 2 0 0", f + 1, mesh.faces.rows() == 2 ? line : triangle);
    for (Eigen::Index k = 0; k < mesh.faces.rows(); ++k) text += fmt::format(" {}", mesh.faces(k, f) + 1);
    text += "\n";
  }
  text += "$EndElements\n";
  for (const Field& field : fields) {
    if (field.value.rows() != 3 || field.value.cols() != n) continue;
    text += fmt::format("$NodeData\n1\n\"{}\"\n1\n0\n3\n0\n3\n{}\n", field.quantity, n);
    for (Eigen::Index i = 0; i < n; ++i)
      text += fmt::format("{} {} {} {}\n", i + 1, field.value(0, i), field.value(1, i), field.value(2, i));
    text += "$EndNodeData\n";
  }
  return text;
}

}  // namespace strake
