#include "coupler/coupling/window_loop.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace strake {

namespace {
// Times are compared up to this part of a window: multiples of a decimal step are not exact in binary.
constexpr double slack = 1e-6;
// A window this many times shorter than requested means that a solver cannot continue.
constexpr double shortest = 1e-6;
// Where one so many times shorter failed too, the length of windows was not the cause.
constexpr double much_shorter = 0.01;

double smallest(const RunPlan& plan) {
  return plan.control.smallest > 0 ? plan.control.smallest : shortest * plan.window;
}
}  // namespace

long RunPlan::n_windows() const {
  constexpr double most = 1e18;  // largest count of a whole number; no run reaches it
  return static_cast<long>(std::clamp(std::ceil(end / window - slack), 1.0, most));
}

WindowLoop::WindowLoop(const RunPlan& plan, Advance advance, Commit commit)
    : advance_(std::move(advance)), commit_(std::move(commit)), plan_(plan), state_(plan.start) {
  assert(plan.window > 0 && plan.end > 0);
  frames_passed_ = frames_up_to(state_.time);
  finished_ = state_.time >= plan_.end - slack * plan_.window;
}

WindowLoop::WindowLoop(Scheme& scheme, const RunPlan& plan)
    : WindowLoop(
          plan, [&scheme](const Window& window) { return scheme.advance(window); },
          [&scheme](bool write_output) { scheme.commit(write_output); }) {}

WindowLoop::WindowLoop(Participant& alone, Side side, const RunPlan& plan)
    : WindowLoop(
          plan,
          [&alone, side](const Window& window) {
            WindowReport report = advance_alone(alone, window);
            if (side == Side::structure) std::swap(report.fluid, report.structure);
            return report;
          },
          [&alone](bool write_output) { alone.commit(write_output); }) {}

double WindowLoop::next_end() const {
  // The next grid line, by multiplication: sums of a step drift.
  const double line = (std::floor(state_.time / plan_.window + slack) + 1) * plan_.window;
  return line > plan_.end - slack * plan_.window ? plan_.end : line;
}

/// Multiples of the frames' interval up to a time. Computed, not counted: a tiny interval has very many.
double WindowLoop::frames_up_to(double time) const {
  if (plan_.output_every <= 0) return 0;
  const double tolerance = slack * plan_.window;  // shorter than every window: each has a multiple of it
  return std::floor((time + tolerance) / std::max(plan_.output_every, tolerance));
}

bool WindowLoop::output_due(double time) {
  const double passed = frames_up_to(time);
  return passed > std::exchange(frames_passed_, passed);
}

/// From now to the next grid line, in equal parts as long as `length` and the solvers allow.
Window WindowLoop::next_window() const {
  const double rest = next_end() - state_.time, longest = std::min(state_.length, state_.limit);
  const double parts = std::max(1.0, std::ceil(rest / longest - slack));
  double dt = rest / parts;
  // The same length has the very same value each time, so that solvers may keep what they factorised for it.
  for (const double length : {plan_.window, state_.length})
    if (std::abs(dt - length) < slack * length) dt = length;
  return {.t = state_.time, .dt = dt};
}

void WindowLoop::shorten(const Window& failed, const CommittedWindow& tried, double longest) {
  const WindowReport& report = tried.report;
  const double least = smallest(plan_), wanted = std::min(0.5 * failed.dt, report.dt_limit);
  if (!(wanted >= least)) {
    const std::string all = tried.taken_back == 1
                                ? fmt::format("a window of {:.3g} s was tried", longest)
                                : fmt::format("{} windows were tried, of {:.3g} to {:.3g} s",
                                              tried.taken_back, longest, failed.dt);
    std::string fix =
        report.fix.empty() ? "look at the last frames: the solution has probably blown up" : report.fix;
    if (state_.unconverged > 0 && !plan_.if_halving_failed.empty())
      fix = fmt::format("{} of {} windows before it were accepted unconverged: {}", state_.unconverged,
                        state_.windows, plan_.if_halving_failed);
    else if (failed.dt < much_shorter * plan_.window && !plan_.if_halving_failed.empty())
      fix = plan_.if_halving_failed + "\n" + fix;
    if (tried.taken_back == 1 && longest > plan_.window * (1 - slack))
      fix += "\nlower coupling.surface.shorter.smallest: it allows no shorter window than the case's";
    if (!plan_.remedy.empty()) fix += "\n" + plan_.remedy;
    throw Error(ExitCode::solver_fault,
                fmt::format("window {} (t = {:.6g} s)", state_.windows + 1, state_.time),
                fmt::format("{}\n{}; the smallest is {:.3g} s", report.why, all, least), fix);
  }
  state_.length = wanted;
  state_.settled = 0;
}

void WindowLoop::lengthen() {
  if (std::isinf(state_.length) || ++state_.settled < plan_.control.patience) return;
  state_.length *= plan_.control.growth;
  state_.settled = 0;
  if (state_.length >= plan_.window * (1 - slack)) state_.length = LoopState{}.length;
}

CommittedWindow WindowLoop::next() {
  assert(!finished_);
  CommittedWindow done;
  Window window = next_window();
  const double longest = window.dt;
  for (;; window = next_window()) {
    if (!(window.dt > shortest * plan_.window))
      throw Error(ExitCode::solver_fault,
                  fmt::format("window {} (t = {:.6g} s)", state_.windows + 1, state_.time),
                  fmt::format("a solver asks for windows shorter than {:.3g} s", shortest * plan_.window),
                  "look at the last frames: the solution has probably blown up");
    done.report = advance_(window);
    if (!done.report.retry) break;
    ++done.taken_back;
    done.why = done.report.why;
    shorten(window, done, longest);
  }
  const double line = next_end(), end = window.t + window.dt;
  state_.time = std::abs(end - line) < slack * window.dt ? line : end;
  ++state_.windows;
  state_.unconverged += done.report.converged ? 0 : 1;
  state_.limit = done.report.dt_limit;
  lengthen();
  finished_ = state_.time >= plan_.end - slack * plan_.window;
  done.number = state_.windows;
  done.time = state_.time;
  done.output = output_due(done.time) || finished_;
  done.last = finished_;
  commit_(done.output);
  return done;
}

void LoopState::save(Archive& archive) const {
  archive.real["loop.time"] = Eigen::MatrixXd::Constant(1, 1, time);
  archive.real["loop.length"] = Eigen::RowVector2d(length, limit);
  archive.integer["loop.windows"] = {windows, settled, unconverged};
}

LoopState LoopState::from(const Archive& archive) {
  const auto time = archive.real.find("loop.time"), length = archive.real.find("loop.length");
  const auto counts = archive.integer.find("loop.windows");
  if (time == archive.real.end() || time->second.size() != 1 || length == archive.real.end() ||
      length->second.size() != 2 || counts == archive.integer.end() || counts->second.size() < 2)
    throw Error(ExitCode::case_file, "checkpoint, coupler.h5", "is not a checkpoint of a run",
                "resume from the other checkpoint");
  return {.time = time->second(0),
          .windows = static_cast<long>(counts->second[0]),
          .length = length->second(0),
          .settled = static_cast<int>(counts->second[1]),
          .unconverged = counts->second.size() > 2 ? static_cast<long>(counts->second[2]) : 0,
          .limit = length->second(1)};
}

}  // namespace strake
