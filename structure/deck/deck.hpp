#pragma once

#include "structure/deck/history.hpp"
#include "structure/deck/model.hpp"

#include <optional>
#include <string>
#include <vector>

namespace strake::structure::deck {

/// Content of a deck besides its model.
struct Story {
  std::string title;   // of the case
  std::string origin;  // the run it comes from
};

/// What CalculiX writes for a program that reads it back.
struct Wanted {
  std::vector<int> node;  // ascending, from 0: displacement and velocity after each window, .dat
  int field_every = 1;    // windows between fields of displacement, velocity and stress, .frd
};

/// An input file of CalculiX (`ccx`). `history` for dynamics; without one the statics or the modes of the
/// model under its own load, of which `wanted` is written, where given, and otherwise the probes' nodes.
/// Motions are relative to the supports, as in fem/solver.hpp: the supports are fixed and nothing moves at
/// the start. Nodes and elements count from 1.
std::string calculix(const Model&, const std::optional<LoadHistory>&, const Story&,
                     const std::optional<Wanted>& wanted = {});

/// One window's load: constant over it.
struct WindowLoad {
  int windows_before = 0;  // steps that a restart file contains; 0: there is none
  double dt = 0;           // [s]
  Eigen::VectorXd force;   // [N] on the unknowns, gravity excepted
  double gravity = 0;      // factor of Model::gravity
};
/// Writes a step of one increment. It continues from the restart file of the step before and writes the next
/// one. CalculiX keeps displacement and velocity in that file. At the start of each step it computes the
/// acceleration anew, from the equation of motion under the new load. With a constant load and Newmark
/// 1/4-1/2 the mean of the accelerations at both ends is then that of the trapezoidal rule under the mean
/// load, as in fem/newmark.hpp.
std::string calculix_window(const Model&, const Wanted&, const WindowLoad&);
/// The same for a whole run whose loads are known, as so many steps in one deck.
std::string calculix_windows(const Model&, const Wanted&, const std::vector<WindowLoad>&);

/// The same for Ansys Mechanical APDL.
std::string ansys(const Model&, const std::optional<LoadHistory>&, const Story&);

/// "probe,node,weight" per line: a probe's value is the weighted sum of its nodes'.
std::string probe_table(const Model&);

/// Lines that explain frame, load and time step to a reader, without comment marks.
std::vector<std::string> explanation(const Model&, const std::optional<LoadHistory>&, const Story&);

/// Thickness [m] that a plane model gets where the program makes solids of plane elements; forces per metre
/// of depth are multiplied by it. 1 in plane strain. With plane stress a hundredth of the shortest edge: the
/// strain across the thickness must be free to differ from place to place.
double plane_thickness(const Model&);

/// A name of letters, digits and underscores that no other part has: "P2_RIB".
std::string part_label(const Model&, std::size_t part);

}  // namespace strake::structure::deck
