#include "coupler/participant/launch.hpp"

#include "proto/error.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace strake {
namespace launch_test {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

class Launching : public testing::Test {
 protected:
  void TearDown() override { EXPECT_LT(waitpid(-1, nullptr, WNOHANG), 0) << "a process is left behind"; }
  Launch shell(const std::string& script) const {
    return {"/bin/sh", {"-c", script}, folder_ / "log", 3, {}};
  }
  std::string log() const { return content(folder_ / "log"); }
  TemporaryFolder folder_;
};

TEST_F(Launching, OutputErrorsAndEnvironmentReachTheProgramAndItsLog) {
  Launch launch = shell("echo out $OMP_NUM_THREADS $OMP_WAIT_POLICY $WORD; echo err >&2; exit 3");
  launch.environment["WORD"] = "token";
  Child child(launch);
  const auto exit = child.wait(std::chrono::seconds(5));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 3);
  EXPECT_EQ(to_text(*exit), "exited with code 3");
  EXPECT_EQ(log(), "out 3 passive token\nerr\n");
}

TEST_F(Launching, AProgramThatDoesNotExistIsAnErrorAtOnce) {
  try {
    Child child({folder_ / "none", {}, {}, 1, {}});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::participant_lost);
    EXPECT_NE(e.problem().find("cannot be started"), std::string::npos);
  }
}

TEST_F(Launching, AScriptWithoutAnInterpreterIsToldOfItsFirstLine) {
  const std::filesystem::path script = folder_ / "solver.py";
  for (const char* first_line : {"", "#!/usr/bin/pythn3\n"}) {
    std::ofstream(script) << first_line << "print('hello')\n";
    std::filesystem::permissions(script, std::filesystem::perms::owner_all);
    try {
      Child child({script, {}, {}, 1, {}});
      ADD_FAILURE() << first_line;
    } catch (const Error& e) {
      EXPECT_NE(e.fix().find("#!/usr/bin/python3"), std::string::npos) << e.problem();
    }
  }
}

TEST_F(Launching, TheDestructorEndsAProgramThatIgnoresSigterm) {
  pid_t pid = 0;
  {
    Child child(shell("trap '' TERM; echo ready; while :; do sleep 0.01; done"));
    pid = child.pid();
    while (log().empty()) usleep(1000);
    child.end(milliseconds(50));
    EXPECT_EQ(child.exit()->signal, SIGKILL);
    EXPECT_EQ(to_text(*child.exit()), "was killed by signal 9 (Killed)");
  }
  EXPECT_NE(kill(pid, 0), 0);
  end_orphans();  // the sleep that the shell had started
}

TEST_F(Launching, ASuspendedProgramIsRecognisedAndEnds) {
  // Uses exec: a shell that has just started a program waits for it inside the kernel and cannot be stopped.
  Child child(shell("exec sleep 30"));
  child.signal(SIGSTOP);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (!child.stopped() && std::chrono::steady_clock::now() < deadline) usleep(1000);
  EXPECT_TRUE(child.stopped());
  child.end(milliseconds(2000));
  EXPECT_EQ(child.exit()->signal, SIGTERM);
  end_orphans();
}

TEST_F(Launching, WhatAProgramLeavesBehindIsEnded) {
  Child child(shell("setsid sleep 30 & echo $!"));
  ASSERT_TRUE(child.wait(std::chrono::seconds(5)));
  const pid_t orphan = static_cast<pid_t>(std::stol(log()));
  EXPECT_EQ(kill(orphan, 0), 0);
  end_orphans();
  EXPECT_NE(kill(orphan, 0), 0);
}

