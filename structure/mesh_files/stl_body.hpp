#pragma once

#include "structure/body/closed_surface.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>

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

/// A place as errors name it: "(1, 0, 0.5)".
std::string place_text(const Eigen::Vector3d&);

/// Sorts the triangles of a closed surface by its separate pieces (shells): outer ones first, then hollows.
/// Each edge must have two triangles of opposite direction. Shells are turned over where their normals point
/// into the material, and `lines` tell it. `file` is named in errors.
///
/// Throws Error(case_file) for a shell without volume, a shell inside a hollow, and too many shells.
void sort_shells(ClosedSurface&, const std::string& file);

/// Where a surface goes through itself.
struct SelfCuts {
  std::size_t pairs = 0;                            // of triangles that cut one another
  std::array<Eigen::Index, 2> first;                // such a pair, the one with the lowest numbers
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // where an edge of one goes through the other
};

/// Finds the pairs of triangles of which an edge of one goes through the other, more than `slack` inside
/// its border and on both sides. Triangles that touch, lie in one plane or share an edge are no such pair. A
/// tree of boxes around the triangles finds the candidates.
SelfCuts find_self_cuts(const ClosedSurface&, double slack);

}  // namespace strake::structure
