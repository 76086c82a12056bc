#pragma once

#include <array>
#include <filesystem>

namespace strake {

/// Smallest and largest coordinates of a mesh's nodes, in the file's unit.
struct MeshExtent {
  std::array<double, 3> min = {}, max = {};
};

/// Reads the nodes of a Gmsh file (ASCII, 2.2 or 4.1), an Abaqus file or an STL file. It reads nothing else:
/// whether the mesh is good the solver says. Throws Error(case_file) for a file without nodes.
MeshExtent read_mesh_extent(const std::filesystem::path& file);

}  // namespace strake
