#pragma once

#include "coupler/coupling/window_loop.hpp"
#include "coupler/participant/interface_record.hpp"
#include "proto/files/history.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// The files that grow with a run: history.csv, iterations.csv, timing.csv and interface/. What must be equal
/// when two runs are equal stands apart from what a clock says.
class RunFiles {
 public:
  struct Options {
    std::filesystem::path folder;
    bool coupled = false;
    bool mechanical = true;  // displacement and force cross the interface: their columns are written
    int dimension = 2;
    std::vector<Column> columns;                  // of the participants
    InterfaceMesh mesh;                           // the structure's
    std::vector<Field> initial;                   // its motion at t = 0
    std::vector<Column> measured;                 // fields with a residual, Scheme::measured
    std::optional<LoopState> resumed;             // lines after it are dropped
    std::function<void(const std::string&)> say;  // receives messages for the user; may be empty
    bool tells_moment = true;                     // history.csv has the moment of the force
  };
  explicit RunFiles(Options);

  /// values: of Options::columns. wall: seconds this window took.
  void append(const CommittedWindow&, const std::vector<double>& values, double wall);
  /// Writes all buffered data, and waits until everything that a resume needs is on the disk. Files stay
  /// usable.
  void flush();
  /// history.csv so far.
  const Table& table() const { return table_; }

 private:
  void add_moment(std::vector<double>& row, const WindowReport&) const;
  void append_timing(const CommittedWindow&, double wall);
  std::unique_ptr<History> open_timing(const std::vector<Column>&) const;
  Options options_;
  Table table_;
  std::unique_ptr<History> history_, iterations_, timing_;
  std::vector<std::pair<bool, std::string>> stages_;  // of timing.csv: (fluid, monitor)
  std::unique_ptr<InterfaceRecorder> interface_;
};

}  // namespace strake
