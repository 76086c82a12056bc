#pragma once

#include "coupler/case/case_view.hpp"
#include "proto/interface.hpp"

#include <optional>
#include <string>

namespace strake {

/// The share by which walls and floor of a tank raise the added mass of a wetted plate in the plane. half:
/// half the wetted width a; left, right: from its middle to the walls; depth: of the water [m]; each may be
/// infinite. Infinite where the plate reaches a wall.
///
/// Between two walls W away the mass is −4ρW²/π ln cos(πa/2W), of ½πρa² in water without bounds. (Images of
/// the plate in the walls; the flow of a row of plates, Lamb 1932.) Walls at two distances count with their
/// mean. A floor at the depth H adds π²a²/48H², its images as dipoles; a thin layer has 2ρa³/3H instead,
/// which is the less below H = a/2.
double blockage(double half, double left, double right, double depth);

/// Shares by which walls and floor raise the impulse of the water since contact, and the force at the end.
struct Blockage {
  double impulse = 0, force = 0;
};

/// The same for a wedge that enters at constant speed, whose wetted width grows. The water has less room, so
/// that it rises faster along the faces as well (Wagner's condition of 1932 with the images in the walls;
/// derived here). half: half the wetted width without walls, a₀ = π/2 V t/tan β. Both are infinite where
/// the water reaches a wall, a₀ = π W/4.
///
/// Between two walls W away the water beside the plate of half width a rises with, x = πa/2W and
/// X = πr/2W,   v = V (sin X/√(sin²X − sin²x) − 1).   The water meets the faces at r = a if
///   a₀ = (2W/π) ∫ artanh(u)/u du,   u from 0 to sin x                        (B1)
/// From M = −4ρW²/π ln cos x and F = V dM/dt, over those of water without bounds and x₀ = πa₀/2W,
///   impulse: −2 ln cos x/x₀²                                                 (B2)
///   force:   tan²x/(x₀ artanh(sin x))                                        (B3)
/// A floor at the depth H: the same condition with the images in the floor, solved numerically. With
/// h = a₀/H these shares are within 2 % of what it gives from h = 0.5 to 4:
///   impulse: 5π²/144 h²/√(1 + 0.21 h²)     force: 10π²/144 h²/√(1 + h²/3)
/// What runs gave stands in cases/VALIDATION.md, "Walls and floor near a wedge".
Blockage blockage_of_entry(double half, double left, double right, double depth);

/// Says by how much walls and floor of the case's tank raise impulse and force, where that is a tenth or more
/// of the impulse; bodies in the plane in a tank that is a box. What sound cannot reach and leave again
/// before the end does not count. half: half the wetted width at the end [m]; level: of the water; grows: the
/// width does until then.
std::optional<std::string> blockage_line(const CaseView&, const InterfaceMesh& body, double half,
                                         double level, bool grows);

}  // namespace strake
