#pragma once

#include "coupler/coupling/scheme.hpp"
#include "proto/participant.hpp"

#include <cstdint>
#include <functional>
#include <string>

namespace strake {

/// Limits for shorter windows. A window is shortened if a solver requests it or an iteration does not
/// converge (Unconverged::halve), and grows again.
struct WindowControl {
  double smallest = 0;  // [s] below it the run ends; 0: a millionth of the window
  double growth = 2;    // factor, at least 1
  int patience = 4;     // windows of one length before they grow
};

/// What the loop remembers from window to window, for a checkpoint.
struct LoopState {
  double time = 0;   // [s]
  long windows = 0;  // committed
  double length =
      std::numeric_limits<double>::infinity();  // [s] that a failed window left; of the next one at most
  int settled = 0;                              // windows since it changed
  long unconverged = 0;                         // windows that were accepted so; for a message alone
  double limit = std::numeric_limits<double>::infinity();  // [s] that the solvers accept

  void save(Archive&) const;  // names begin with "loop."
  static LoopState from(const Archive&);
};

/// The times of a run. Windows begin at multiples of `window`; the last one ends at `end`.
struct RunPlan {
  double end = 0;     // [s]
  double window = 0;  // [s]
  double output_every =
      0;  // [s] field frames: the first commit at or past each multiple; 0: the last commit alone
  LoopState start = {};  // of a resumed run
  WindowControl control = {};
  std::string remedy = {};  // a line of what else the case lets a user change where no window is short enough
  /// What to change: instead of the solver's advice where windows before were accepted unconverged, before it
  /// where much shorter windows failed too.
  std::string if_halving_failed = {};

  long n_windows() const;  // of the whole run, if no solver requests shorter ones
};

/// What became of one window.
struct CommittedWindow {
  long number = 0;  // from 1
  double time = 0;  // [s] at its end
  WindowReport report;
  bool output = false;  // a field frame was written with it
  bool last = false;
  int taken_back = 0;  // longer windows that were tried first
  std::string why;     // of the last of them
};

/// The time loop of a run: window after window through a scheme, or through one participant alone.
class WindowLoop {
 public:
  WindowLoop(Scheme&, const RunPlan&);
  enum class Side { fluid, structure };
  WindowLoop(Participant& alone, Side, const RunPlan&);
  bool finished() const { return finished_; }
  const LoopState& state() const { return state_; }
  double time() const { return state_.time; }
  long number() const { return state_.windows; }  // committed
  /// Advances and commits one window. It ends at the next multiple of the plan's window, or is an equal part
  /// of the time that is left to it. Throws what the participants throw, and Error(solver_fault) when windows
  /// shrink below the smallest.
  CommittedWindow next();

 private:
  using Advance = std::function<WindowReport(const Window&)>;
  using Commit = std::function<void(bool)>;
  WindowLoop(const RunPlan&, Advance, Commit);
  double next_end() const;
  Window next_window() const;
  void shorten(const Window& failed, const CommittedWindow& tried, double longest);
  void lengthen();
  double frames_up_to(double time) const;
  bool output_due(double time);
  Advance advance_;
  Commit commit_;
  RunPlan plan_;
  LoopState state_;
  double frames_passed_ = 0;  // multiples of output_every so far
  bool finished_ = false;
};

}  // namespace strake
