#include "coupler/participant/case/declared_case.hpp"
#include "coupler/participant/start_ranks.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/error.hpp"
#include "proto/ranks/rank_watch.hpp"
#include "proto/ranks/ranked_participant.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <sched.h>
#include <string>
#include <string_view>
#include <unistd.h>

namespace strake {
namespace {

/// This rank, for its last line: "rank 1 of the fluid".
std::array<char, 64> last_name{};  // NOLINT: set once

/// Prints one line on why this rank ends. The coupler shows it. It takes no memory, which may be what lacks.
void say_why(const char* text) {
  std::array<char, 1024> line{};
  auto end = std::ranges::copy(std::string_view(last_name.data()), line.begin()).out;
  *end++ = ':';
  for (bool gap = true; *text != '\0' && end < line.end() - 2; ++text) {
    const bool space = *text == ' ' || *text == '\n';
    if (!space) {
      if (gap) *end++ = ' ';
      *end++ = *text;
    }
    gap = space;
  }
  *end++ = '\n';
  [[maybe_unused]] const ssize_t ignored =
      write(STDERR_FILENO, line.data(), static_cast<std::size_t>(end - line.begin()));
}

/// Ends all ranks after an error of MPI, as MPI does by itself. MPI's own words take ten lines, of which the
/// last ones do not name the error.
void end_by_mpi(MPI_Comm* all, int* error, ...) {  // NOLINT: the signature that MPI asks for
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(*error, text.data(), &length);
  say_why(text.data());
  MPI_Abort(*all, static_cast<int>(ExitCode::our_bug));
}

/// Makes end_by_mpi the answer to an error in messages of all ranks. Communicators that are copied later have
/// it too.
void say_errors_of_mpi() {
  MPI_Errhandler handler{};
  MPI_Comm_create_errhandler(end_by_mpi, &handler);
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, handler);
  MPI_Errhandler_free(&handler);  // once no communicator has it
}

/// Whether the command line is that of a participant of a run. The other modes need one rank.
bool serves(int argc, char** argv) {
  try {
    return parse_participant_options(argc, argv).mode == ParticipantOptions::Mode::serve;
  } catch (const Error&) {
    return false;  // participant_main says what is wrong
  }
}

/// Reads the case. Refuses a launcher that starts another number of ranks than the case asks for.
void take_case(const MpiCommunicator& ranks, int argc, char** argv, const RankedProgram& ranked) {
  CaseFile file = load_case(parse_participant_options(argc, argv), ranked.program);
  file.read_all([&] { ranked.program.declare(file); });
  if (ranks.size() == ranked.ranks()) return;
  const std::string& part = ranked.program.prefix;
  throw Error(ExitCode::participant_lost, part + ".launcher",
              fmt::format("has started {} ranks, {}.ranks is {}", ranks.size(), part, ranked.ranks()),
              "give the launcher {ranks}, as in mpirun -n {ranks}");
}

/// What the ranks of one machine share.
struct SharedMachine {
  int ranks = 1, processors = 1;
};

/// Counts the ranks on the machine of this one, and the processors that any of them may use. A launcher may
/// give each rank processors of its own.
SharedMachine shared_machine(MPI_Comm all) {
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(all, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  SharedMachine machine;
  MPI_Comm_size(here, &machine.ranks);
  cpu_set_t own{}, any{};
  const bool known = sched_getaffinity(0, sizeof own, &own) == 0;
  MPI_Allreduce(&own, &any, sizeof own, MPI_BYTE, MPI_BOR, here);
  MPI_Comm_free(&here);
  machine.processors = known ? std::max(1, CPU_COUNT(&any)) : processors_here();
  return machine;
}

/// Lets each rank take its share of the processors.
void share_processors(const MpiCommunicator& ranks, const RankedProgram& ranked) {
  const auto [here, processors] = shared_machine(ranks.all_ranks());
  const int threads = ranked.share_processors(here, processors);
  if (ranks.rank() == 0)
    spdlog::info(fmt::format("{} of {} ranks on this machine, {} thread{} each, {} processor{}", here,
                             ranks.size(), threads, threads == 1 ? "" : "s", processors,
                             processors == 1 ? "" : "s"));
}

int run(MpiCommunicator& ranks, int argc, char** argv, const RankedProgram& ranked,
        const RankFactory& build) {
  Program program = ranked.program;
  program.program = ranked.on_ranks;
  if (!serves(argc, argv)) return ranks.rank() == 0 ? participant_main(argc, argv, program) : 0;
  std::optional<Error> refused;
  try {
    take_case(ranks, argc, argv, ranked);
  } catch (const Error& error) {
    refused = error;
  }
  // One rank may see another file than the others. All end together, and the first of them says why.
  const std::vector<int> codes = ranks.all(refused ? static_cast<int>(refused->code()) : 0);
  const auto first = std::ranges::find_if(codes, [](int code) { return code != 0; });
  if (first != codes.end()) {
    if (first - codes.begin() == ranks.rank()) say_why(refused->what());
    return *first;
  }
  if (ranks.rank() > 0) {
    work_for_first_rank(ranks, build);
    return 0;
  }
  program.build = [&](CaseFile&, const ParticipantOptions&,
                      const Setup& setup) -> std::unique_ptr<Participant> {
    return std::make_unique<RankedParticipant>(ranks, setup, build);
  };
  const int code = participant_main(argc, argv, program);
  if (ranks.is_broken()) MPI_Abort(MPI_COMM_WORLD, code);  // the coupler knows why
  announce_end(ranks);
  return code;
}

/// An exception that nobody catches, as in a loop of threads.
[[noreturn]] void end_at_once() {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
    say_why("has ended itself");
  } catch (const std::bad_alloc&) {
    say_why("is out of memory");
  } catch (const std::exception& error) {
    say_why(error.what());
  } catch (...) {
    say_why("unexpected");
  }
  std::abort();
}

}  // namespace

int ranks_main(int argc, char** argv, const RankedProgram& ranked,
               const std::function<std::unique_ptr<Participant>(const Setup&, Communicator&)>& build) {
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  say_errors_of_mpi();
  MpiCommunicator ranks(MPI_COMM_WORLD);
  std::snprintf(last_name.data(), last_name.size(), "rank %d of the %s", ranks.rank(),
                ranked.program.prefix.c_str());
  std::set_terminate(end_at_once);
  spdlog::set_pattern("[%Y-%m-%d %H:%M:%S.%e] [%l] %v");  // no colours: a launcher's terminal ends in a log
  int code = 0;
  try {
    const RankWatch watch(ranks, ranked.program.prefix);
    code = run(ranks, argc, argv, ranked, [&](const Setup& setup) {
      share_processors(ranks, ranked);
      return build(setup, ranks);
    });
  } catch (const Error& error) {
    say_why(error.what());
    MPI_Abort(MPI_COMM_WORLD, static_cast<int>(error.code()));
  } catch (const std::exception& error) {
    say_why(error.what());
    MPI_Abort(MPI_COMM_WORLD, static_cast<int>(ExitCode::our_bug));
  }
  MPI_Finalize();
  return code;
}

}  // namespace strake
