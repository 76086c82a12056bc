#pragma once

#include "proto/geometry/corner.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <numbers>
#include <vector>

namespace strake::fluid {

/// The smooth parts of a closed surface of triangles, and the edges between them.
struct SurfacePatches {
  /// An edge of a patch, in the order of its own triangle. angle: inside the body [rad], π where flat, less
  /// where convex. sharp: water leaves the body there, by the angle and both triangles' normals. The stem of
  /// a hull with a round bottom divides no patch: it ends in the smooth surface. Then `other` is `patch`,
  /// and each of its sides is an edge.
  struct Border {
    int patch = 0, triangle = 0, from = 0, to = 0;  // points of the mesh
    int other = 0, other_triangle = 0;              // the patch and the triangle beyond it
    double angle = 0;
    bool sharp = false;
    /// Whether this is the first of the two sides of the edge.
    bool is_first() const { return patch < other || (patch == other && from < to); }
    /// Whether the faces beside it meet in the plane that halves the angle (F85).
    bool is_halved() const { return !sharp && angle < std::numbers::pi; }
    /// Whether this is a chine with one patch on both sides, blunter than a right angle: `Bend::chine`, or
    /// one that ends in the smooth surface.
    bool is_within_patch() const { return patch == other && angle >= right_angle; }
  };
  std::vector<int> of_triangle;
  std::vector<int> part_of_triangle;  // of patches: chines and knuckles divide them too; numbered from 0
  Eigen::Matrix3Xi corner;  // of the triangles: those at one point have one corner where no edge divides them
  std::vector<double> area;  // [m²] of each patch
  std::vector<Border> border;
  std::vector<Border> chine;                        // both sides of each edge that is a chine (`Bend::chine`)
  std::vector<Border> knuckle;                      // and of each that is a knuckle
  std::vector<std::uint8_t> curved;                 // of each patch: whether it lies in no plane
  std::vector<std::uint8_t> between_sharp_corners;  // whether it is plane, with sharp edges alone
  int count() const { return static_cast<int>(area.size()); }
};

/// Divides a surface into patches between corners (`Bend`). Throws
/// Error(case_file) when the surface is not closed, or its normals point into the body.
SurfacePatches find_patches(const InterfaceMesh&, const Knuckles& = {});

}  // namespace strake::fluid
