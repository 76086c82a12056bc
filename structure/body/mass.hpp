#pragma once

#include "structure/body/parameters.hpp"

#include <Eigen/Core>

namespace strake::structure {

/// Mass, centre of gravity and moments of inertia of a body; in two dimensions per metre of depth, where of
/// the tensor only the zz component has a meaning.
struct MassProperties {
  double mass = 0;                                    // [kg]
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   // [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // [kg m²] about the centre, axes x, y, z
};

/// Of a homogeneous body.
MassProperties mass_of(const Shape&, const Plate&, double density);
/// Of a body of parts, each with the density of its material.
MassProperties mass_of(const Solid&);
/// The tensor about a point that lies `arm` [m] from the centre of gravity (Huygens-Steiner).
Eigen::Matrix3d inertia_about(const MassProperties&, const Eigen::Vector3d& arm);
/// With a point mass [kg] at a place added.
MassProperties with_point_mass(const MassProperties&, double mass, const Eigen::Vector3d& at);

/// What the case asks for: the homogeneous body, then what [structure] puts in its place, then the lumped
/// mass.
MassProperties mass_of(const Parameters&);

}  // namespace strake::structure
