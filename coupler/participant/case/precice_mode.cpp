#include "coupler/participant/case/declared_case.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/participant/precice/partner_surface.hpp"
#include "coupler/participant/precice/solver_loop.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <memory>
#include <new>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace strake {
namespace {

/// What preCICE's names of data mean: the case's rules, else those of the environment.
QuantityNames names_of(const CommonKeys& keys, const std::string& side) {
  const std::vector<std::string>& rules = keys.program_of(side).precice_names;
  const char* given = std::getenv("STRAKE_PRECICE_NAMES");
  return QuantityNames(rules.empty() ? std::string(given ? given : "") : joined(rules, ";"));
}

/// The command line of this process, word by word.
std::vector<std::string> own_command_line() {
  std::ifstream line("/proc/self/cmdline");
  std::vector<std::string> words;
  for (std::string word; std::getline(line, word, '\0');) words.push_back(word);
  return words;
}

/// Starts this program once more with the environment that Strake gives to solvers, where it lacks a part of
/// it: libraries read it while they are loaded, and results shall not depend on the machine.
void take_solver_environment(int threads) {
  bool changed = false;
  for (const auto& [name, value] : solver_environment(threads)) {
    if (name == "PYTHONPATH" || std::getenv(name.c_str())) continue;
    changed = setenv(name.c_str(), value.c_str(), 0) == 0 || changed;
  }
  if (!changed) return;
  std::vector<std::string> words = own_command_line();
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv("/proc/self/exe", pointers.data());  // returns where it fails, and the run goes on as it is
}

/// A solver and the library, from the first call to the last.
class PreciceRun {
 public:
  PreciceRun(const ParticipantOptions& options, const Program& program, CommonKeys keys, OwnPart part,
             PreciceLibrary library)
      : options_(options),
        program_(program),
        keys_(std::move(keys)),
        part_(std::move(part)),
        library_(std::move(library)) {}

  int run(CaseFile& file) {
    spdlog::info(fmt::format("{} {} as preCICE participant \"{}\", process {}, library {} ({})",
                             program_.solver, program_.version, part_.participant, getpid(),
                             library_.file.string(), library_.version));
    // First, so that a coupler need not wait for the solver to be built.
    library_.create(part_.participant.c_str(), options_.precice.config.c_str(), 0, 1);
    try {
      couple(file);
    } catch (const Error& e) {
      leave(e);
    } catch (const std::bad_alloc&) {
      leave({ExitCode::solver_fault, program_.prefix, "is out of memory", "a coarser spacing needs less"});
    } catch (const std::exception& e) {
      leave(
          {ExitCode::our_bug, program_.prefix, fmt::format("unexpected: {}", e.what()), "please report it"});
    }
    return static_cast<int>(ExitCode::done);
  }

 private:
  Setup setup() const {
    Setup setup;
    if (program_.prefix == "fluid")
      setup = setup_with_body({.solver = keys_.structure_solver,
                               .surface = keys_.structure_program.surface,
                               .case_file = options_.case_file,
                               .sets = options_.sets},
                              part_.dimension);
    setup.interface = "surface";
    setup.run_folder = options_.deck.folder;
    setup.history = part_.writes_samples;
    return setup;
  }

  void couple(CaseFile& file) {
    if (!options_.deck.folder.empty()) make_results_folder(options_.deck.folder);
    const std::unique_ptr<Participant> solver = program_.build(file, options_, setup());
    for (const std::string& line : solver->description().lines) spdlog::info(line);
    part_.check_dimension(solver->mesh().dimension, options_.precice.config);
    OwnResults results(options_.deck.folder, keys_.output_every, solver->description());
    SolverLoop loop(library_, part_, *solver, results, program_.prefix);
    loop.run();
    library_.finalize();
    const WindowTimes& times = loop.times();
    if (std::abs(times.length() - keys_.window) > 1e-6 * keys_.window)
      spdlog::info(
          fmt::format("the windows of the preCICE run were {:.6g} s; {:.6g} s of the case were not used",
                      times.length(), keys_.window));
    spdlog::info(fmt::format("the preCICE run has ended: {} windows, {} iterations, t = {:.9g} s{}",
                             times.windows(), loop.iterations(), times.time(),
                             options_.deck.folder.empty() ? "; no results were written (--into DIR)"
                                                          : "; results in " + options_.deck.folder.string()));
  }

  /// Ends the process before the run's end. Strake's library is told why; that of preCICE may wait for the
  /// partner in its last call, and its destructor with it, so it is left as it is.
  [[noreturn]] void leave(const Error& error) {
    std::fputs(to_text(error).c_str(), stderr);
    if (library_.is_strakes) {
      const std::string fix = error.fix().empty() ? "" : "\n  fix: " + error.fix();
      setenv("STRAKE_PRECICE_REASON", (error.where() + ": " + error.problem() + fix).c_str(), 1);
      library_.finalize();
    }
    spdlog::shutdown();
    std::fflush(nullptr);
    std::_Exit(static_cast<int>(error.code()));
  }

  const ParticipantOptions& options_;
  const Program& program_;
  CommonKeys keys_;
  OwnPart part_;
  PreciceLibrary library_;
};

}  // namespace

int run_in_precice(const ParticipantOptions& options, const Program& program) {
  const PreciceRequest& wanted = options.precice;
  const PreciceConfig config = PreciceConfig::read(wanted.config);
  if (wanted.participant.empty()) {
    std::vector<std::string> names;
    for (const auto& participant : config.participants) names.push_back(participant.name);
    throw Error(ExitCode::command_line, "--participant", "is missing",
                fmt::format("the participants of {}: {}", wanted.config, joined(names)));
  }
  require_option(!options.case_file.empty(), "--case");
  CaseFile common = load_case(options, program);
  CommonKeys keys = read_common(common);
  if (keys.interface == "volume")
    throw Error(ExitCode::case_file, options.case_file,
                "couples all particles of the structure (coupling.interface = \"volume\")",
                "coupling.interface = \"surface\": preCICE exchanges data on surfaces here");
  if (program.prefix == "fluid" && !keys.bodies.empty())
    throw Error(ExitCode::case_file, options.case_file, "has several bodies",
                "in a preCICE run the fluid meets one structure: [structure] in place of [[structures]]");
  if (common.has("attachments"))
    throw Error(
        ExitCode::case_file, options.case_file, "has [[attachments]]",
        "in a preCICE run their forces come from participants of that run; leave them out of this case");
  OwnPart part = OwnPart::of(config, wanted.participant, names_of(keys, program.prefix));
  part.check_data(program.prefix, wanted.config);
  const std::vector<double> dimension = common.numbers_at("fluid.dimension");
  part.check_dimension(dimension.empty() ? 2 : static_cast<int>(dimension.front()), wanted.config);
  take_solver_environment(keys.threads);
  PreciceLibrary library = PreciceLibrary::load(wanted.library);
  CaseFile file = load_declared(options, program);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // a log is read while it is written
  tune_malloc();
  spdlog::flush_on(spdlog::level::info);
  return PreciceRun(options, program, std::move(keys), std::move(part), std::move(library)).run(file);
}

}  // namespace strake
