#include "fluid/program.hpp"

#include "fluid/case/read_parameters.hpp"
#include "fluid/participant.hpp"
#include "fluid/size.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/error.hpp"
#include "proto/version.hpp"

namespace strake::fluid {

void FluidProgram::declare(CaseFile& file) {
  common_ = read_common(file);
  parameters_ = read(file, common_);
}

std::unique_ptr<Participant> FluidProgram::build(const Setup& setup, const Ranks& ranks) const {
  if (parameters_.ranks > 1 && ranks.communicator == nullptr)  // --precice
    throw Error(ExitCode::case_file, "fluid.ranks", "a preCICE run has one rank of this program",
                "set fluid.ranks = 1, and run.threads");
  if (parameters_.dimension == 3)
    return std::make_unique<FluidParticipant<3>>(parameters_, common_, setup, ranks);
  return std::make_unique<FluidParticipant<2>>(parameters_, common_, setup, ranks);
}

RankedProgram FluidProgram::program() {
  RankedProgram ranked;
  ranked.on_ranks = "strake-fluid-ranks";
  ranked.ranks = [this] { return parameters_.ranks; };
  ranked.launcher = [this] { return parameters_.launcher; };
  ranked.share_processors = [this](int ranks, int processors) {
    return parameters_.threads = threads_of_rank(common_, ranks, processors);
  };
  Program& program = ranked.program;
  program.program = "strake-fluid";
  program.solver = "mps";
  program.version = strake_version();
  program.built_from = build_text();
  program.prefix = "fluid";
  program.declare = [this](CaseFile& file) { declare(file); };
  program.sizes = [this] { return sizes(parameters_); };
  program.check = [this](CaseFile&) { return describe(parameters_, common_); };
  program.build = [this](CaseFile&, const ParticipantOptions&, const Setup& setup) { return build(setup); };
  return ranked;
}

}  // namespace strake::fluid
