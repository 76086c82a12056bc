#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace strake {

/// Content of a mesh file in its own form: nodes and elements by their numbers.
struct MeshText {
  struct Element {
    long number = 0;
    std::size_t line = 0;
    std::string kind;             // "quadrilateral" | "hexahedron" | "line" | "triangle" | …
    std::string group;            // name of its physical group or element set; empty: none
    std::vector<long> node = {};  // corners, walked around (hexahedra: bottom, then top)
  };
  std::map<long, std::array<double, 3>> node;  // [m]
  std::vector<Element> element;
  std::map<std::string, std::vector<long>> node_set;  // Abaqus
};

/// All throw Error(case_file) that names file and line. The first goes by the ending: .msh or .inp.
MeshText read_mesh_text(const std::filesystem::path&);
MeshText read_gmsh(const std::filesystem::path&);
MeshText read_abaqus(const std::filesystem::path&);

}  // namespace strake
