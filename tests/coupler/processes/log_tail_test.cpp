#include "coupler/processes/log_tail.hpp"

#include "coupler/participant/launch.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>

namespace strake {
namespace {

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
  const std::regex whole(
      R"(before\n\[\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3}\] \[info\] resumed at window 421\nafter\n)");
  EXPECT_TRUE(std::regex_match(content(log), whole)) << content(log);
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

}  // namespace
}  // namespace strake
