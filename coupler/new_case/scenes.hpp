#pragma once

#include "coupler/new_case/case_lines.hpp"
#include "coupler/new_case/kinds.hpp"

#include <string>

namespace strake {

/// The scene of each kind. The answers are complete and each within its bounds; what does not fit together (a
/// spacing larger than the body) throws Error(command_line) with the option to change.
NewScene plate_scene(const NewAnswers&);
NewScene bodies_scene(const NewAnswers&);
NewScene box_scene(const NewAnswers&);
NewScene wedge_scene(const NewAnswers&);
NewScene cylinder_scene(const NewAnswers&);
NewScene sphere_scene(const NewAnswers&);
NewScene mesh_scene(const NewAnswers&);
NewScene moored_scene(const NewAnswers&);
NewScene dam_scene(const NewAnswers&);

/// Refuses a height [m] of more than ten widths, or less than a tenth. Its tank would be all but empty.
void check_height(double width, double height);
/// The next smaller one of 1, 2, 2.5, 4 or 5 times a power of ten.
double round_number(double);
/// The next larger number of two digits.
double two_digits(double);
/// The given spacing, else length/parts rounded. Refuses one of more than a tenth or less than a thousandth
/// of `length`, which `name` calls.
double chosen_spacing(const NewAnswers&, const std::string& name, double length, double parts);
/// The same with a default that is known already [m].
double chosen_spacing_or(double otherwise, const NewAnswers&, const std::string& name, double length);

// Air between body and water at the start [spacing]: no time is lost in free fall.
constexpr double rigid_gap = 0.6;

/// A tank around a body `width` wide: wide enough that its walls add some per cent to the force.
void put_wide_tank(NewScene&, double width, double depth, double above);
/// [structure] of a rigid body that moves down: driven, or free to heave with a mass.
CaseLines rigid_body(const NewAnswers&, int dimension);
/// Says how the body moves: "driven into still water at 5 m/s".
std::string motion_words(const NewAnswers&);

/// Particles of water and walls that a scene has, about.
double particles_of(const NewScene&);
/// Spacing [m] of two digits with which a scene in space has about 100 000 particles. Reads the lengths of
/// tank and water alone.
double spacing_in_space(const NewScene&);
/// Says what half the spacing costs: "7.2 times the particles, 14 times the time".
std::string cost_of_half(const NewScene&);

}  // namespace strake
