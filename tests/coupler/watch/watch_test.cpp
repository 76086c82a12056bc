// Reading a run's files while it goes on, and their display on a terminal.
#include "coupler/watch/run_status.hpp"
#include "coupler/watch/select_run.hpp"
#include "coupler/watch/table_tail.hpp"
#include "coupler/watch/text_view.hpp"
#include "proto/error.hpp"
#include "tests/coupler/watch/watch_files.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <sys/wait.h>
#include <unistd.h>

namespace strake::watch {
namespace watch_test {

TEST(TableTail, TakesALineOnceItIsWhole) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "history.csv";
  TableTail table(path);
  EXPECT_FALSE(table.update());
  EXPECT_EQ(table.rows(), 0U);
  put(path, "window [1],time");
  EXPECT_FALSE(table.update());
  put(path, " [s]\n1,0.5\n2,", true);
  EXPECT_TRUE(table.update());
  ASSERT_EQ(table.rows(), 1U);
  EXPECT_EQ(table.columns()[1].name, "time");
  EXPECT_EQ(table.columns()[1].unit, "s");
  put(path, "0.75\n3,\n", true);
  EXPECT_TRUE(table.update());
  ASSERT_EQ(table.rows(), 3U);
  EXPECT_EQ(table.value()[1][1], 0.75);
  EXPECT_TRUE(std::isnan(table.value()[1][2]));
  EXPECT_EQ(table.last("window"), 3);
  EXPECT_EQ(table.last("time"), std::nullopt);
  EXPECT_FALSE(table.update());
  EXPECT_EQ(table.generation(), 0U);
}

TEST(TableTail, BeginsAnewWhenTheFileWasCutOrReplaced) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "history.csv";
  put(path, "window [1],time [s]\n1,1\n2,2\n3,3\n");
  TableTail table(path);
  table.update();
  put(path, "window [1],time [s]\n1,1\n");  // a resume cuts
  EXPECT_TRUE(table.update());
  EXPECT_EQ(table.rows(), 1U);
  EXPECT_EQ(table.generation(), 1U);
  put(path, "window [1],time [s]\n1,1\n2,7\n3,8\n");  // grown, with what was read still in it
  EXPECT_TRUE(table.update());
  EXPECT_EQ(table.rows(), 3U);
  EXPECT_EQ(table.generation(), 1U);
  put(path, "window [1],time [s]\n1,1\n2,9\n3,9\n4,9\n");  // cut and grown beyond, between two looks
  EXPECT_TRUE(table.update());
  EXPECT_EQ(table.generation(), 2U);
  EXPECT_EQ(table.value()[1], (std::vector<double>{1, 9, 9, 9}));
  std::filesystem::remove(path);
  EXPECT_TRUE(table.update());
  EXPECT_EQ(table.rows(), 0U);
}

TEST(TableTail, LeavesOutDamagedLinesAndCountsThem) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "history.csv";
  put(path, "window [1],time [s]\n1,1\n2,\x01\x02\n3\n4,4,4\n5,5\n");
  TableTail table(path);
  table.update();
  EXPECT_EQ(table.value()[0], (std::vector<double>{1, 5}));
  EXPECT_EQ(table.damaged(), 3U);
}

TEST(TableTail, ReadsALineLongerThanWhatItReadsAtOnce) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "history.csv";
  put(path, "window [1],time [s]\n" + std::string(3 << 20, ' ') + "1,2\n");
  TableTail table(path);
  EXPECT_TRUE(table.update());
  EXPECT_EQ(table.rows(), 1U);
}

TEST(BraillePlot, DrawsARisingLineFromTheLowerLeftToTheUpperRight) {
  const BraillePlot curve = braille_plot({0, 1, 2, 3}, {0, 1, 2, 3}, 2, 1);
  ASSERT_EQ(curve.lines.size(), 1U);
  EXPECT_EQ(curve.lines[0], "⡠⠊");  // dots 7, 6 and 2, 4 of Unicode's patterns
  EXPECT_EQ(curve.lo, 0);
  EXPECT_EQ(curve.hi, 3);
}

TEST(BraillePlot, KeepsAPeakThatIsNarrowerThanADot) {
  std::vector<double> x, y;
  for (int k = 0; k < 1000; ++k) {
    x.push_back(k);
    y.push_back(k == 501 ? 1 : 0);
  }
  const BraillePlot curve = braille_plot(x, y, 10, 2);
  EXPECT_NE(curve.lines[0], std::string(30, ' '));
  int marked = 0;
  for (std::size_t k = 0; k < curve.lines[0].size(); k += 3)
    marked += curve.lines[0].substr(k, 3) != "⠀" ? 1 : 0;
  EXPECT_EQ(marked, 1);
}

