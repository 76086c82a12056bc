#include "structure/program.hpp"

#include "proto/case/case_keys.hpp"
#include "proto/error.hpp"
#include "proto/version.hpp"
#include "structure/case/read_parameters.hpp"
#include "structure/participant.hpp"
#include "structure/solver/sketch.hpp"

#include <utility>

namespace strake::structure {

StructureProgram::StructureProgram(SolverProgram solver) : solver_(std::move(solver)) {}

RankedProgram StructureProgram::program() {
  RankedProgram ranked;
  if (solver_.build_on_ranks) ranked.on_ranks = "strake-structure-" + solver_.kind + "-ranks";
  ranked.ranks = [this] { return parameters_.ranks; };
  ranked.launcher = [this] { return parameters_.launcher; };
  ranked.share_processors = [this](int ranks, int processors) {
    return parameters_.threads = threads_of_rank(common_, ranks, processors);
  };
  Program& program = ranked.program;
  program.program = "strake-structure-" + solver_.kind;
  program.solver = solver_.kind;
  program.version = strake_version();
  program.built_from = build_text();
  program.prefix = "structure";
  program.declare = [this](CaseFile& file) {
    common_ = read_common(file);
    parameters_ = read(file, solver_.kind, common_);
    parameters_.body_name = common_.body;
  };
  program.sizes = [this] { return solver_.sizes(parameters_); };
  program.properties_cost = solver_.properties_cost;
  program.check = [this](CaseFile&) { return describe(*solver_.build(parameters_), parameters_, common_); };
  program.properties = [this](CaseFile&) {
    return properties_line(solver_.kind, solver_.build(parameters_)->properties());
  };
  program.picture = [this](CaseFile&) { return picture(*solver_.build(parameters_), parameters_); };
  program.build = [this](CaseFile&, const ParticipantOptions& options, const Setup& setup) {
    if (parameters_.ranks > 1 && options.mode == ParticipantOptions::Mode::precice)
      throw Error(ExitCode::case_file, "structure.ranks", "a preCICE run has one rank of this program",
                  "set structure.ranks = 1");
    return build(setup);
  };
  if (solver_.export_deck)
    program.export_deck = [this](const DeckRequest& wanted) {
      return solver_.export_deck(parameters_, common_, wanted);
    };
  return ranked;
}

std::unique_ptr<Participant> StructureProgram::build(const Setup& setup, Communicator* ranks) {
  parameters_.run_folder = setup.run_folder;
  return std::make_unique<StructureParticipant>(
      ranks == nullptr ? solver_.build(parameters_) : solver_.build_on_ranks(parameters_, *ranks),
      parameters_, common_, setup, ranks);
}

}  // namespace strake::structure
