#include "coupler/participant/participant_main.hpp"
#include "fluid/case/load_case.hpp"
#include "fluid/program.hpp"
#include "fluid/ranked_participant.hpp"
#include "fluid/ranks/boomer_amg.hpp"
#include "fluid/ranks/rank_watch.hpp"
#include "fluid/ranks/zoltan_partition.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <optional>

namespace strake::fluid {
namespace {

/// Whether the command line is that of a participant of a run. The other modes need one rank.
bool serves(int argc, char** argv) {
  try {
    return parse_participant_options(argc, argv).mode == ParticipantOptions::Mode::serve;
  } catch (const Error&) {
    return false;  // participant_main says what is wrong
  }
}

/// Reads the case. Refuses a launcher that starts another number of ranks than the case asks for.
void take_case(const MpiCommunicator& ranks, int argc, char** argv, FluidProgram& fluid) {
  const ParticipantOptions options = parse_participant_options(argc, argv);
  load_case(options.case_file, options.sets, [&](CaseFile& file) { fluid.declare(file); });
  if (ranks.size() == fluid.ranks()) return;
  throw Error(ExitCode::participant_lost, "fluid.launcher",
              fmt::format("has started {} ranks, fluid.ranks is {}", ranks.size(), fluid.ranks()),
              "give the launcher {ranks}, as in mpirun -n {ranks}");
}

int run(MpiCommunicator& ranks, int argc, char** argv) {
  FluidProgram fluid;
  Program program = fluid.program();
  program.program = "strake-fluid-ranks";
  if (!serves(argc, argv)) return ranks.rank() == 0 ? participant_main(argc, argv, program) : 0;
  std::optional<Error> refused;
  try {
    take_case(ranks, argc, argv, fluid);
  } catch (const Error& error) {
    refused = error;
  }
  // One rank may see another file than the others. All end together, and the first of them says why.
  const std::vector<int> codes = ranks.all(refused ? static_cast<int>(refused->code()) : 0);
  const auto first = std::ranges::find_if(codes, [](int code) { return code != 0; });
  if (first != codes.end()) {
    if (first - codes.begin() == ranks.rank()) std::fputs(to_text(*refused).c_str(), stderr);
    return *first;
  }
  const auto build = [&](const Setup& setup) {
    return fluid.build(setup, {&ranks, zoltan_partition, [&] { return boomer_amg(ranks); }});
  };
  if (ranks.rank() > 0) {
    work_for_first_rank(ranks, build);
    return 0;
  }
  program.build = [&](CaseFile&, const ParticipantOptions&,
                      const Setup& setup) -> std::unique_ptr<Participant> {
    return std::make_unique<RankedParticipant>(ranks, setup, build);
  };
  const int code = participant_main(argc, argv, program);
  announce_end(ranks);
  return code;
}

}  // namespace
}  // namespace strake::fluid

// strake-fluid-ranks is one rank of a fluid on several. strake-fluid starts it by mpirun.
int main(int argc, char** argv) {
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  strake::fluid::MpiCommunicator ranks(MPI_COMM_WORLD);
  int code = 0;
  try {
    const strake::fluid::RankWatch watch(ranks);
    code = strake::fluid::run(ranks, argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rank %d of the fluid: %s\n", ranks.rank(), error.what());
    MPI_Abort(MPI_COMM_WORLD, static_cast<int>(strake::ExitCode::our_bug));
  }
  MPI_Finalize();
  return code;
}
