#pragma once

#include "proto/mesh_files/mesh_text.hpp"
#include "structure/body/solid.hpp"

#include <filesystem>
#include <utility>

namespace strake::structure {

/// Reads a solid's cells from a mesh file: Gmsh (.msh, formats 2.2 and 4.1, text) or Abaqus (.inp). Of Abaqus
/// it reads the keywords *NODE, *ELEMENT, *NSET, *ELSET.
///
/// Cells are linear: quadrilaterals in two dimensions (in the plane z = 0), hexahedra in three; curved sides
/// are as exact as the mesh is fine. Triangles, tetrahedra and prisms are cut into such cells. Parts are the
/// physical groups of cells (Abaqus: the element sets). Named faces are the physical groups of their sides
/// (Abaqus: node sets; a facet belongs to the set that has all its nodes). Each named face stands in
/// Solid::supported, free. All parts have the `material`. A side may be in several groups, a cell in one.
///
/// Throws Error(case_file) with the line of the file that is wrong.
/// parts: names of parts in the case. Of several element sets of an Abaqus file a cell belongs to the one
/// with such a name.
Solid read_mesh(const std::filesystem::path&, int dimension, const Material&,
                const std::vector<std::string>& parts = {});

/// Whether a mesh of this dimension has triangles, tetrahedra or prisms as cells.
bool has_simplices(const MeshText&, int dimension);

/// Cuts every cell at the middles of its edges and faces: a triangle into three quadrilaterals, a tetrahedron
/// into four hexahedra, a prism into six; quadrilaterals and hexahedra into four and eight, so that all still
/// meet. The body's shape does not change. Sides with names and node sets are cut alike. Pyramids stay: they
/// have no such cut.
MeshText cut_into_quadrilaterals(const MeshText&, int dimension);

/// Cells of a solid that lie over one another.
struct CellOverlaps {
  Eigen::Index cells = 0;                           // that reach into another
  std::pair<int, int> first = {-1, -1};             // such a cell and another; the lowest numbers
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // in the one, inside the other [m]
};

/// Counts the cells that have their middle, or the neighbourhood of a corner, inside another cell.
///
/// The middle M of a sound cell is the mean of its corners X. The other places are X + (M − X)/5. A place
/// counts where it lies behind the planes of all sides of both cells. The plane of a side that two cells
/// share divides them, however bent the side is. So cells that meet along sides do not count. Cells that
/// reach into one another by less than an eighth of their size are not found. Cost: n log n for n cells.
CellOverlaps find_overlaps(const Solid&);

}  // namespace strake::structure
