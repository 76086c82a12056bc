#pragma once

#include <optional>
#include <string>

#include "structure/deck/history.hpp"
#include "structure/deck/model.hpp"

namespace strake::structure::deck {

/// What a deck says besides its model.
struct Story {
  std::string title;   // of the case
  std::string origin;  // the run it comes from
};

/// An input file of CalculiX (`ccx`). `history` for dynamics; without one the statics or the modes of the
/// model under its own load. In the frame of the supports: they are held and nothing moves at the start, as
/// fem/solver.hpp has it. Nodes and elements count from 1.
std::string calculix(const Model&, const std::optional<LoadHistory>&, const Story&);

/// The same for Ansys Mechanical APDL.
std::string ansys(const Model&, const std::optional<LoadHistory>&, const Story&);

/// "probe,node,weight" per line: a probe's value is the weighted sum of its nodes'.
std::string probe_table(const Model&);

/// Lines that tell a reader what frame, load and time step mean, without comment marks.
std::vector<std::string> explanation(const Model&, const std::optional<LoadHistory>&, const Story&);

/// Thickness [m] that a plane model gets; forces per metre of depth are multiplied by it. 1 in plane strain.
/// With plane stress a hundredth of the shortest edge where `solid_elements`: there the program makes solids
/// of plane elements, and the strain across the thickness must be free to differ from place to place.
double plane_thickness(const Model&, bool solid_elements);

/// A name of letters, digits and underscores that no other part has: "P2_RIB".
std::string part_label(const Model&, std::size_t part);

}  // namespace strake::structure::deck
