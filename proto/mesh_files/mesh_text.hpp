#pragma once

#include "proto/interface.hpp"

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
  std::map<std::string, std::vector<long>> node_set;     // Abaqus
  std::map<std::string, std::vector<long>> element_set;  // Abaqus: all sets, where an element has several
  /// Vectors on nodes, by name; Gmsh.
  std::map<std::string, std::map<long, std::array<double, 3>>> node_data;
};

/// All throw Error(case_file) that names file and line. The first goes by the ending: .msh or .inp.
MeshText read_mesh_text(const std::filesystem::path&);
MeshText read_gmsh(const std::filesystem::path&);
MeshText read_abaqus(const std::filesystem::path&);
/// The text of a Gmsh file; `name` stands for it in errors.
MeshText read_gmsh_text(const std::string& text, const std::string& name);

/// Whether an element is a face of a surface: a line in two dimensions, else a triangle or a quadrilateral.
bool is_face(const MeshText::Element&, int dimension);
/// Faces of a surface, dimension×m indices of points, from the points of each face walked around.
/// Quadrilaterals become two triangles, cut along the shorter diagonal. Throws Error(case_file) that names
/// `file` where there are none.
Eigen::MatrixXi faces_of(const std::vector<std::vector<int>>& walks, const Points& position, int dimension,
                         const std::string& file);

/// A surface as the text of a Gmsh file (format 2.2): its points, its segments or triangles, and vectors on
/// its points. Every number reads back to the same float64.
/// mesh: n points [m], m faces; fields: 3×n each; others are left out.
std::string gmsh_text(const InterfaceMesh& mesh, const std::vector<Field>& fields);

}  // namespace strake
