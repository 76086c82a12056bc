#pragma once

#include "coupler/coupling/window_loop.hpp"
#include "coupler/processes/exchange_times.hpp"
#include "coupler/timing/profile.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

namespace strake {

/// trace.json: which process computed and which waited, on the coupler's clock. It has the Chrome trace
/// format: an array of events with begin `ts` and length `dur` in microseconds since the run began.
///
/// The file is valid JSON whenever a kill or a full disk ends the writing. Blanks stand between the events
/// and the closing bracket, which never moves; complete events replace blanks. No write and no event crosses
/// the border of a page, within which a kill does not cut a write. When the blanks are used up, a file twice
/// as long is written aside and renamed; the last one has none. At most 50 ms of events are not yet written.
/// A trace never ends a run: what cannot be written is left out.
///
/// Its size is bounded. Every window is recorded up to `octave` bytes, then every second one for as many
/// bytes, every fourth, and so on, up to `most` bytes in all. A window is in completely or not at all.
class Trace {
 public:
  struct Limits {
    std::int64_t octave = std::int64_t{4} << 20, most = std::int64_t{32} << 20;  // [bytes]
  };
  explicit Trace(const std::filesystem::path&);
  Trace(const std::filesystem::path&, const Limits&);
  ~Trace();
  Trace(const Trace&) = delete;
  Trace& operator=(const Trace&) = delete;

  static std::int64_t now();  // [ns] of the coupler's steady clock

  void add(const Exchange&);
  /// What the coupler itself did: "files", "checkpoint".
  void add(const std::string& what, std::int64_t begin, std::int64_t end);
  /// The window that is committed; all that is added from here on belongs to the next one.
  void end_window(long number, double time, int iterations, bool converged, std::int64_t begin,
                  std::int64_t end);

 private:
  struct Side {
    int process = 0;
    ClockOffset clock;
    std::int64_t idle_since = 0;  // [ns] 0: not known
  };
  Side& side(const std::string& name);
  void name_row(int process, int thread, const std::string& process_name, const std::string& thread_name);
  void slice(int process, int thread, const std::string& name, std::int64_t begin, std::int64_t end,
             const std::string& arguments);
  void add_event(const std::string& event);
  void flush();
  bool replace(std::int64_t size);

  Limits limits_;
  std::filesystem::path path_;
  int file_ = -1;
  std::int64_t zero_ = 0, flushed_ = 0;  // [ns]
  std::int64_t size_ = 0;                // [bytes] of the file
  std::int64_t written_ = 0;             // [bytes] in the file, without blanks and closing bracket
  std::int64_t octave_begin_ = 0;        // [bytes]
  std::string held_;                     // not yet in the file: its bytes from `written_` on
  long every_ = 1;                       // every how many windows one is recorded
  bool recording_ = true;                // the window under way
  std::map<std::string, Side> sides_;
};

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
