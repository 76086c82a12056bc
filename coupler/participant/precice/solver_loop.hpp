#pragma once

#include "coupler/participant/precice/c_library.hpp"
#include "coupler/participant/precice/own_part.hpp"
#include "proto/files/history.hpp"
#include "proto/interface.hpp"
#include "proto/participant.hpp"

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// The time of a preCICE run, which has no function that tells it. Windows end at multiples of the first
/// one's length, by multiplication, as in the coupler's own loop: sums of a length drift.
class WindowTimes {
 public:
  /// The window that begins now. dt: what the library leaves [s].
  Window begin(double dt) {
    if (length_ == 0) length_ = dt;
    return {.t = time_, .dt = dt};
  }
  /// The window is accepted.
  void end(const Window& window) {
    constexpr double slack = 1e-6;  // of a window: a decimal step is not exact in binary
    const double line = (std::floor(time_ / length_ + slack) + 1) * length_, end = window.t + window.dt;
    time_ = std::abs(end - line) < slack * window.dt ? line : end;
    ++windows_;
  }
  double time() const { return time_; }      // [s]
  double length() const { return length_; }  // [s] of the first window
  long windows() const { return windows_; }  // accepted

 private:
  double time_ = 0, length_ = 0;
  long windows_ = 0;
};

/// A solver's interface in preCICE: its points, its faces, and fields on the points.
class InterfaceExchange {
 public:
  /// Sets the points, and the faces where the library asks for them. To be called before `initialize`.
  /// Error(case_file) for a mesh without points.
  InterfaceExchange(const PreciceLibrary&, const OwnPart&, const InterfaceMesh&);

  /// The partner's fields at a time of the window, `from_now` from now [s], with Strake's names and three
  /// components (z = 0 in two dimensions).
  std::vector<Field> read(double from_now) const;
  /// Writes each data of the part from the field of its quantity. Error(solver_fault) if a field is missing
  /// or a value is not finite; `when` says of which window.
  void write(const std::vector<Field>&, const std::string& when) const;

 private:
  const PreciceLibrary& library_;
  const OwnPart& part_;
  std::vector<int> ids_;
};

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

/// A solver in a preCICE run: in each window it reads the partner's fields, advances, writes its own, and
/// commits or rewinds as the library says.
class SolverLoop {
 public:
  /// side: "fluid" or "structure", for errors.
  SolverLoop(const PreciceLibrary&, const OwnPart&, Participant&, OwnResults&, std::string side);

  /// From `initialize` to the end of the run, without `finalize`. Error(solver_fault) if the solver asks for
  /// a shorter window, which preCICE cannot give, or fails.
  void run();

  const WindowTimes& times() const { return times_; }
  long iterations() const { return iterations_; }  // of all windows

 private:
  Input input_of(const Window&) const;
  std::vector<Field> mean_load(const Window&) const;
  void write_window(const Window&, const Advanced&) const;
  void check_length(const Window&, double limit, const std::string& why, const std::string& fix) const;
  std::string place(const Window&) const;

  const PreciceLibrary& library_;
  const OwnPart& part_;
  Participant& solver_;
  OwnResults& results_;
  std::string side_;
  InterfaceExchange exchange_;
  WindowTimes times_;
  long iterations_ = 0;
};

}  // namespace strake
