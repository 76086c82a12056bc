#include "coupler/coupling/window_loop.hpp"

#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace strake {
namespace window_loop_test {

/// Records its calls.
class Listener final : public Participant {
 public:
  const InterfaceMesh& mesh() const override { return mesh_; }
  const Description& description() const override { return description_; }
  void start(const Window& window, const Input&) override { asked.push_back(window); }
  Advanced finish() override {
    Advanced advanced;
    advanced.dt_limit = limit;
    const double longest = longest_at ? longest_at(asked.back().t) : refuse_above;
    advanced.retry_smaller_dt = asked.back().dt > longest;
    if (advanced.retry_smaller_dt && !longest_at) advanced.dt_limit = longest;
    return advanced;
  }
  void rewind() override { asked.pop_back(); }
  void commit(bool write_output) override { outputs.push_back(write_output); }
  void checkpoint(const std::filesystem::path&) override {}
  void resume(const std::filesystem::path&) override {}

  std::vector<Window> asked;
  std::vector<bool> outputs;
  double limit = std::numeric_limits<double>::infinity(), refuse_above = limit;
  std::function<double(double t)> longest_at;  // instead of refuse_above, without a word on what would do

 private:
  InterfaceMesh mesh_;
  Description description_;
};

std::vector<CommittedWindow> run_to_end(Participant& participant, const RunPlan& plan) {
  WindowLoop loop(participant, WindowLoop::Side::fluid, plan);
  std::vector<CommittedWindow> windows;
  while (!loop.finished() && windows.size() < 10000) windows.push_back(loop.next());
  return windows;
}

TEST(WindowLoop, EndsExactlyAtTheEndWithWholeWindowsOfOneLength) {
  Listener listener;
  const auto windows = run_to_end(listener, {.end = 0.03, .window = 1e-5, .output_every = 1e-4});
  ASSERT_EQ(windows.size(), 3000u);
  EXPECT_EQ(windows.back().time, 0.03);
  EXPECT_TRUE(windows.back().last);
  for (const Window& window : listener.asked) EXPECT_EQ(window.dt, 1e-5);  // to the bit
}

TEST(WindowLoop, WritesAFrameAtTheFirstCommitAtOrPastEachMultiple) {
  Listener listener;
  run_to_end(listener, {.end = 1.0, .window = 0.04, .output_every = 0.1});
  std::vector<int> frames;
  for (std::size_t i = 0; i < listener.outputs.size(); ++i)
    if (listener.outputs[i]) frames.push_back(static_cast<int>(i) + 1);
  // ends of windows at or past 0.1, 0.2, …: 0.12, 0.20, 0.32, 0.40, 0.52, 0.60, 0.72, 0.80, 0.92, 1.00
  EXPECT_EQ(frames, (std::vector<int>{3, 5, 8, 10, 13, 15, 18, 20, 23, 25}));
}

TEST(WindowLoop, WritesOneFramePerCommitWhenWindowsAreLongerThanTheInterval) {
  Listener listener;
  const auto windows = run_to_end(listener, {.end = 1.0, .window = 0.25, .output_every = 0.1});
  ASSERT_EQ(windows.size(), 4u);
  EXPECT_EQ(listener.outputs, (std::vector<bool>{true, true, true, true}));
}

TEST(WindowLoop, WritesOneFramePerCommitHoweverShortTheInterval) {
  for (const double every : {1e-9, 1e-30, 1e-300, std::numeric_limits<double>::denorm_min()}) {
    Listener listener;
    run_to_end(listener, {.end = 1.0, .window = 0.25, .output_every = every});
    EXPECT_EQ(listener.outputs, (std::vector<bool>{true, true, true, true})) << every;
  }
}

TEST(WindowLoop, WritesTheLastFrameAloneWhenTheIntervalIsLongerThanTheRun) {
  for (const double every : {1e30, std::numeric_limits<double>::max()}) {
    Listener listener;
    run_to_end(listener, {.end = 1.0, .window = 0.25, .output_every = every});
    EXPECT_EQ(listener.outputs, (std::vector<bool>{false, false, false, true})) << every;
  }
}

TEST(WindowLoop, CountsTheWindowsOfARunThatNobodyCanAwait) {
  EXPECT_EQ((RunPlan{.end = 1e300, .window = 1e-300}).n_windows(), 1'000'000'000'000'000'000);
  EXPECT_EQ((RunPlan{.end = 1e-300, .window = 1}).n_windows(), 1);
}

TEST(WindowLoop, ShortensOnlyTheLastWindow) {
  Listener listener;
  const auto windows = run_to_end(listener, {.end = 1.0, .window = 0.3, .output_every = 0});
  ASSERT_EQ(windows.size(), 4u);
  EXPECT_NEAR(listener.asked.back().dt, 0.1, 1e-15);
  EXPECT_EQ(windows.back().time, 1.0);
  EXPECT_EQ(listener.outputs, (std::vector<bool>{false, false, false, true}));
}

TEST(WindowLoop, KeepsToTheLimitThatASolverNames) {
  Listener listener;
  listener.limit = 0.1;
  const auto windows = run_to_end(listener, {.end = 1.0, .window = 0.25, .output_every = 0});
  for (std::size_t i = 1; i < listener.asked.size(); ++i) EXPECT_LE(listener.asked[i].dt, 0.1 + 1e-12);
  EXPECT_EQ(windows.back().time, 1.0);
}

TEST(WindowLoop, KeepsToTheLimitOfTheFirstWindow) {
  Listener listener;
  RunPlan plan = {.end = 1.0, .window = 0.25, .output_every = 0};
  plan.start.limit = 0.1;
  run_to_end(listener, plan);
  EXPECT_NEAR(listener.asked[0].dt, 0.25 / 3, 1e-15);
  EXPECT_EQ(listener.asked[1].t, listener.asked[0].dt);
  EXPECT_NEAR(listener.asked[1].dt, 0.25 * 2 / 3, 1e-15);  // its Advanced names no limit
}

TEST(WindowLoop, GoesOnWhereAnEarlierRunEnded) {
  Listener listener;
  WindowLoop loop(listener, WindowLoop::Side::structure,
                  {.end = 1.0, .window = 0.1, .output_every = 0.2, .start = {.time = 0.5, .windows = 5}});
  const CommittedWindow first = loop.next();
  EXPECT_EQ(first.number, 6);
  EXPECT_NEAR(first.time, 0.6, 1e-12);
  EXPECT_TRUE(first.output);
}

/// Windows of 0.1 s that fail above 0.02 s between 0.4 and 0.6 s.
double narrow_passage(double t) {
  return t > 0.39 && t < 0.599 ? 0.02 : 1;
}

TEST(WindowLoop, HalvesAWindowThatFailsAndLetsItGrowAgainWithoutDrift) {
  Listener listener;
  listener.longest_at = narrow_passage;
  const RunPlan plan = {
      .end = 1.0, .window = 0.1, .output_every = 0, .start = {}, .control = {.patience = 3}};
  const auto windows = run_to_end(listener, plan);
  EXPECT_EQ(windows.back().time, 1.0);
  EXPECT_EQ(windows[4].taken_back, 3);
  EXPECT_EQ(windows[4].why, "the solver asks for a shorter window than 0.025 s");
  for (int k = 1; k <= 10; ++k)  // every multiple of the window is the end of one, to the bit
    EXPECT_TRUE(std::any_of(windows.begin(), windows.end(), [&](const CommittedWindow& w) {
      return w.time == k * plan.window || w.last;
    })) << k;
  for (std::size_t i = 1; i < listener.asked.size(); ++i)
    EXPECT_NEAR(listener.asked[i].t, listener.asked[i - 1].t + listener.asked[i - 1].dt, 1e-15);
  EXPECT_EQ(listener.asked[4].dt, 0.0125);
  EXPECT_EQ(listener.asked.back().dt, 0.1);  // grown again
  // Inside, three windows of 12.5 ms, then one of 25 ms is tried and taken back, and so on.
  int tried = 0;
  for (const CommittedWindow& window : windows) tried += window.taken_back;
  EXPECT_LE(tried, 3 + 6);
}

TEST(WindowLoop, GoesOnAlikeFromAnyWindowWhileItsLengthChanges) {
  const RunPlan plan = {
      .end = 1.0, .window = 0.1, .output_every = 0, .start = {}, .control = {.patience = 3}};
  Listener whole;
  whole.longest_at = narrow_passage;
  const std::size_t n = run_to_end(whole, plan).size();
  for (std::size_t stop = 1; stop < n; ++stop) {
    Listener parts;
    parts.longest_at = narrow_passage;
    WindowLoop first(parts, WindowLoop::Side::fluid, plan);
    for (std::size_t w = 0; w < stop; ++w) first.next();
    Archive archive;
    first.state().save(archive);
    RunPlan rest = plan;
    rest.start = LoopState::from(archive);
    run_to_end(parts, rest);
    ASSERT_EQ(parts.asked.size(), whole.asked.size());
    for (std::size_t w = 0; w < parts.asked.size(); ++w) {
      EXPECT_EQ(parts.asked[w].t, whole.asked[w].t);
      EXPECT_EQ(parts.asked[w].dt, whole.asked[w].dt);
    }
  }
}

TEST(WindowLoop, EndsWithTheReasonBelowTheSmallestWindow) {
  Listener listener;
  listener.longest_at = [](double t) { return t > 0.39 ? 0.02 : 1; };
  WindowLoop loop(listener, WindowLoop::Side::fluid,
                  {.end = 1.0, .window = 0.1, .output_every = 0, .start = {}, .control = {.smallest = 0.03}});
  for (int w = 0; w < 4; ++w) loop.next();
  try {
    loop.next();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), "window 5 (t = 0.4 s)");
    EXPECT_EQ(error.problem(),
              "the solver asks for a shorter window than 0.05 s\n"
              "2 windows were tried, of 0.1 to 0.05 s; the smallest is 0.03 s");
  }
}

