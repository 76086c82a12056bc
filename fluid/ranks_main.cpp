#include "coupler/participant/participant_main.hpp"
#include "fluid/case/read_parameters.hpp"
#include "fluid/participant.hpp"
#include "fluid/program.hpp"
#include "fluid/ranked_participant.hpp"
#include "fluid/ranks/rank_watch.hpp"
#include "fluid/ranks/zoltan_partition.hpp"
#include "proto/case/case_file.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace strake::fluid {
namespace {

/// A rank other than the first: it reads the same case, then does what is announced.
void work(MpiCommunicator& ranks, int argc, char** argv, FluidProgram& fluid) {
  const ParticipantOptions options = parse_participant_options(argc, argv);
  CaseFile file = CaseFile::load(options.case_file, options.sets);
  file.read_all([&] { fluid.declare(file); });
  work_for_first_rank(ranks, [&](const Setup& setup) {
    return fluid.build(setup, {&ranks, zoltan_partition});
  });
}

/// Refuses a launcher that starts another number of ranks than the case asks for.
void check_number(const MpiCommunicator& ranks, int argc, char** argv, FluidProgram& fluid) {
  const ParticipantOptions options = parse_participant_options(argc, argv);
  if (options.mode != ParticipantOptions::Mode::serve) return;
  CaseFile file = CaseFile::load(options.case_file, options.sets);
  file.read_all([&] { fluid.declare(file); });
  if (ranks.size() == fluid.ranks()) return;
  throw Error(ExitCode::case_file, "fluid.launcher",
              fmt::format("has started {} ranks, fluid.ranks is {}", ranks.size(), fluid.ranks()),
              "give the launcher {ranks}, as in mpirun -n {ranks}");
}

int run(MpiCommunicator& ranks, int argc, char** argv) {
  FluidProgram fluid;
  check_number(ranks, argc, argv, fluid);
  if (ranks.rank() > 0) {
    work(ranks, argc, argv, fluid);
    return 0;
  }
  Program program = fluid.program();
  program.build = [&](CaseFile&, const ParticipantOptions&,
                      const Setup& setup) -> std::unique_ptr<Participant> {
    return std::make_unique<RankedParticipant>(ranks, setup, [&](const Setup& own) {
      return fluid.build(own, {&ranks, zoltan_partition});
    });
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
  } catch (const strake::Error& error) {
    if (ranks.rank() == 0) std::fputs(strake::to_text(error).c_str(), stderr);  // all ranks read the same
    code = static_cast<int>(error.code());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rank %d of the fluid: %s\n", ranks.rank(), error.what());
    MPI_Abort(MPI_COMM_WORLD, static_cast<int>(strake::ExitCode::our_bug));
  }
  MPI_Finalize();
  return code;
}
