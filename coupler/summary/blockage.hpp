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

/// Says by how much walls and floor of the case's tank raise the force, where that is a tenth or more; bodies
/// in the plane in a tank that is a box. What sound cannot reach and leave again before the end does not
/// count. half: half the wetted width at the end [m]; level: of the water.
std::optional<std::string> blockage_line(const CaseView&, const InterfaceMesh& body, double half,
                                         double level);

}  // namespace strake
