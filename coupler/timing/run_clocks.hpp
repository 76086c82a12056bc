#pragma once

#include "coupler/coupling/window_loop.hpp"
#include "coupler/timing/profile.hpp"
#include "coupler/timing/trace.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

namespace strake {

/// Records where the time of a run goes: for its trace, its profile, or not at all.
class RunClocks {
 public:
  struct Options {
    bool trace = false, profile = false;
    bool resumed = false;  // the trace of the part before is kept under another name
  };
  RunClocks(std::filesystem::path run_folder, const Options&);

  void open();  // the trace begins
  /// Called for each answered request; empty if no record is wanted.
  std::function<void(const Exchange&)> observer();
  /// A window and its files are done; begin and end [ns] of the window alone, Trace::now().
  void end_window(const CommittedWindow&, std::int64_t begin, std::int64_t end);
  void close() { trace_.reset(); }
  const Profile* profile() const { return options_.profile ? &profile_ : nullptr; }

 private:
  std::filesystem::path folder_;
  Options options_;
  std::optional<Trace> trace_;
  Profile profile_;
};

}  // namespace strake
