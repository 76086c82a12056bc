#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace strake {

/// Exit codes of every Strake program.
enum class ExitCode : int {
  done = 0,
  outside_tolerance = 1,  // compare, run --strict
  command_line = 2,       // options, or a run folder that exists
  case_file = 3,          // the case file or a file it names
  solver_fault = 4,       // a solver gave up, or a value is not finite
  participant_lost = 5,   // a participant crashed, froze or vanished; a solver whose coupler is gone
  cannot_write = 6,
  our_bug = 70,
  hung_up = 129,      // SIGHUP: the terminal is gone
  interrupted = 130,  // SIGINT
  terminated = 143,   // SIGTERM
};

/// An error that a user, a file, a peer or the physics can cause. It is thrown where it is found, and caught
/// once in main.
class Error : public std::runtime_error {
 public:
  /// where: place ("case.toml:40:9: structure.material.young = 0", "fluid, window 420 (t = 0.0042 s)").
  /// problem: first line joins `where`; further lines are details. fix: what to change, may be empty.
  Error(ExitCode code, std::string where, std::string problem, std::string fix = {});

  ExitCode code() const { return code_; }
  const std::string& where() const { return where_; }
  const std::string& problem() const { return problem_; }
  const std::string& fix() const { return fix_; }

 private:
  ExitCode code_;
  std::string where_, problem_, fix_;
};

/// The text of an error as every program prints it: "where: problem\n  details\n  fix: …\n".
std::string to_text(const Error&);

/// One Error(case_file) with the texts of all, in their order, each once. An error may itself hold several:
/// each begins with a line that is not indented. errors: at least one.
Error all_of(const std::vector<Error>& errors);

/// The name nearest to `word` among `known` by edit distance, or empty if none is near.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known);

}  // namespace strake
