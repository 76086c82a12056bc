// Real processes over ipc that die, freeze, lie or never speak. A step lasts 5 s: an earlier end was detected
// inside the step. Times are printed, not judged.

#include "coupler/participant/stop_request.hpp"
#include "coupler/transport/system_calls.hpp"
#include "tests/system/faults.hpp"

#include <unistd.h>

namespace strake {
namespace fault_test {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

TEST_F(Faults, TwoProcessesRunWindowsWithRewindsAndEndInOrder) {
  launch("structure", "");
  launch("fluid", "");
  RemoteParticipant& structure = participants().connect("structure", {});
  strake::Setup setup;
  setup.partner_mesh = structure.mesh();
  setup.partner_initial = structure.description().initial;
  RemoteParticipant& fluid = participants().connect("fluid", setup);
  for (int window = 0; window < 3; ++window) {
    for (RemoteParticipant* p : {&fluid, &structure}) p->advance({0.1 * window, 0.1}, {});
    for (RemoteParticipant* p : {&fluid, &structure}) p->rewind();
    for (RemoteParticipant* p : {&fluid, &structure}) {
      const Advanced a = p->advance({0.1 * window, 0.1}, {});
      EXPECT_EQ(a.output.at(0).value, Eigen::MatrixXd::Constant(3, 3, window));
      EXPECT_EQ(a.monitor.at("iteration"), 2);
    }
    for (RemoteParticipant* p : {&fluid, &structure}) p->commit(window == 2);
  }
  participants().finish();
  for (const char* name : {"fluid", "structure"}) {
    EXPECT_EQ(count(content(log(name)), "rewind"), 3u);
    EXPECT_NE(content(log(name)).find("commit 3 and write"), std::string::npos)
        << "the last commit rides on Stop";
  }
  participants_.reset();
}

TEST_F(Faults, ACheckpointHoldsTheLastCommitAndResumesInANewProcess) {
  launch("structure", "");
  RemoteParticipant& first = participants().connect("structure", {});
  for (int window = 0; window < 2; ++window) {
    first.advance({0.1 * window, 0.1}, {});
    first.commit(false);
  }
  first.checkpoint(folder_.path());
  participants().finish();
  participants_.reset();
  launch("structure", "");
  RemoteParticipant& second = participants().connect("structure", {});
  second.resume(folder_.path());
  EXPECT_EQ(second.advance({0.2, 0.1}, {}).output.at(0).value(0, 0), 2);
  participants().finish();
  participants_.reset();
}

TEST_F(Faults, AnAnswerToStopThatLiesBehindAnotherWordIsStillARegularEnd) {
  bool waited = false;
  options_.on_wait = [&](const Awaited& whom) {
    if (waited || whom.doing != "writing") return;
    waited = true;  // the coupler is busy while the participant says its last words and ends
    std::this_thread::sleep_for(milliseconds(500));
  };
  launch("structure", "talkative");
  participants().connect("structure", {});
  EXPECT_NO_THROW(participants().finish());
  EXPECT_TRUE(waited);
  EXPECT_EQ(said_, "");
  participants_.reset();
}

TEST_F(Faults, AKilledParticipantIsNamedInsideItsStepWithWindowAndTime) {
  launch("structure", "sleep", 2);
  launch("fluid", "");
  RemoteParticipant& structure = participants().connect("structure", {});
  RemoteParticipant& fluid = participants().connect("fluid", {});
  std::thread killer = signal_inside_step("structure", SIGKILL);
  const Error e = error_of([&] {
    for (int window = 0; window < 2; ++window)
      for (RemoteParticipant* p : {&fluid, &structure}) {
        p->advance({0.25 * window, 0.25}, {});
        if (window == 0) p->commit(false);
      }
  });
  killer.join();
  report_delay();
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_EQ(e.where(), "structure, window 2 (t = 0.25 s), iteration 1");
  EXPECT_NE(e.problem().find("was killed by signal 9 (Killed) while Advance was awaited"), std::string::npos);
  EXPECT_NE(e.fix().find("structure.log"), std::string::npos);
  EXPECT_EQ(content(log("structure")).find("step ends"), std::string::npos);
  EXPECT_EQ(content(log("fluid")).find("SIGTERM"), std::string::npos)
      << "an idle participant is told to stop";
}

TEST_F(Faults, ADeadPartnerIsNamedWhileAnotherParticipantIsAwaited) {
  launch("structure", "");
  launch("fluid", "sleep");
  RemoteParticipant& structure = participants().connect("structure", {});
  RemoteParticipant& fluid = participants().connect("fluid", {});
  std::thread killer([this] {
    wait_for(log("fluid"), "step begins");
    signalled_ = steady_clock::now();
    kill(pid_of("structure"), SIGKILL);
  });
  const Error e = error_of([&] {
    structure.advance({0, 0.1}, {});
    structure.commit(false);
    fluid.advance({0, 0.1}, {});
  });
  killer.join();
  report_delay();
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_EQ(e.where(), "structure, after window 1 (t = 0.1 s)");
  EXPECT_NE(e.problem().find("signal 9"), std::string::npos);
  EXPECT_NE(content(log("fluid")).find("ended by SIGTERM"), std::string::npos)
      << "a busy participant is terminated";
}

TEST_F(Faults, AFrozenParticipantIsWaitedForThenGivenUp) {
  options_.deadlines.frozen_after = std::chrono::seconds(2);
  launch("structure", "sleep");
  RemoteParticipant& structure = participants().connect("structure", {});
  std::thread freezer = signal_inside_step("structure", SIGSTOP);
  const Error e = error_of([&] { structure.advance({0, 0.1}, {}); });
  freezer.join();
  report_delay();
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_EQ(count(said_, "no heartbeat"), 1u) << said_;
  EXPECT_NE(said_.find("is suspended"), std::string::npos) << said_;
  EXPECT_NE(e.problem().find("no heartbeat for "), std::string::npos);
  EXPECT_NE(e.fix().find("coupling.frozen_after"), std::string::npos);
}

// A process that gets no processor for a second, twice within a step of three. Heartbeats end both of its
// connections. Neither silence is as long as frozen_after, and both together are longer.
TEST_F(Faults, AStarvedParticipantIsNotTakenForFrozen) {
  options_.deadlines.frozen_after = std::chrono::seconds(2);
  launch("structure", "nap");
  RemoteParticipant& structure = participants().connect("structure", {});
  std::thread starver([this] {
    wait_for(log("structure"), "step begins");
    for (int k = 0; k < 2; ++k) {
      kill(pid_of("structure"), SIGSTOP);
      std::this_thread::sleep_for(milliseconds(1100));
      kill(pid_of("structure"), SIGCONT);
      std::this_thread::sleep_for(milliseconds(600));
    }
  });
  EXPECT_NO_THROW(structure.advance({0, 0.1}, {}));
  starver.join();
  EXPECT_EQ(count(said_, "is back after"), 1u) << said_;
  participants().finish();
  participants_.reset();
}

TEST_F(Faults, AThawedParticipantGoesOnWhereItWas) {
  launch("structure", "nap", 2);
  RemoteParticipant& structure = participants().connect("structure", {});
  std::thread thawer([this] {
    wait_for(log("structure"), "step begins");
    kill(pid_of("structure"), SIGSTOP);
    std::this_thread::sleep_for(milliseconds(1600));
    kill(pid_of("structure"), SIGCONT);
  });
  for (int window = 0; window < 3; ++window) {
    EXPECT_EQ(structure.advance({0.1 * window, 0.1}, {}).output.at(0).value(0, 0), window);
    structure.commit(false);
  }
  thawer.join();
  participants().finish();
  participants_.reset();
  EXPECT_NE(said_.find("no heartbeat"), std::string::npos) << said_;
  EXPECT_NE(said_.find("is back"), std::string::npos) << said_;
  EXPECT_EQ(count(content(log("structure")), "commit"), 3u);
}

TEST_F(Faults, AProgramThatNeverSpeaksIsGivenUpWithTheNameOfItsLog) {
  options_.deadlines.hello = milliseconds(300);
  launch("structure", "mute");
  const Error e = error_of([&] { participants().connect("structure", {}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_EQ(e.where(), "structure");
  EXPECT_NE(e.problem().find("has not said Hello"), std::string::npos);
  EXPECT_NE(e.fix().find(log("structure").string()), std::string::npos);
}

TEST_F(Faults, AProgramThatEndsBeforeHelloSpeaksByItsExitCodeAndLog) {
  launch("structure", "early");
  const Error e = error_of([&] { participants().connect("structure", {}); });
  EXPECT_EQ(e.code(), ExitCode::case_file);
  EXPECT_NE(e.problem().find("exited with code 3 before it said Hello"), std::string::npos);
  EXPECT_NE(e.problem().find("toy.toml:3:1: young = 0"), std::string::npos);
}

// It ends without a word, and without a rank.
TEST_F(Faults, ALauncherThatStartsNothingIsNamedByItsKey) {
  Launch launch{"/bin/true", {}, log("fluid"), 1, {}};
  launch.launcher = "fluid.launcher = \"true\"";
  participants().launch("fluid", launch);
  const Error e = error_of([&] { participants().connect("fluid", {}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(e.problem().find("exited with code 0 before it said Hello"), std::string::npos);
  EXPECT_EQ(e.fix().find("fluid.launcher = \"true\" must start the ranks"), 0u) << e.fix();
}

TEST_F(Faults, ALauncherThatNeverStartsARankIsNamedByItsKey) {
  options_.deadlines.hello = milliseconds(300);
  Launch launch{"/bin/sleep", {}, log("fluid"), 1, {}};
  launch.own_command_line = true;
  launch.arguments = {"60"};
  launch.launcher = "fluid.launcher = \"sleep 60\"";
  participants().launch("fluid", launch);
  const Error e = error_of([&] { participants().connect("fluid", {}); });
  EXPECT_EQ(e.fix().find("fluid.launcher = \"sleep 60\" must start the ranks"), 0u) << e.fix();
}

// The other ranks wait for it in the start of MPI.
TEST_F(Faults, ARankThatIsStoppedBeforeHelloEndsTheRun) {
  Launch launch{"/bin/sh", {"-c", "sleep 60 & echo process $!; wait"}, log("fluid"), 1, {}};
  launch.own_command_line = true;
  launch.launcher = "fluid.launcher = \"mpirun -n {ranks}\"";
  participants().launch("fluid", launch);
  wait_for(log("fluid"), "process ");
  const pid_t rank = pid_of("fluid");
  signalled_ = steady_clock::now();
  kill(rank, SIGSTOP);
  const Error e = error_of([&] { participants().connect("fluid", {}); });
  report_delay();
  EXPECT_GE(delay(), 2.5) << "a short stop is waited for";
  EXPECT_LT(delay(), 10.0);
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(e.problem().find(fmt::format("is stopped (process {})", rank)), std::string::npos);
  EXPECT_FALSE(runs(rank));
}

TEST_F(Faults, AParticipantWithAnotherCaseIsRefused) {
  launch("structure", "hash");
  const Error e = error_of([&] { participants().connect("structure", {}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(said_.find("another case"), std::string::npos) << said_;
  EXPECT_NE(e.problem().find("was refused: structure has read another case"), std::string::npos);
  EXPECT_NE(content(log("structure")).find("the coupler refused this participant"), std::string::npos);
}

TEST_F(Faults, ACrashIsNamedByItsSignal) {
  launch("structure", "crash");
  RemoteParticipant& structure = participants().connect("structure", {});
  const Error e = error_of([&] { structure.advance({0, 0.1}, {}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(e.problem().find("was killed by signal 6 (Aborted)"), std::string::npos);
}

TEST_F(Faults, AnExitInsideAStepIsNamedByItsCode) {
  launch("structure", "exit");
  RemoteParticipant& structure = participants().connect("structure", {});
  const Error e = error_of([&] { structure.advance({0, 0.1}, {}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(e.problem().find("exited with code 7 while Advance was awaited"), std::string::npos);
}

TEST_F(Faults, ASolversOwnErrorArrivesWithPlaceProblemAndFix) {
  launch("fluid", "error");
  RemoteParticipant& fluid = participants().connect("fluid", {});
  const Error e = error_of([&] { fluid.advance({0.5, 0.1}, {}); });
  EXPECT_EQ(e.code(), ExitCode::solver_fault);
  EXPECT_EQ(e.where(), "fluid, window 1 (t = 0.5 s), iteration 1, toy");
  EXPECT_EQ(e.problem(), "pressure did not converge\n500 iterations");
  EXPECT_EQ(e.fix(), "lower fluid.scheme.cfl");
  EXPECT_NE(content(log("fluid")).find("pressure did not converge"), std::string::npos);
}

TEST_F(Faults, AValueThatIsNotFiniteIsASolverFault) {
  launch("structure", "nan");
  RemoteParticipant& structure = participants().connect("structure", {});
  const Error e = error_of([&] { structure.advance({0, 0.1}, {}); });
  EXPECT_EQ(e.code(), ExitCode::solver_fault);
  EXPECT_NE(e.problem().find("displacement is not finite: nan m at point 2 of 3, component 1"),
            std::string::npos);
}

TEST_F(Faults, AFieldThatDoesNotFitTheMeshIsRefused) {
  launch("structure", "size");
  RemoteParticipant& structure = participants().connect("structure", {});
  const Error e = error_of([&] { structure.advance({0, 0.1}, {}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_EQ(e.problem(), "sent displacement at 2 points, its mesh has 3");
}

TEST_F(Faults, AKilledParticipantThatWasStartedByHandIsNamedWithinASecond) {
  for (const char* endpoint : {"tcp://127.0.0.1:*", ""}) {
    options_.endpoint = endpoint;
    Child structure = by_hand("structure", "sleep");
    RemoteParticipant& participant = participants().connect("structure", {});
    std::thread killer = signal_inside_step("structure", SIGKILL);
    const Error e = error_of([&] { participant.advance({0, 0.1}, {}); });
    killer.join();
    report_delay();
    EXPECT_EQ(e.code(), ExitCode::participant_lost);
    EXPECT_NE(e.problem().find("its connection was closed at the other end while Advance was awaited"),
              std::string::npos);
    fs::remove(log("structure"));
  }
}

TEST_F(Faults, AFrozenParticipantThatWasStartedByHandIsNotTakenForDead) {
  options_.deadlines.frozen_after = std::chrono::seconds(2);
  Child structure = by_hand("structure", "sleep");
  RemoteParticipant& participant = participants().connect("structure", {});
  std::thread freezer = signal_inside_step("structure", SIGSTOP);
  const Error e = error_of([&] { participant.advance({0, 0.1}, {}); });
  freezer.join();
  EXPECT_GE(delay(), 2.0);
  EXPECT_NE(e.problem().find("is frozen or cannot be reached: no heartbeat for "), std::string::npos);
}

/// A run folder that a machine does not have, or may not write into. /proc takes no file, not even of root.
class RunFolderElsewhere : public Faults, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(, RunFolderElsewhere, testing::Values("/nowhere/runs/plate_entry", "/proc"));

TEST_P(RunFolderElsewhere, IsNamedWithTheMachineByOneThatWasStartedByHand) {
  Child structure = by_hand("structure", "");
  strake::Setup setup;
  setup.run_folder = GetParam();
  const Error e = error_of([&] { participants().connect("structure", setup); });
  EXPECT_EQ(e.code(), ExitCode::cannot_write);
  EXPECT_EQ(e.where(), GetParam());
  EXPECT_TRUE(e.problem().ends_with("\non the machine " + host_name())) << e.problem();
  EXPECT_NE(e.fix().find("--runs DIR"), std::string::npos);
}

TEST_F(Faults, AParticipantStartedByHandEndsWithItsCoupler) {
  Child structure = by_hand("structure", "sleep");
  participants().connect("structure", {}).start({0, 0.1}, {});
  wait_for(log("structure"), "step begins");
  signalled_ = steady_clock::now();
  participants_.reset();  // the coupler is gone, without a word to one that is busy
  const auto exit = structure.wait(std::chrono::seconds(30));
  ASSERT_TRUE(exit);
  report_delay();
  EXPECT_EQ(exit->code, static_cast<int>(ExitCode::participant_lost));
  EXPECT_NE(content(log("structure")).find("the coupler is gone"), std::string::npos);
}

TEST_F(Faults, CtrlCInsideALongStepEndsTheRun) {
  const StopRequest stop;
  options_.stop = &stop;
  options_.deadlines.grace = milliseconds(200);
  launch("structure", "sleep");
  RemoteParticipant& structure = participants().connect("structure", {});
  std::thread user([this] {
    wait_for(log("structure"), "step begins");
    signalled_ = steady_clock::now();
    kill(getpid(), SIGINT);
  });
  const Error e = error_of([&] { structure.advance({0, 0.1}, {}); });
  user.join();
  report_delay();
  EXPECT_EQ(e.code(), ExitCode::interrupted);
}

}  // namespace fault_test
}  // namespace strake