// `bash -c 'sleep 3333 & exec strake run …'`: the sleep is a child of the program that takes the shell's
// place.
TEST_F(Launching, WhatNoProgramOfOursStartedIsLeftAlone) {
  Child child(shell("true"));  // from here on this process is the parent of orphans
  ASSERT_TRUE(child.wait(std::chrono::seconds(5)));
  const std::string file = (folder_ / "orphan").string(),
                    script = "setsid sleep 30 & echo $! >" + file + "; exec sleep 30";
  const pid_t stranger = fork();
  if (stranger == 0) {
    execl("/bin/sh", "sh", "-c", script.c_str(), nullptr);
    _exit(127);
  }
  while (!fs::exists(file) || content(file).find('\n') == std::string::npos) usleep(1000);
  const pid_t orphan = static_cast<pid_t>(std::stol(content(file)));
  end_orphans();
  EXPECT_EQ(waitpid(stranger, nullptr, WNOHANG), 0) << "it was ended or reaped";
  kill(stranger, SIGKILL);
  EXPECT_EQ(waitpid(stranger, nullptr, 0), stranger);
  end_orphans();  // what the stranger had started came to this process
  EXPECT_EQ(waitpid(orphan, nullptr, WNOHANG), 0) << "it was ended or reaped";
  kill(orphan, SIGKILL);
  EXPECT_EQ(waitpid(orphan, nullptr, 0), orphan);
}

TEST_F(Launching, CaptureReturnsBothStreamsAndTheCode) {
  const Captured c = capture("/bin/sh", {"-c", "echo out; echo err >&2; exit 3"});
  EXPECT_EQ(c.out, "out\n");
  EXPECT_EQ(c.err, "err\n");
  EXPECT_EQ(c.exit_code, 3);
  EXPECT_EQ(capture("/bin/sh", {"-c", "kill -9 $$"}).exit_code, 137);
}

TEST_F(Launching, CaptureTakesMoreThanAPipeHolds) {
  const Captured c = capture("/bin/sh", {"-c", "head -c 1000000 /dev/zero; head -c 1000000 /dev/zero >&2"});
  EXPECT_EQ(c.out.size(), 1'000'000u);
  EXPECT_EQ(c.err.size(), 1'000'000u);
}

TEST_F(Launching, CaptureEndsAProgramThatTakesTooLong) {
  try {
    capture("/bin/sh", {"-c", "sleep 30"}, milliseconds(100));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::participant_lost);
    EXPECT_EQ(e.where(), "sh -c sleep 30");
    EXPECT_EQ(e.problem(), "has not ended within 0.1 s");
  }
  end_orphans();
}

TEST_F(Launching, TheProgramForWiderVectorsIsTakenWhereThereIsOne) {
  const fs::path narrow = folder_ / "bin" / "solver", wide = folder_ / "lib/strake/x86-64-v3" / "solver";
  EXPECT_TRUE(wide_program(narrow).empty());
  fs::create_directories(wide.parent_path());
  put(wide, "#!/bin/sh\n");
  EXPECT_TRUE(wide_program(narrow).empty()) << "it cannot be executed";
  fs::permissions(wide, fs::perms::owner_all);
  const fs::path taken = wide_program(narrow);
  EXPECT_TRUE(taken == wide || taken.empty()) << "by the processor";
  setenv("STRAKE_VECTORS", "narrow", 1);
  EXPECT_TRUE(wide_program(narrow).empty());
  setenv("STRAKE_VECTORS", "wide", 1);
  EXPECT_EQ(wide_program(narrow), taken);
  unsetenv("STRAKE_VECTORS");
}

TEST_F(Launching, ProgramsAreFoundBesideTheRunningOneThenOnThePathThenByTheCase) {
  EXPECT_EQ(find_program("launch_test").filename(), "launch_test");
  EXPECT_EQ(find_program("sh").filename(), "sh");
  const fs::path own = folder_ / "mine";
  put(own, "#!/bin/sh\n");
  const auto refused = [&](const std::string& name, const std::string& why) {
    expect_refused([&] { find_program(name, folder_.path()); }, why);
  };
  refused("./mine", "cannot be executed");
  refused("./none", "does not exist");
  refused("no-such-program", "beside");
  fs::permissions(own, fs::perms::owner_all);
  EXPECT_EQ(find_program("./mine", folder_.path()), own);
}

TEST(Token, TwoTokensDifferAndHold128Bits) {
  EXPECT_EQ(random_token().size(), 32u);
  EXPECT_NE(random_token(), random_token());
}

}  // namespace launch_test
}  // namespace strake
