#include "coupler/participant/participant_main.hpp"
#include "fluid/case/read_parameters.hpp"
#include "fluid/participant.hpp"
#include "fluid/size.hpp"
#include "proto/version.hpp"

#include <memory>

// strake-fluid reads its keys, builds the particle method and answers the coupler.
int main(int argc, char** argv) {
  using namespace strake;
  CommonKeys common;
  fluid::Parameters parameters;

  Program program;
  program.program = "strake-fluid";
  program.solver = "mps";
  program.version = strake_version();
  program.built_from = build_text();
  program.prefix = "fluid";
  program.declare = [&](CaseFile& file) {
    common = read_common(file);
    parameters = fluid::read(file, common);
  };
  program.sizes = [&] { return fluid::sizes(parameters); };
  program.check = [&](CaseFile&) { return fluid::describe(parameters, common); };
  program.build = [&](CaseFile&, const ParticipantOptions&,
                      const Setup& setup) -> std::unique_ptr<Participant> {
    if (parameters.dimension == 3)
      return std::make_unique<fluid::FluidParticipant<3>>(parameters, common, setup);
    return std::make_unique<fluid::FluidParticipant<2>>(parameters, common, setup);
  };
  return participant_main(argc, argv, program);
}
