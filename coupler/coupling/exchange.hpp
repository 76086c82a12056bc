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

enum class Sender { structure, fluid };

/// One field between a mesh of the structure and one of the fluid, where a participant has several.
struct Crossing {
  std::string quantity;
  Sender sender = Sender::structure;
  std::string of_structure, of_fluid;  // names of the two meshes; both empty: the partner does not take it
  bool back = false;                   // the matrix of the mapping leads to the structure, not to the fluid
  Mapping mapping;
  Eigen::Index structure_points = 0;  // of the mesh of_structure
  bool taken() const { return !of_structure.empty(); }
};

/// How fields cross the interface. What is conservative goes by the transpose of the matrix that takes
/// consistent fields the other way, so that sums are kept and f·u is the same on both sides.
class FieldTransfer {
 public:
  /// The mapping from the fluid's points to the structure's is optional. It is needed if the fluid sends a
  /// consistent field (a pressure), or the structure a conservative one.
  FieldTransfer(Mapping to_fluid, std::optional<Mapping> to_structure = {});
  /// Of participants with several meshes: a mapping for each field, on all points of both. to_loaded: from
  /// the structure's mesh that moves to the one that takes the force; none: they are one mesh.
  FieldTransfer(Mapping to_fluid, std::optional<Mapping> to_structure, std::vector<Crossing>,
                std::optional<Mapping> to_loaded);
  static bool needs_way_back(const StructureSample& of_structure, const std::vector<Field>& of_fluid);
  static bool needs_way_back(Sender, const Field&);

  Field onto_fluid(const Field& on_structure) const;
  Field onto_structure(const Field& on_fluid) const;
  /// The structure's force on the points that move, and its displacement on the points of the fluid's force:
  /// what the works of both sides need.
  Field onto_moving(const Field& force) const;
  Field where_fluid_loads(const Field& displacement) const;
  /// By this the rms over all of the structure's points becomes that over the field's own mesh: √(n/n_m), n
  /// and n_m the numbers of points. 1 where there is one mesh.
  double rms_factor(Sender, const std::string& quantity) const;
  const Mapping& to_fluid() const { return to_fluid_; }
  const std::optional<Mapping>& to_structure() const { return to_structure_; }
  const std::vector<Crossing>& crossings() const { return crossings_; }  // none: one mesh on each side

 private:
  const Mapping& way_of(Sender, const Field&) const;
  const Crossing* find(Sender, const std::string& quantity) const;

  Mapping to_fluid_;
  std::optional<Mapping> to_structure_;
  std::vector<Crossing> crossings_;
  std::optional<Mapping> to_loaded_;
};

/// Corrects the velocity [m/s] at the end of the second window of points that moved before the run and did
/// not say so. Taken for points at rest, they have twice their velocity after the first window and none after
/// the second, and (C1) of coupler/THEORY.md would go on so. With d₁ and d₂, the mean velocities of the two
/// windows, the parabola through the three places ends with
///   v₂ = d₂ + (d₂ − d₁) dt₂/(dt₁ + dt₂).
/// A point moved before where its speed changes little, |d₁| > 2|d₂ − d₁|; from rest it trebles, d₂ = 3 d₁.
/// Velocities within |d₁|/2 of the parabola's are kept.
void correct_start(const StructureSample& start, const StructureSample& first, StructureSample& second);

}  // namespace strake