TEST(BraillePlot, IsBlankWithoutData) {
  EXPECT_EQ(braille_plot({}, {}, 3, 2).lines, (std::vector<std::string>{"   ", "   "}));
  EXPECT_EQ(braille_plot({1}, {std::nan("")}, 3, 1).lines, std::vector<std::string>{"   "});
  EXPECT_EQ(shown_width(braille_plot({1}, {5}, 3, 1).lines[0]), 3U);
}

TEST(BraillePlot, ShowsDecadesOfAResidual) {
  const BraillePlot curve = braille_plot({0, 1, 2}, {1e-8, 0, 1e-4}, 4, 1, true);
  EXPECT_DOUBLE_EQ(curve.lo, 1e-8);
  EXPECT_DOUBLE_EQ(curve.hi, 1e-4);
}

TEST(WatchedRun, RefusesWhatIsNoRunFolder) {
  const TemporaryFolder folder;
  std::string fix;
  const auto told = [&fix](const std::filesystem::path& path) {
    try {
      const WatchedRun run(path);
    } catch (const Error& error) {
      fix = error.fix();
      return std::pair(error.code(), error.problem());
    }
    return std::pair(ExitCode::done, std::string());
  };
  EXPECT_EQ(told(folder.path() / "none"),
            std::pair(ExitCode::command_line, std::string("there is no such run folder")));
  put(folder.path() / "file", "x");
  EXPECT_EQ(told(folder.path() / "file").second, "is a file, not the folder of a run");
  put(folder.path() / "hull.toml", "x");
  told(folder.path() / "hull.toml");
  EXPECT_EQ(fix, "name the folder that `strake run` has made, e.g. runs/hull");
  put(folder.path() / "run.json", "{}");
  told(folder.path() / "hull.toml");
  EXPECT_EQ(fix, "name the folder that it lies in: " + folder.path().string());
  std::filesystem::remove(folder.path() / "run.json");
  EXPECT_EQ(told(folder.path()).second, "is not the folder of a run: it has no run.json");
}

State state_of(const RunFiles& files) {
  WatchedRun run(files.path());
  return run.update().state;
}

TEST(WatchedRun, TellsEndsApart) {
  const RunFiles files;
  files.windows(3);
  EXPECT_EQ(state_of(files), State::killed);  // no process runs it
  files.record("\"2025-11-21T02:01:40Z\"", "0");
  EXPECT_EQ(state_of(files), State::finished);
  files.record("\"2025-11-21T02:01:40Z\"", "130");
  EXPECT_EQ(state_of(files), State::stopped);
  files.record("\"2025-11-21T02:01:40Z\"", "4",
               ", \"error\": {\"where\": \"fluid, window 4\", \"problem\": \"pressure did not converge\", "
               "\"fix\": \"a smaller step\"}");
  WatchedRun run(files.path());
  const RunStatus& g = run.update();
  EXPECT_EQ(g.state, State::failed);
  EXPECT_EQ(g.error, "fluid, window 4: pressure did not converge\nfix: a smaller step");
  EXPECT_EQ(g.exit_code, 4);
  EXPECT_EQ(g.words, "failed after window 3 (t = 0.003 s), exit code 4");
  EXPECT_DOUBLE_EQ(g.elapsed, 100);
}

