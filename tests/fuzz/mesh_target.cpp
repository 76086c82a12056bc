// A mesh file of any bytes must be read, or refused with an Error that names the file.
//
// Bytes → file: the first byte chooses among Gmsh (.msh), Abaqus (.inp) and STL (.stl); the rest is the file.

#include "proto/error.hpp"
#include "proto/mesh_files/mesh_text.hpp"
#include "proto/mesh_files/stl.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <array>
#include <cstdlib>

using namespace strake;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<const char*, 3> names = {"a.msh", "a.inp", "a.stl"};
  static const TemporaryFolder folder;
  if (size == 0) return 0;
  const std::filesystem::path file = folder / names[data[0] % names.size()];
  put(file, std::string(reinterpret_cast<const char*>(data + 1), size - 1));
  try {
    if (is_stl(file)) {
      if (read_stl(file).cols() % 3 != 0) std::abort();  // three corners of each triangle
      return 0;
    }
    const MeshText mesh = read_mesh_text(file);
    if (mesh.node.empty() || mesh.element.empty()) std::abort();
  } catch (const Error& error) {
    const std::string text = to_text(error);
    if (text.find(file.filename().string()) == std::string::npos || text.size() > 65536)
      std::abort();  // a refusal says where and why, briefly
  }
  return 0;
}

std::vector<std::string> seeds() {
  using namespace std::string_literals;
  const std::string names = "$PhysicalNames\n2\n1 7 \"clamp\"\n2 1 \"steel\"\n$EndPhysicalNames\n";
  const std::string data = "$NodeData\n1\n\"v\"\n1\n0\n3\n0\n3\n2\n1 1 2 3\n2 1e3 -1 nan\n$EndNodeData\n";
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 +1e0 0\nendloop\nendfacet\n";
  return {"\0$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"s + names +
              "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n"
              "$Elements\n2\n1 1 2 7 4 4 1\n2 3 2 1 1 1 2 3 4\n$EndElements\n" +
              data,
          "\0$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"s + names +
              "$Entities\n0 1 1 0\n4 0 0 0 0 1 0 1 7 0\n1 0 0 0 1 1 0 1 1 0\n$EndEntities\n"
              "$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n"
              "$Elements\n2 2 1 2\n1 4 1 1\n1 4 1\n2 1 3 1\n2 1 2 3 4\n$EndElements\n",
          "\1*HEADING\na cell\n*NODE\n1, 0., 0.\n2, 1., 0.\n3, 1., 1.\n4, 0., 1.\n*ELEMENT, TYPE=CPE4, "
          "ELSET=steel\n1, 1, 2,\n3, 4\n** a comment\n*NSET, NSET=lower, GENERATE\n1, 3, 2\n*ELSET, "
          "ELSET=all\n1\n"s,
          "\2solid a\n"s + facet + "endsolid a\nsolid b\n" + facet + "endsolid b\n",
          "\2"s + std::string(80, 'h') + "\1\0\0\0"s + std::string(48, '\0') + "\0\0"s};
}
