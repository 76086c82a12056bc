#pragma once

#include "structure/body/parameters.hpp"

#include <Eigen/Core>

namespace strake::structure {

/// Mass, centre of gravity and moments of inertia of a body. In two dimensions they are per metre of depth,
/// and only the zz component of the tensor has a meaning.
struct MassProperties {
  double mass = 0;                                    // [kg]
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   // [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // [kg m²] about the centre, axes x, y, z
};

/// Of a homogeneous body.
MassProperties mass_of(const Shape&, const Plate&, double density);
/// Of a body of parts, each with the density of its material.
MassProperties mass_of(const Solid&);
/// Of the homogeneous body inside a closed surface, density in [kg/m³], by the divergence theorem.
MassProperties mass_of(const ClosedSurface&, double density);
/// The tensor about a point that lies `arm` [m] from the centre of gravity (Huygens-Steiner).
Eigen::Matrix3d inertia_about(const MassProperties&, const Eigen::Vector3d& arm);
/// With a point mass [kg] at a place added.
MassProperties with_point_mass(const MassProperties&, double mass, const Eigen::Vector3d& at);

/// Mass properties of the case: the homogeneous body, then the values that [structure] replaces, then the
/// lumped mass.
MassProperties mass_of(const Parameters&);

}  // namespace strake::structure