TEST(WatchedRun, TellsARunThatIsUnderWayByTheLockOfItsFolder) {
  const RunFiles files;
  // Another process, as in life: a lock does not stand in the way of its own file.
  int told[2] = {-1, -1}, release[2] = {-1, -1};
  ASSERT_EQ(pipe(told), 0);
  ASSERT_EQ(pipe(release), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(release[1]);
    const FolderLock lock(files.path());
    char byte = 1;
    if (write(told[1], &byte, 1) != 1) _exit(1);
    if (read(release[0], &byte, 1) != 0) _exit(1);
    _exit(0);
  }
  close(release[0]);
  char byte = 0;
  ASSERT_EQ(read(told[0], &byte, 1), 1);
  EXPECT_EQ(state_of(files), State::starting);
  files.windows(3);
  EXPECT_EQ(state_of(files), State::running);
  files.age(100);
  WatchedRun run(files.path());
  EXPECT_EQ(run.update().state, State::silent);
  EXPECT_EQ(run.last().words, "nothing written for 1 min 40 s, since window 3 (t = 0.003 s)");
  ASSERT_TRUE(run.last().left.has_value());
  EXPECT_DOUBLE_EQ(*run.last().left, 3.5);  // half a second a window, seven to go
  close(release[1]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(run.update().state, State::killed);
  for (const int end : {told[0], told[1]}) close(end);
}

TEST(WatchedRun, CannotTellWhetherARunOnAnotherMachineLives) {
  const RunFiles files;
  files.windows(3);
  files.record("null", "null", "", "elsewhere.example");
  EXPECT_EQ(state_of(files), State::running);
  files.age(60);
  EXPECT_EQ(state_of(files), State::away);
}

TEST(WatchedRun, DoesNotMindHalfWrittenFiles) {
  const RunFiles files;
  put(files.path() / "run.json", "{\"ended\": ");
  put(files.path() / "case.toml", "title = \"a pla");
  put(files.path() / "history.csv", "window [1],ti");
  WatchedRun run(files.path());
  EXPECT_EQ(run.update().state, State::killed);
  EXPECT_EQ(run.title(), "plate");
  EXPECT_FALSE(screen_lines(run, {}).empty());
}

TEST(WatchedRun, TheNewestIsTheOneWrittenToLast) {
  const RunFiles files;
  files.age(100);
  const auto other = files.runs() / "study" / "one";
  std::filesystem::create_directories(other);
  put(other / "run.json", "{}");
  EXPECT_EQ(newest_run(files.runs()), other);
  std::filesystem::remove_all(files.runs() / "study");
  EXPECT_EQ(newest_run(files.runs()), files.path());
  EXPECT_THROW(newest_run(files.runs() / "none"), Error);
}

TEST(ScreenLines, FitTheTerminalWhateverItsSize) {
  const RunFiles files;
  files.windows(8);
  WatchedRun run(files.path());
  run.update();
  for (const int width : {40, 80, 100, 211})
    for (const int height : {8, 24, 60}) {
      const auto lines = screen_lines(run, {.width = width, .height = height});
      EXPECT_LE(lines.size(), static_cast<std::size_t>(height));
      for (const std::string& line : lines) {
        EXPECT_LE(shown_width(line), static_cast<std::size_t>(width)) << line;
        EXPECT_TRUE(std::none_of(line.begin(), line.end(), [](char c) { return c > 0 && c < 0x20; })) << line;
      }
    }
}

TEST(ScreenLines, HoldStateProgressValuesAndStages) {
  const RunFiles files;
  files.windows(8);
  WatchedRun run(files.path());
  run.update();
  std::string text;
  for (const std::string& line : screen_lines(run, {.width = 120, .height = 30})) text += line + "\n";
  for (const char* part : {"a plate", "killed", "window 8   t 8 ms of 10 ms", " 80.0 %", "mid.y  -756.8 µm",
                           "largest 997.5 µm at 3 ms", "fluid.pressure 60 %", "structure.step 20 %",
                           "exchange and the rest 20 %", "coupling   2 iterations   residual 1.0e-09 m"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

TEST(PlainLines, AreOneTableWithoutControlCharacters) {
  const RunFiles files;
  WatchedRun run(files.path());
  const auto path = files.runs() / "out";
  std::FILE* out = std::fopen(path.c_str(), "w");
  PlainLines lines(out);
  run.update();
  lines.begin(run);
  files.windows(2);
  run.update();
  lines.more(run);
  lines.more(run);  // nothing new: no line
  files.more_windows(3);
  files.record("\"2025-11-21T02:01:40Z\"", "0");
  run.update();
  lines.end(run);
  std::fclose(out);
  std::ifstream in(path);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  EXPECT_EQ(text.find('\033'), std::string::npos);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 0);
  const auto count = [&](const std::string& part) {
    int n = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("window       t [s]"), 1) << text;
  EXPECT_EQ(count("       2    0.002000            2         1e-09   0.00084147"), 1) << text;
  EXPECT_EQ(count("       3    0.003000"), 1) << text;
  EXPECT_EQ(count("finished  window 3   t 3 ms of 10 ms   1 min 40 s"), 1) << text;
  EXPECT_EQ(count("largest 997.5 µm at 3 ms"), 1) << text;
}

}  // namespace watch_test
}  // namespace strake::watch
