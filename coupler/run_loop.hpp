#pragma once

#include <functional>

#include "coupler/scheme.hpp"
#include "proto/participant.hpp"

namespace strake {

/// The times of a run. Windows begin at multiples of `window`; the last one ends at `end`.
struct RunPlan {
  double end = 0;     // [s]
  double window = 0;  // [s]
  double output_every =
      0;             // [s] field frames: the first commit at or past each multiple; 0: the last commit alone
  double start = 0;  // [s] of a resumed run
  long windows_before = 0;  // committed before `start`

  long n_windows() const;  // of the whole run, if no solver asks for shorter ones
};

/// What became of one window.
struct CommittedWindow {
  long number = 0;  // from 1
  double time = 0;  // [s] at its end
  WindowReport report;
  bool output = false;  // a field frame was written with it
  bool last = false;
};

/// The time loop of a run: window after window through a scheme, or through one participant alone.
class RunLoop {
 public:
  RunLoop(Scheme&, const RunPlan&);
  enum class Side { fluid, structure };
  RunLoop(Participant& alone, Side, const RunPlan&);
  bool finished() const { return finished_; }
  double time() const { return time_; }
  long number() const { return number_; }  // windows committed
  /// Advances and commits one window. Throws what the participants throw, and Error(solver_fault) when
  /// windows shrink without end.
  CommittedWindow next();

 private:
  using Advance = std::function<WindowReport(const Window&)>;
  using Commit = std::function<void(bool)>;
  RunLoop(const RunPlan&, Advance, Commit);
  double next_end() const;
  bool output_due(double time);
  Advance advance_;
  Commit commit_;
  RunPlan plan_;
  double time_ = 0, limit_ = std::numeric_limits<double>::infinity();  // [s]
  long number_ = 0;
  long frames_due_ = 1;  // the next multiple of output_every
  bool finished_ = false;
};

}  // namespace strake
