#pragma once

#include "structure/body/parameters.hpp"
#include "structure/material/material.hpp"

#include <Eigen/Core>

namespace strake::structure {

// The softening law of particles and finite elements (structure/THEORY.md (S32)–(S34)). Y is the energy per
// volume of a piece of the body if it were undamaged, y = √Y the largest so far. The piece softens from the
// y_0 at which its stress reached the strength:
//   1 − D = y_0/y · (y_f − y)/(y_f − y_0)    between y_0 and y_f
// Under uniform loading the stress falls linearly. ∫ Y dD = y_0 y_f for every state of stress, so that y_f =
// G_c/(l_c y_0) dissipates G_c per area of a crack in a band of width l_c.

/// 1 − D; y_0 = 0: not yet reached.
double integrity_after(double first /* y_0 */, double largest /* y */, double last /* y_f */);

/// max_principal or von_mises of a Cauchy stress [Pa].
double equivalent_stress(FailureCriterion, const Eigen::Matrix3d& stress);

/// Direction of the largest principal stress.
Eigen::Vector3d principal_direction(const Eigen::Matrix3d& stress);

/// Cauchy stress σ = P Fᵀ/det F [Pa] of an undamaged material, with the σ_zz = ν (σ_xx + σ_yy) of plane
/// strain.
template <int dim>
Eigen::Matrix3d cauchy_stress(const Material&, const Eigen::Matrix<double, dim, dim>& F);

/// E' of uniaxial stress: E/(1 − ν²) in plane strain, otherwise E [Pa].
double uniaxial_modulus(const Material&, int dimension);

/// Widest band [m] that dissipates G_c and no more: y_f > y_0 requires l_c < G_c/y_0², y_0² = ½ f²/E'.
double widest_band(const FailureKeys&, const Material&, int dimension);

}  // namespace strake::structure
