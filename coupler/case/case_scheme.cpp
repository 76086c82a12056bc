#include "coupler/case/case_scheme.hpp"

#include "coupler/case/mesh_transfer.hpp"
#include "proto/error.hpp"

namespace strake {

namespace {

// A point of the fluid's wetted surface farther than this from the structure's surface [fluid.spacing]
// belongs to another shape.
constexpr double farthest_wet_point = 2.0;

Mapping mapping_of(const CouplingCase& view, const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  if (view.common.interface == "volume") return identity(structure, fluid);
  MappingParameters mapping = view.coupling.mapping;
  if (view.spacing) mapping.limit = farthest_wet_point * *view.spacing;
  return make_mapping(mapping, structure, fluid);
}

/// The limit on distances holds for what is mapped from the surface that the fluid wets. Other meshes may be
/// coarse, and without faces, as centres of faces are: then the nearest of their points is taken.
FieldTransfer transfer_of_several(const CouplingCase& view, const Participant& structure,
                                  const Participant& fluid) {
  if (view.common.interface == "volume")
    throw Error(ExitCode::case_file, "coupling.interface = \"volume\"",
                "both solvers have the same points, and one of them joins several meshes",
                "coupling.interface = \"surface\"");
  const std::string wetted = mesh_for_fluid(structure).name;
  return transfer_between_meshes(structure, fluid, [&](const InterfaceMesh& from, const InterfaceMesh& to) {
    MappingParameters mapping = view.coupling.mapping;
    if (view.spacing && from.name == wetted) mapping.limit = farthest_wet_point * *view.spacing;
    if (from.name != wetted && takes_nearest(mapping, from)) mapping.kind = "nearest-neighbour";
    return make_mapping(mapping, from, to);
  });
}

}  // namespace

std::string remedy_of(const CouplingCase& view) {
  if (view.common.fluid_solver == "replay")
    return "the load is recorded and stays as it is however short the window: record it anew with a shorter "
           "coupling.surface.window, or compute the fluid";
  if (view.common.interface == "surface" && !view.coupling.iterates())
    return "raise coupling.surface.converged.max_iterations: one iteration per window is unstable where the "
           "added mass is not small";
  return {};
}

Deadlines deadlines_of(const WaitingKeys& keys, bool patient) {
  Deadlines deadlines;
  deadlines.hello = std::chrono::duration<double>(keys.start_within);
  deadlines.by_hand = std::chrono::duration<double>(keys.attach_within);
  deadlines.frozen_after = std::chrono::duration<double>(keys.frozen_after);
  deadlines.answer_within = std::chrono::duration<double>(keys.answer_within);
  deadlines.patient = patient;
  return deadlines;
}

SchemeParameters scheme_of(const CouplingCase& view, const Participant& structure) {
  const CouplingKeys& keys = view.coupling;
  SchemeParameters scheme;
  scheme.volume = view.common.interface == "volume";
  scheme.parallel = keys.parallel;
  scheme.predictor = predictor_kind(keys.predictor);
  scheme.accelerator = keys.accelerator;
  scheme.convergence = keys.convergence;
  // A length is no measure of a field that is none.
  if (keys.convergence.absolute == 0 && fields_of_structure(structure).motion)
    scheme.convergence.spacing = view.spacing.value_or(0.01);
  return scheme;
}

FieldTransfer transfer_of(const CouplingCase& view, const Participant& structure, const Participant& fluid) {
  if (has_several_meshes(structure) || has_several_meshes(fluid))
    return transfer_of_several(view, structure, fluid);
  std::optional<Mapping> back;
  if (FieldTransfer::needs_way_back(fields_of_structure(structure), fields_of_fluid(fluid)))
    back = mapping_of(view, fluid.mesh(), structure.mesh());
  return {mapping_of(view, structure.mesh(), fluid.mesh()), std::move(back)};
}

}  // namespace strake
