#pragma once

#include "proto/interface.hpp"

#include <array>
#include <vector>

namespace strake::structure {

/// The interface of a closed surface of triangles.
InterfaceMesh closed_surface(const std::vector<Eigen::Vector3d>& point,
                             const std::vector<std::array<int, 3>>& face);

/// The closed surface of a prism over a plane outline, from middle − depth/2 to middle + depth/2 along z. The
/// normals of its triangles (right-hand rule) point out. The outline's segments make strips, each about
/// `spacing` [m] long along z; the end faces are triangulated to about the same size.
InterfaceMesh prism_surface(const InterfaceMesh& outline, double depth, double middle, double spacing);

/// A sphere as the subdivided faces of an icosahedron with edges of about `spacing` [m], and the sphere's own
/// volume.
InterfaceMesh sphere_surface(const Eigen::Vector3d& centre, double radius, double spacing);

}  // namespace strake::structure
