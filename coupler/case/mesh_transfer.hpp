#pragma once

#include "coupler/case/case_view.hpp"
#include "coupler/coupling/exchange.hpp"
#include "proto/participant.hpp"

#include <functional>
#include <string>
#include <vector>

namespace strake {

/// Makes the mapping from one mesh to another: source, target.
using MakeMapping = std::function<Mapping(const InterfaceMesh& from, const InterfaceMesh& to)>;

/// True if a participant has joined several meshes (InterfaceMesh::meshes).
bool has_several_meshes(const Participant&);

/// A mapping for each field, from the mesh on which it is sent to that on which it is taken.
/// What a partner with several meshes does not take is zero there. Throws Error(solver_fault) for a field
/// without a mesh.
FieldTransfer transfer_between_meshes(const Participant& structure, const Participant& fluid,
                                      const MakeMapping&);

/// True if a mapping of that kind would project onto faces, and the mesh has none.
bool takes_nearest(const MappingParameters&, const InterfaceMesh& from);
/// What the qualities of its mappings say to a reader, each pair of meshes with the fields that cross there.
std::vector<std::string> lines_of_crossings(const FieldTransfer&, const MappingParameters&,
                                            const Participant& structure, const Participant& fluid);
/// The quality of the mapping by which the load comes to the structure.
const MappingQuality& quality_of_load(const FieldTransfer&);

/// The structure as the fluid is told of it: its mesh, and its fields at the start. Of several meshes this is
/// the one that moves, or that of its first field, with the fields that live on the same points.
InterfaceMesh mesh_for_fluid(const Participant& structure);
std::vector<Field> initial_for_fluid(const Participant& structure);
/// Tests that a structure in Strake's water sends displacements. Error(case_file) names what it sends
/// instead; `side` calls the structure.
void check_motion(const CaseView&, const std::string& side, const Participant& structure);
/// Tests that a structure starts within the box around the tank of Strake's water, with a spacing to spare.
/// The water tests it in full. But it makes its particles and layers first, which takes a minute for a body
/// in mm. Throws Error(case_file) with the place.
void check_within_tank(const CaseView&, const std::string& side, const Participant& structure);

}  // namespace strake
