#pragma once

namespace strake::fluid {

/// Friction on a smooth face whose boundary layer is thinner than the spacing: the law of the wall of
/// Spalding 1961 (fluid/THEORY.md (F75)),
///   y⁺ = u⁺ + e^(−κB) [e^(κu⁺) − 1 − κu⁺ − (κu⁺)²/2 − (κu⁺)³/6], y⁺ = y u_τ/ν, u⁺ = u/u_τ.
struct WallLaw {
  double kinematic_viscosity = 0;  // ν [m²/s]; 0: no friction
  double spacing = 0;              // l0 [m]

  /// Returns u_τ [m/s], the root of the wall's stress over density. speed: of the water along the face [m/s];
  /// distance: from the face [m]. Relative error below 1e-9.
  double friction_velocity(double speed, double distance) const;
};

/// Largest y⁺ at which the water nearest to a face is in the viscous sublayer. There u⁺ = y⁺, and a straight
/// line through the face's velocity is right.
inline constexpr double viscous_sublayer = 5;

}  // namespace strake::fluid
