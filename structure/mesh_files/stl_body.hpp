#pragma once

#include "structure/body/closed_surface.hpp"

#include <filesystem>

namespace strake::structure {

/// Reads a rigid body from an STL file (proto/mesh_files/stl.hpp), in the file's unit. Corners nearer
/// together than a millionth of the body's extent become one point; triangles that this leaves without area
/// are left out. Separate pieces are turned so that their normals point out of the material. A piece inside
/// another is a hollow. ClosedSurface::lines tells all of this.
///
/// Throws Error(case_file) with places in the file's unit. Faults: open edges; edges with more than two
/// triangles; triangles turned against their neighbours; triangles without area; triangles that cut one
/// another; a body without volume; pieces inside hollows.
ClosedSurface read_stl_body(const std::filesystem::path&);

}  // namespace strake::structure
