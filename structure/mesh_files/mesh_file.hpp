#pragma once

#include "structure/body/solid.hpp"

#include <filesystem>

namespace strake::structure {

/// Reads a solid's cells from a mesh file: Gmsh (.msh, formats 2.2 and 4.1, text) or Abaqus (.inp). Of Abaqus
/// it reads the keywords *NODE, *ELEMENT, *NSET, *ELSET.
///
/// Cells are linear: quadrilaterals in two dimensions (in the plane z = 0), hexahedra in three; curved sides
/// are as exact as the mesh is fine. Triangles, tetrahedra and prisms are cut into such cells. Parts are the
/// physical groups of cells (Abaqus: the element sets). Named faces are the physical groups of their sides
/// (Abaqus: node sets; a facet belongs to the set that has all its nodes). Each named face stands in
/// Solid::supported, free. All parts have the `material`.
///
/// Throws Error(case_file) with the line of the file that is wrong.
Solid read_mesh(const std::filesystem::path&, int dimension, const Material&);

}  // namespace strake::structure
