#pragma once

#include "proto/interface.hpp"

#include <Eigen/Core>

#include <filesystem>

namespace strake {

/// Faces of a structure that sends its points alone, from a mesh of its surface (structure.surface).
///
/// The file is Gmsh's (.msh, formats 2.2 and 4.1, text) or Abaqus' (.inp). In two dimensions its lines are
/// taken, in three its triangles, and its quadrilaterals cut along the shorter diagonal. Each of their nodes
/// must lie at a point of `mesh`, within 1e-6 of the mesh's extent. The faces of one connected piece get one
/// direction: out of the enclosed body where the piece is closed, else that of its first face in the file.
///
/// Returns dimension×m indices of points. Throws Error(case_file) that names the file and what is wrong.
Eigen::MatrixXi faces_from_file(const std::filesystem::path& file, const InterfaceMesh& mesh);

}  // namespace strake
