#include "coupler/participant/start_ranks.hpp"

#include "coupler/participant/case/declared_case.hpp"
#include "coupler/participant/launch.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace strake {

namespace {

/// "mpirun -n {ranks}" as words.
std::vector<std::string> words_of(const std::string& launcher, int ranks) {
  std::istringstream text(launcher);
  std::vector<std::string> words;
  for (std::string word; text >> word;) {
    if (const auto at = word.find("{ranks}"); at != std::string::npos)
      word.replace(at, std::string("{ranks}").size(), std::to_string(ranks));
    words.push_back(word);
  }
  return words;
}

/// What Open MPI needs to start more ranks than there are processors, on one machine, in a container too.
void set_environment() {
  for (const auto& [name, value] : {std::pair{"OMPI_MCA_rmaps_base_oversubscribe", "1"},
                                    {"OMPI_MCA_hwloc_base_binding_policy", "none"},
                                    {"OMPI_MCA_mpi_yield_when_idle", "1"},
                                    {"OMPI_MCA_btl_vader_single_copy_mechanism", "none"},
                                    {"OMPI_ALLOW_RUN_AS_ROOT", "1"},
                                    {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"}})
    setenv(name, value, 0);  // NOLINT: no thread has begun
  unsetenv("OMPI_MCA_ess_singleton_isolated");
}

}  // namespace

int start_ranks(int argc, char** argv, const RankedProgram& ranked) {
  if (ranked.on_ranks.empty()) return 0;
  std::vector<std::string> words;
  try {
    const ParticipantOptions options = parse_participant_options(argc, argv);
    if (options.mode != ParticipantOptions::Mode::serve || options.endpoint.empty()) return 0;
    CaseFile file = load_case(options, ranked.program);
    file.read_all([&] { ranked.program.declare(file); });
    if (ranked.ranks() <= 1) return 0;
    words = words_of(ranked.launcher(), ranked.ranks());
    words.push_back(find_program(ranked.on_ranks).string());
  } catch (const Error& error) {
    if (ranked.ranks() <= 1) return 0;
    std::fputs(to_text(error).c_str(), stderr);
    return static_cast<int>(error.code());
  }
  words.insert(words.end(), argv + 1, argv + argc);
  std::vector<char*> line;
  for (std::string& word : words) line.push_back(word.data());
  line.push_back(nullptr);
  set_environment();
  execvp(line.front(), line.data());
  std::fputs(to_text(Error(ExitCode::participant_lost, ranked.program.prefix + ".launcher",
                           fmt::format("{} cannot be started: {}", words.front(), std::strerror(errno)),
                           "install openmpi-bin, or name another launcher"))
                 .c_str(),
             stderr);
  return static_cast<int>(ExitCode::participant_lost);
}

int main_or_ranks(int argc, char** argv, const RankedProgram& ranked) {
  const int code = start_ranks(argc, argv, ranked);
  return code != 0 ? code : participant_main(argc, argv, ranked.program);
}

}  // namespace strake
