#include "coupler/attachments/fmu/case/fmu_case.hpp"
#include "coupler/participant/participant_main.hpp"
#include "proto/version.hpp"

// strake-attachment-fmu: reads [[attachments]], loads the FMU of the one that it is named as, serves the
// coupler.
int main(int argc, char** argv) {
  using namespace strake;
  FmuCase fmus;
  Program program;
  program.program = "strake-attachment-fmu";
  program.solver = "fmu";
  program.version = strake_version();
  program.built_from = build_text();
  program.prefix = "attachments";
  program.declare = [&](CaseFile& file) { fmus = FmuCase(file); };
  program.check = [&](CaseFile&) { return fmus.check(); };
  program.build = [&](CaseFile&, const ParticipantOptions& options, const Setup& setup) {
    return fmus.build(options.name, setup);
  };
  return participant_main(argc, argv, program);
}
