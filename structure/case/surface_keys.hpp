#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

#include <filesystem>

namespace strake::structure {

/// A body of structure.mesh that is an STL file, x ↦ map x + move with both of [structure.placed]. Fills
/// Parameters::closed_surface and sets the shape's kind. Throws Error(case_file) if the file or the solver
/// does not allow such a body.
void read_surface_body(CaseTable structure, Parameters&, const std::filesystem::path& stl,
                       const Eigen::Matrix3d& map, const Eigen::Vector3d& move);

}  // namespace strake::structure
