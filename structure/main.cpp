#include "coupler/participant/participant_main.hpp"
#include "proto/version.hpp"
#include "structure/case/read_parameters.hpp"
#include "structure/participant.hpp"
#include "structure/solver/program.hpp"
#include "structure/solver/sketch.hpp"

#include <memory>

// strake-structure-<kind>: reads its keys, builds its solver, serves the coupler.
int main(int argc, char** argv) {
  using namespace strake;
  const structure::SolverProgram solver = structure::this_program();
  CommonKeys common;
  structure::Parameters parameters;

  Program program;
  program.program = "strake-structure-" + solver.kind;
  program.solver = solver.kind;
  program.version = strake_version();
  program.built_from = build_text();
  program.prefix = "structure";
  program.declare = [&](CaseFile& file) {
    common = read_common(file);
    parameters = structure::read(file, solver.kind, common);
    parameters.body_name = common.body;
  };
  program.sizes = [&] { return solver.sizes(parameters); };
  program.properties_cost = solver.properties_cost;
  program.check = [&](CaseFile&) {
    return structure::describe(*solver.build(parameters), parameters, common);
  };
  program.properties = [&](CaseFile&) {
    return structure::properties_line(solver.kind, solver.build(parameters)->properties());
  };
  program.picture = [&](CaseFile&) { return structure::picture(*solver.build(parameters), parameters); };
  program.build = [&](CaseFile&, const ParticipantOptions&, const Setup& setup) {
    parameters.run_folder = setup.run_folder;
    return std::make_unique<structure::StructureParticipant>(solver.build(parameters), parameters, common,
                                                             setup);
  };
  if (solver.export_deck)
    program.export_deck = [&](const DeckRequest& wanted) {
      return solver.export_deck(parameters, common, wanted);
    };
  return participant_main(argc, argv, program);
}
