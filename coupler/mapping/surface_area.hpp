#pragma once

#include "proto/interface.hpp"

#include <Eigen/Core>

namespace strake {

/// The area that each point of a mesh stands for: a face's length (2-D, per metre of depth) or area, divided
/// evenly among its corners [m, m²]. Zero where no face names the point.
Eigen::VectorXd point_areas(const InterfaceMesh&);

/// The same for points without faces of their own that lie on a surface: the part of it that is nearer to the
/// point than to any other, to within a `fineness`-th of its faces.
Eigen::VectorXd nearest_areas(const Points&, const InterfaceMesh& surface, int fineness = 8);

/// Changes each component (row) of `value` until its sum is the wanted one.
void match_sums(Eigen::Ref<Eigen::MatrixXd> value, const Eigen::VectorXd& wanted);

/// A field per area (pressure, traction) that was mapped from one mesh to another: changed until
/// Σ_i A_i v_i = wanted, the integral over the mesh it came from.
void match_integral(Eigen::Ref<Eigen::MatrixXd> value, const Eigen::VectorXd& area,
                    const Eigen::VectorXd& wanted);

}  // namespace strake
