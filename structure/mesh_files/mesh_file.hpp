#pragma once

#include "structure/body/solid.hpp"

#include <filesystem>

namespace strake::structure {

/// Reads a solid's cells from a mesh file: Gmsh (.msh, formats 2.2 and 4.1, text) or Abaqus (.inp, the
/// keywords *NODE, *ELEMENT, *NSET, *ELSET). Quadrilaterals in two dimensions (in the plane z = 0), hexahedra
/// in three, linear: curved sides are as exact as the mesh is fine. Parts are the physical groups of cells
/// (Abaqus: the element sets), named faces those of their sides (Abaqus: node sets, a facet belonging to the
/// set that holds all its nodes); each named face stands in Solid::supported, free. All parts have the
/// `material`. Throws Error(case_file) with the line of the file where something is wrong with it.
Solid read_mesh(const std::filesystem::path&, int dimension, const Material&);

}  // namespace strake::structure
