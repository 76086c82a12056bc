#pragma once

#include "proto/files/history.hpp"
#include "proto/participant.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace strake {

/// When a participant of a preCICE run writes frames, and its history.csv: one row per window with the
/// columns that the solver announces.
class OwnResults {
 public:
  /// folder: exists; empty: no history. every: between frames [s]; 0: the last window alone.
  OwnResults(std::filesystem::path folder, double every, const Description&);

  /// Whether a frame is due at the end of a window: the first end at or past each multiple of `every`.
  bool frame_due(const Window&) const;
  /// A row of a window that is accepted. monitor: as Advanced has it.
  void append(long window, double time, int iterations, const std::map<std::string, double>& monitor);

 private:
  double every_;  // [s]
  std::vector<Column> columns_;
  std::optional<History> history_;
};

/// Makes the folder of results. Error(command_line) if it holds results already, Error(cannot_write) if it
/// cannot be made.
void make_results_folder(const std::filesystem::path&);

}  // namespace strake
