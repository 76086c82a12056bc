#pragma once

#include <Eigen/Core>

namespace strake {

/// The same direction for all faces of a connected piece, in place. faces: dimension×m (2: segments, 3:
/// triangles). A closed piece gets normals that point out of it. Returns false, and leaves `faces` in part
/// turned, if more than two faces meet at an edge (in two dimensions at a point), or a piece has one side
/// only.
bool orient(Eigen::MatrixXi& faces, const Eigen::Matrix3Xd& position);

/// Area [m²] per metre of depth, or volume [m³], inside a closed surface, by Green's theorem. Positive if its
/// normals point into the fluid; 0 without faces.
double enclosed_volume(const Eigen::MatrixXi& faces, const Eigen::Matrix3Xd& position);

}  // namespace strake
