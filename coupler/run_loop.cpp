#include "coupler/run_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "proto/error.hpp"

namespace strake {

namespace {
// Times are compared up to this part of a window: multiples of a decimal step are not exact in binary.
constexpr double slack = 1e-6;
// A window this many times shorter than asked for means that a solver will not go on.
constexpr double shortest = 1e-6;
}  // namespace

long RunPlan::n_windows() const {
  return std::max(1L, static_cast<long>(std::ceil(end / window - slack)));
}

RunLoop::RunLoop(const RunPlan& plan, Advance advance, Commit commit)
    : advance_(std::move(advance)),
      commit_(std::move(commit)),
      plan_(plan),
      time_(plan.start),
      number_(plan.windows_before) {
  assert(plan.window > 0 && plan.end > 0);
  if (plan_.output_every > 0)
    frames_due_ = static_cast<long>(std::floor((time_ + slack * plan_.window) / plan_.output_every)) + 1;
  finished_ = time_ >= plan_.end - slack * plan_.window;
}

RunLoop::RunLoop(Scheme& scheme, const RunPlan& plan)
    : RunLoop(
          plan, [&scheme](const Window& window) { return scheme.advance(window); },
          [&scheme](bool write_output) { scheme.commit(write_output); }) {}

RunLoop::RunLoop(Participant& alone, Side side, const RunPlan& plan)
    : RunLoop(
          plan,
          [&alone, side](const Window& window) {
            WindowReport report = advance_alone(alone, window);
            if (side == Side::structure) std::swap(report.fluid, report.structure);
            return report;
          },
          [&alone](bool write_output) { alone.commit(write_output); }) {}

double RunLoop::next_end() const {
  // The next grid line, by multiplication: sums of a step drift.
  const double line = (std::floor(time_ / plan_.window + slack) + 1) * plan_.window;
  return line > plan_.end - slack * plan_.window ? plan_.end : line;
}

bool RunLoop::output_due(double time) {
  if (plan_.output_every <= 0) return false;
  const double tolerance = slack * plan_.window;
  if (time + tolerance < static_cast<double>(frames_due_) * plan_.output_every) return false;
  while (static_cast<double>(frames_due_) * plan_.output_every <= time + tolerance) ++frames_due_;
  return true;
}

CommittedWindow RunLoop::next() {
  assert(!finished_);
  double end = next_end(), dt = end - time_;
  // A whole window has the very same length each time, so that solvers may keep what they factorised for it.
  if (std::abs(dt - plan_.window) < slack * plan_.window) dt = plan_.window;
  CommittedWindow done;
  for (double limit = limit_;; limit = std::min(0.5 * dt, done.report.dt_limit)) {
    if (dt > limit) {
      dt = limit;
      end = time_ + dt;
    }
    if (!(dt > shortest * plan_.window))
      throw Error(ExitCode::solver_fault, fmt::format("window {} (t = {:.6g} s)", number_ + 1, time_),
                  fmt::format("a solver asks for windows shorter than {:.3g} s", shortest * plan_.window),
                  "look at the last frames: the solution has probably blown up");
    done.report = advance_({.t = time_, .dt = dt});
    if (!done.report.retry) break;
  }
  limit_ = done.report.dt_limit;
  time_ = end;
  finished_ = time_ >= plan_.end - slack * plan_.window;
  done.number = ++number_;
  done.time = time_;
  done.output = output_due(time_) || finished_;
  done.last = finished_;
  commit_(done.output);
  return done;
}

}  // namespace strake
