#pragma once

#include "coupler/mapping/mapping.hpp"
#include "proto/participant.hpp"

#include <optional>
#include <string>
#include <vector>

namespace strake {

/// What a structure sends: its motion, unless it sends none, and fields of other quantities.
struct StructureSample {
  double time = 0;  // [s] absolute
  std::optional<Motion> motion;
  std::vector<Field> others;
  /// Displacement, velocity where it is given, then the others: as messages and checkpoints hold them.
  std::vector<Field> fields() const;
  /// From fields in that order.
  static StructureSample of(Sample);
};
using StructureSamples = std::vector<StructureSample>;

/// The fields that a participant sends with each window, as Description::initial announces them: quantity,
/// unit, components, conservative or not, and the values at the start. A structure that announces none, or a
/// motion, sends displacement [m]; its velocity [m/s] then stands beside it, zero where it gives none, and
/// may be left out of the windows. A fluid that announces none sends force [N]. Throws Error(solver_fault)
/// for what does not fit the mesh.
StructureSample fields_of_structure(const Participant&);
std::vector<Field> fields_of_fluid(const Participant&);

/// The place of a fault: which participant, window and iteration.
struct Place {
  const char* name;
  Window window;
  int number, iteration;
  std::string text() const;
};

/// The announced fields out of an answer, checked, in the announced order. Throws Error(solver_fault) for one
/// that is missing, of another size or unit, or not finite.
std::vector<Field> received_fields(std::vector<Field>&& answer, const std::vector<Field>& announced,
                                   const InterfaceMesh&, const Place&);
/// The same of a structure, at the end of the window; a velocity that was left out is 0×0.
StructureSample received_fields(std::vector<Field>&& answer, const StructureSample& announced,
                                const InterfaceMesh&, const Place&);

/// How fields cross the interface. What is conservative goes by the transpose of the matrix that takes
/// consistent fields the other way, so that sums are kept and f·u is the same on both sides.
class FieldTransfer {
 public:
  /// The mapping from the fluid's points to the structure's is optional. It is needed if the fluid sends a
  /// consistent field (a pressure), or the structure a conservative one.
  FieldTransfer(Mapping to_fluid, std::optional<Mapping> to_structure = {});
  static bool needs_way_back(const StructureSample& of_structure, const std::vector<Field>& of_fluid);

  Field onto_fluid(const Field& on_structure) const;
  Field onto_structure(const Field& on_fluid) const;
  const Mapping& to_fluid() const { return to_fluid_; }
  const std::optional<Mapping>& to_structure() const { return to_structure_; }

 private:
  Mapping to_fluid_;
  std::optional<Mapping> to_structure_;
};

}  // namespace strake
