#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace strake::structure::ccx {

/// The program; throws Error(case_file) that names the package where it is not installed.
std::filesystem::path installed_program();
/// "2.20"; empty if it is not printed.
std::string installed_version();

/// Starts CalculiX on decks in a temporary folder of its own. The folder is removed with this object; after a
/// failure it is kept for inspection.
class Runner {
 public:
  /// `run_folder`: its folder is run_folder/ccx, of several bodies ccx_BODY; without one a temporary one.
  Runner(std::filesystem::path run_folder, const std::string& body, double answer_within);
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  /// Runs a deck to its end. `restart`: content of the restart file that it reads, if any. `what` names the
  /// computation in errors. Throws Error(solver_fault) with the last lines of CalculiX when it fails or
  /// exceeds the time for an increment; Error(cannot_write) without room on the disk.
  void run(const std::string& deck, const std::string& restart, std::size_t increments,
           const std::string& what);
  /// Files of the last run: "dat", "frd", "rout".
  std::filesystem::path file(const std::string& extension) const;
  /// All bytes of one of them; fails like `run` where it is missing or empty.
  std::string content(const std::string& extension, const std::string& what);
  /// The error for a run that ended well and wrote less than was requested.
  [[noreturn]] void fail(const std::string& what, const std::string& problem);

 private:
  void prepare();
  void write(const std::string& name, const std::string& bytes);

  std::filesystem::path own_folder_;  // below that of the run; empty: none
  std::filesystem::path folder_;
  double answer_within_;  // [s]
  bool keep_ = false;
};

}  // namespace strake::structure::ccx
