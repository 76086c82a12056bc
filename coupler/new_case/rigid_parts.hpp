#pragma once

#include "coupler/new_case/case_lines.hpp"

namespace strake {

// Air between body and water at the start [spacing]: no time is lost in free fall.
constexpr double rigid_gap = 0.6;

/// A tank around a body `width` wide: wide enough that its walls add some per cent to the force.
void put_wide_tank(NewScene&, double width, double depth, double above);
/// [structure] of a rigid body that moves down: driven, or free to heave with a mass.
CaseLines rigid_body(const NewAnswers&, int dimension);
/// Says how the body moves: "driven into still water at 5 m/s".
std::string motion_words(const NewAnswers&);

}  // namespace strake