// Windows of 0.1 s down to 0.2 ms fail: their length is not the cause.
TEST(WindowLoop, AdvisesMoreWhereMuchShorterWindowsFailedToo) {
  for (const double smallest : {0.03, 1e-4}) {
    Listener listener;
    listener.longest_at = [](double) { return 1e-9; };
    WindowLoop loop(listener, WindowLoop::Side::fluid,
                    {.end = 1.0,
                     .window = 0.1,
                     .output_every = 0,
                     .control = {.smallest = smallest},
                     .if_halving_failed = "advice"});
    try {
      loop.next();
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.fix().starts_with("advice"), smallest < 0.01) << error.fix();
    }
  }
}

// Three of the first four windows of a run were accepted unconverged. It goes on from a checkpoint.
TEST(WindowLoop, CountsTheUnconvergedWindowsBeforeAResume) {
  Listener listener;
  listener.longest_at = [](double) { return 0.02; };
  Archive archive;
  LoopState{.time = 0.4, .windows = 4, .unconverged = 3}.save(archive);
  WindowLoop loop(listener, WindowLoop::Side::fluid,
                  {.end = 1.0,
                   .window = 0.1,
                   .output_every = 0,
                   .start = LoopState::from(archive),
                   .control = {.smallest = 0.03},
                   .if_halving_failed = "advice"});
  try {
    loop.next();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fix().substr(0, error.fix().find('\n')),
              "3 of 4 windows before it were accepted unconverged: advice");
  }
  archive.integer["loop.windows"].pop_back();  // of a checkpoint without this count
  EXPECT_EQ(LoopState::from(archive).unconverged, 0);
}

TEST(WindowLoop, GivesUpWhenWindowsShrinkWithoutEnd) {
  Listener listener;
  listener.limit = 1e-12;
  WindowLoop loop(listener, WindowLoop::Side::structure, {.end = 1.0, .window = 0.1, .output_every = 0});
  loop.next();
  try {
    loop.next();
    FAIL() << "a window of 1e-12 s was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::solver_fault);
  }
}

}  // namespace window_loop_test
}  // namespace strake
