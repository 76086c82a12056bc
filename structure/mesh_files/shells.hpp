#pragma once

#include "structure/body/closed_surface.hpp"

#include <string>

namespace strake::structure {

/// A place as errors name it: "(1, 0, 0.5)".
std::string place_text(const Eigen::Vector3d&);

/// Sorts the triangles of a closed surface by its separate pieces (shells): outer ones first, then hollows.
/// Each edge must have two triangles of opposite direction. Shells are turned over where their normals point
/// into the material, and `lines` tell it. `file` is named in errors.
///
/// Throws Error(case_file) for a shell without volume, a shell inside a hollow, and too many shells.
void sort_shells(ClosedSurface&, const std::string& file);

}  // namespace strake::structure
