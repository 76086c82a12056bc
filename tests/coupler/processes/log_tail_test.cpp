#include "coupler/processes/log_tail.hpp"

#include "coupler/participant/launch.hpp"
#include "coupler/participant/long_log.hpp"
#include "tests/proto/temporary_folder.hpp"
#include "tests/text/golden.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace strake {
namespace log_tail_test {

void say(const std::string& words, const std::filesystem::path& log, bool keep) {
  Child child({"/bin/sh", {"-c", "echo " + words}, log, 1, {}, keep});
  ASSERT_TRUE(child.wait(std::chrono::seconds(10)));
}

TEST(LogTail, IsOfTheRunSinceTheLastResumeAndKeepsWhatStandsBefore) {
  const TemporaryFolder place;
  const auto log = place / "fluid.log";
  say("forgotten", log, false);
  say("before", log, false);
  EXPECT_EQ(log_tail(log), "\nfluid.log: before");
  note_resume(log, 421);
  EXPECT_EQ(log_tail(log), "");
  say("after", log, true);
  EXPECT_EQ(log_tail(log), "\nfluid.log: after");
  EXPECT_TRUE(
      matches(content(log),
              R"(before\n\[\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3}\] \[info\] resumed at window 421\nafter\n)"))
      << content(log);
}

TEST(LogTail, SaysWhatToInstallWhereAModuleOfPythonIsMissing) {
  const TemporaryFolder place;
  const auto log = place / "structure.log";
  std::ofstream(log)
      << "Traceback:\n    import zmq.utils\nModuleNotFoundError: No module named 'zmq.utils'\n";
  EXPECT_EQ(missing_module(log),
            "its Python has no module zmq.utils: the program's first line (#!) chooses which "
            "Python that is; #!/usr/bin/python3 is Debian's, with zmq from python3-zmq; ");
  std::ofstream(log) << "ModuleNotFoundError: No module named 'strake'\n";
  EXPECT_EQ(missing_module(log),
            "its Python has no module strake: the program's first line (#!) chooses which Python that is; ");
  std::ofstream(log) << "ValueError: No module\n";
  EXPECT_EQ(missing_module(log), "");
}

TEST(LogTail, HoldsTheLastThreeLinesThatAreNoMereInformation) {
  const TemporaryFolder place;
  const auto log = place / "fluid.log";
  std::ofstream(log) << "one\ntwo\n\nthree\n[2026-01-01 00:00:00.000] [info] step 7\nfour\n";
  EXPECT_EQ(log_tail(log), "\nfluid.log: two\nfluid.log: three\nfluid.log: four");
  EXPECT_EQ(log_tail(place / "none.log"), "");
}

TEST(LogTail, LeavesOutTheRulesThatALauncherDraws) {
  const TemporaryFolder place;
  const auto log = place / "fluid.log";
  std::ofstream(log) << "why\n--------\nprocess 1 exited\non signal 9\n--------\n";
  EXPECT_EQ(log_tail(log), "\nfluid.log: why\nfluid.log: process 1 exited\nfluid.log: on signal 9");
}

// A launcher prints more lines behind the one that says why.
TEST(LogTail, HoldsWhatARankHasSaidOfItsEnd) {
  const TemporaryFolder place;
  const auto log = place / "fluid.log";
  std::ofstream(log) << "rank one\nrank 1 of the fluid: is out of memory\none\ntwo\nthree\n";
  EXPECT_EQ(log_tail(log), "\nfluid.log: rank 1 of the fluid: is out of memory");
  EXPECT_TRUE(has_words_of_ranks(log));
  note_resume(log, 7);
  EXPECT_EQ(log_tail(log), "");
  EXPECT_FALSE(has_words_of_ranks(log));
}

/// A program that prints numbered lines until it is told to end.
constexpr const char* talker = "i=0; while [ $i -lt 40000 ]; do i=$((i+1)); echo line $i; done; echo why";

TEST(LogLength, KeepsTheFirstAndTheLastPartOfALongLog) {
  const TemporaryFolder place;
  const auto log = place / "structure.log";
  const LogBounds bounds{.most = 1 << 18, .first = 1 << 15, .last = 1 << 15};
  Child child({"/bin/sh", {"-c", talker}, log, 1, {}});
  ASSERT_TRUE(child.wait(std::chrono::seconds(60)));
  const std::string whole = content(log);
  ASSERT_GT(whole.size(), bounds.most);
  take_out_middle(log, bounds);
  const std::string text = content(log);
  EXPECT_LT(text.size(), bounds.first + bounds.last + 100);
  EXPECT_EQ(text.substr(0, bounds.first), whole.substr(0, bounds.first));
  EXPECT_TRUE(text.ends_with("\nline 39999\nline 40000\nwhy\n"));
  const Found found =
      find_expression(text, R"(\n\[strake: (\d+) bytes of the log are left out here\]\nline )");
  ASSERT_GT(found.length, 0U);
  const std::size_t left_out = std::stoul(found.in_brackets);
  EXPECT_EQ(text.size() - found.length + 5 + left_out, whole.size()) << "5: the next \"line \"";
  EXPECT_EQ(log_tail(log), "\nstructure.log: line 39999\nstructure.log: line 40000\nstructure.log: why");
  take_out_middle(log, bounds);
  EXPECT_EQ(content(log), text) << "of a log that is short enough nothing is taken out";
}

TEST(LogLength, FreesTheMiddleWhileTheProgramWrites) {
  const TemporaryFolder place;
  const auto log = place / "structure.log";
  const LogBounds bounds{.most = 1 << 18, .first = 1 << 15, .last = 1 << 15};
  Child child({"/bin/sh", {"-c", talker}, log, 1, {}});
  int freed = 0;
  while (!child.exit()) freed += free_middle(log, bounds) ? 1 : 0;
  freed += free_middle(log, bounds) ? 1 : 0;
  if (freed == 0) GTEST_SKIP() << "this file system frees no part of a file";
  EXPECT_NE(content(log).find("longer than 0 MB, its middle is left out here]\n"), std::string::npos);
  take_out_middle(log, bounds);
  const std::string text = content(log);
  EXPECT_LT(text.size(), bounds.first + bounds.last + 100);
  EXPECT_EQ(text.find('\0'), std::string::npos) << "nothing of the hole is left";
  EXPECT_TRUE(text.starts_with("line 1\nline 2\n"));
  // Every line of the last part is there.
  const std::size_t last = text.find("left out here]\nline ") + 20;
  int number = std::stoi(text.substr(last));
  std::istringstream lines(text.substr(text.find('\n', last) + 1));
  for (std::string line; std::getline(lines, line) && line != "why";)
    ASSERT_EQ(line, "line " + std::to_string(++number));
  EXPECT_EQ(number, 40000);
}

TEST(LogTail, CutsALineWithoutEnd) {
  const TemporaryFolder place;
  const auto log = place / "structure.log";
  std::ofstream(log) << std::string(100000, '.') << "why\n";
  EXPECT_LT(log_tail(log).size(), 3000U);
  EXPECT_TRUE(log_tail(log).ends_with("...why"));
}

}  // namespace log_tail_test
}  // namespace strake
