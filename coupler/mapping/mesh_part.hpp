#pragma once

#include "coupler/mapping/mapping.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <string>

namespace strake {

/// Where one of several meshes that a solver has joined lies in the joined one.
struct MeshRange {
  Eigen::Index point = 0, points = 0, face = 0, faces = 0;
};

/// The range of the mesh of that name (InterfaceMesh::meshes); the whole mesh if it is one alone. Throws
/// Error(solver_fault) for a name that is not there.
MeshRange range_of(const InterfaceMesh&, const std::string& name);
/// That mesh alone, with its faces on its own points.
InterfaceMesh mesh_part(const InterfaceMesh&, const std::string& name);
/// The values of a field on its points.
Field on_part(const Field&, const MeshRange&);

/// A mapping between two such meshes as one between the joined ones. W stands in a block of a larger matrix.
/// All other rows and columns are empty: a field is zero there. The quality is that of the block.
Mapping embedded(const Mapping&, const InterfaceMesh& from, const MeshRange& source, const InterfaceMesh& to,
                 const MeshRange& target);

}  // namespace strake
