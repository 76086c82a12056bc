#pragma once

#include "proto/mesh_files/mesh_text.hpp"

namespace strake::structure {

/// Whether a mesh of this dimension has triangles, tetrahedra or prisms as cells.
bool has_simplices(const MeshText&, int dimension);

/// Cuts every cell at the middles of its edges and faces: a triangle into three quadrilaterals, a tetrahedron
/// into four hexahedra, a prism into six; quadrilaterals and hexahedra into four and eight, so that all still
/// meet. The body's shape does not change. Sides with names and node sets are cut alike. Pyramids stay: they
/// have no such cut.
MeshText cut_into_quadrilaterals(const MeshText&, int dimension);

}  // namespace strake::structure
