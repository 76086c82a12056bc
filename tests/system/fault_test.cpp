// Real processes over ipc that die, freeze, lie or never speak. A step lasts 5 s: whatever ends earlier was
// noticed inside it. Times are printed, not judged.

#include "coupler/launch.hpp"
#include "coupler/remote.hpp"
#include "coupler/stop_request.hpp"
#include "proto/error.hpp"
#include "tests/text/golden.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <thread>

namespace strake {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

std::string read(const fs::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

fs::path folder_of(const std::string& endpoint) {
  return fs::path(endpoint.substr(6)).parent_path();
}

/// Whether the process exists; a zombie has ended.
bool runs(pid_t pid) {
  const std::string stat = read(fmt::format("/proc/{}/stat", pid));
  const std::size_t name_end = stat.rfind(')');
  return name_end != std::string::npos && stat[name_end + 2] != 'Z';
}

class Faults : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "fault_test-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    options_.say = [this](const std::string& line) { said_ += line + "\n"; };
    options_.case_hash.fill(0x2a);
  }
  void TearDown() override {
    EXPECT_FALSE(fs::exists(folder_of(endpoint_))) << "the socket's folder is left behind";
    EXPECT_NE(waitpid(-1, nullptr, WNOHANG), 0) << "a process is left behind";
    fs::remove_all(folder_);
  }

  Roster& roster() {
    if (!roster_) {
      roster_ = std::make_unique<Roster>(options_);
      endpoint_ = roster_->endpoint();
    }
    return *roster_;
  }
  fs::path log(const std::string& name) const { return folder_ / (name + ".log"); }
  void launch(const std::string& name, const std::string& fault, int at = 1) {
    roster().launch(name, {fs::path(STRAKE_TOYS) / "toy_participant",
                           {"--fault", fault, "--at", std::to_string(at)},
                           log(name),
                           1,
                           {}});
  }
  pid_t pid_of(const std::string& name) const {
    const std::string text = read(log(name));
    const std::size_t at = text.find("process ");
    return at == std::string::npos ? 0 : static_cast<pid_t>(std::stol(text.substr(at + 8)));
  }
  void wait_for(const fs::path& file, const std::string& text) const {
    for (int i = 0; i < 1000 && read(file).find(text) == std::string::npos; ++i)
      std::this_thread::sleep_for(milliseconds(5));
  }
  /// The error that `act` ends with; the coupler's work is over when this returns, everything is ended.
  Error error_of(const std::function<void()>& act) {
    std::optional<Error> error;
    try {
      act();
    } catch (const Error& e) {
      error = e;
    }
    roster_.reset();
    if (!error) {
      ADD_FAILURE() << "no error";
      return {ExitCode::done, "", ""};
    }
    fmt::print("{}{}", said_, to_text(*error));
    expect_stored("faults.txt", this_test(), without_chance(said_ + to_text(*error), folder_.string()));
    return *error;
  }
  /// Sends a signal to a participant once it is inside its step.
  std::thread signal_inside_step(const std::string& name, int number) {
    return std::thread([this, name, number] {
      wait_for(log(name), "step begins");
      signalled_ = steady_clock::now();
      kill(pid_of(name), number);
    });
  }
  void report_delay() const {
    const double delay = std::chrono::duration<double>(steady_clock::now() - signalled_).count();
    fmt::print("{:.3f} s after the signal\n", delay);
    RecordProperty("seconds_after_the_signal", fmt::format("{:.3f}", delay));
  }

  Roster::Options options_;
  fs::path folder_;
  std::string said_, endpoint_;
  std::unique_ptr<Roster> roster_;
  steady_clock::time_point signalled_;
};

TEST_F(Faults, TwoProcessesRunWindowsWithRewindsAndEndInOrder) {
  launch("structure", "");
  launch("fluid", "");
  RemoteParticipant& structure = roster().connect("structure", {});
  strake::Setup setup;
  setup.partner_mesh = structure.mesh();
  setup.partner_initial = structure.description().initial;
  RemoteParticipant& fluid = roster().connect("fluid", setup);
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
  roster().finish();
  for (const char* name : {"fluid", "structure"}) {
    EXPECT_EQ(count(read(log(name)), "rewind"), 3u);
    EXPECT_NE(read(log(name)).find("commit 3 and write"), std::string::npos)
        << "the last commit rides on Stop";
  }
  roster_.reset();
}

TEST_F(Faults, ACheckpointHoldsTheLastCommitAndResumesInANewProcess) {
  launch("structure", "");
  RemoteParticipant& first = roster().connect("structure", {});
  for (int window = 0; window < 2; ++window) {
    first.advance({0.1 * window, 0.1}, {});
    first.commit(false);
  }
  first.checkpoint(folder_);
  roster().finish();
  roster_.reset();
  launch("structure", "");
  RemoteParticipant& second = roster().connect("structure", {});
  second.resume(folder_);
  EXPECT_EQ(second.advance({0.2, 0.1}, {}).output.at(0).value(0, 0), 2);
  roster().finish();
  roster_.reset();
}

TEST_F(Faults, AKilledParticipantIsNamedInsideItsStepWithWindowAndTime) {
  launch("structure", "sleep", 2);
  launch("fluid", "");
  RemoteParticipant& structure = roster().connect("structure", {});
  RemoteParticipant& fluid = roster().connect("fluid", {});
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
  EXPECT_EQ(read(log("structure")).find("step ends"), std::string::npos);
  EXPECT_EQ(read(log("fluid")).find("SIGTERM"), std::string::npos) << "an idle participant is told to stop";
}

TEST_F(Faults, ADeadPartnerIsNamedWhileAnotherParticipantIsAwaited) {
  launch("structure", "");
  launch("fluid", "sleep");
  RemoteParticipant& structure = roster().connect("structure", {});
  RemoteParticipant& fluid = roster().connect("fluid", {});
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
  EXPECT_NE(read(log("fluid")).find("ended by SIGTERM"), std::string::npos)
      << "a busy participant is terminated";
}

TEST_F(Faults, AFrozenParticipantIsWaitedForThenGivenUp) {
  options_.deadlines.frozen_after = std::chrono::seconds(2);
  launch("structure", "sleep");
  RemoteParticipant& structure = roster().connect("structure", {});
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

TEST_F(Faults, AThawedParticipantGoesOnWhereItWas) {
  launch("structure", "nap", 2);
  RemoteParticipant& structure = roster().connect("structure", {});
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
  roster().finish();
  roster_.reset();
  EXPECT_NE(said_.find("no heartbeat"), std::string::npos) << said_;
  EXPECT_NE(said_.find("is back"), std::string::npos) << said_;
  EXPECT_EQ(count(read(log("structure")), "commit"), 3u);
}

TEST_F(Faults, AProgramThatNeverSpeaksIsGivenUpWithTheNameOfItsLog) {
  options_.deadlines.hello = milliseconds(300);
  launch("structure", "mute");
  const Error e = error_of([&] { roster().connect("structure", {}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_EQ(e.where(), "structure");
  EXPECT_NE(e.problem().find("has not said Hello"), std::string::npos);
  EXPECT_NE(e.fix().find(log("structure").string()), std::string::npos);
}

TEST_F(Faults, AProgramThatEndsBeforeHelloSpeaksByItsExitCodeAndLog) {
  launch("structure", "early");
  const Error e = error_of([&] { roster().connect("structure", {}); });
  EXPECT_EQ(e.code(), ExitCode::case_file);
  EXPECT_NE(e.problem().find("exited with code 3 before it said Hello"), std::string::npos);
  EXPECT_NE(e.problem().find("toy.toml:3:1: young = 0"), std::string::npos);
}

TEST_F(Faults, AParticipantWithAnotherCaseIsRefused) {
  launch("structure", "hash");
  const Error e = error_of([&] { roster().connect("structure", {}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(said_.find("another case"), std::string::npos) << said_;
  EXPECT_NE(e.problem().find("was refused: structure has read another case"), std::string::npos);
  EXPECT_NE(read(log("structure")).find("the coupler refused this participant"), std::string::npos);
}

TEST_F(Faults, ACrashIsNamedByItsSignal) {
  launch("structure", "crash");
  RemoteParticipant& structure = roster().connect("structure", {});
  const Error e = error_of([&] { structure.advance({0, 0.1}, {}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(e.problem().find("was killed by signal 6 (Aborted)"), std::string::npos);
}

TEST_F(Faults, AnExitInsideAStepIsNamedByItsCode) {
  launch("structure", "exit");
  RemoteParticipant& structure = roster().connect("structure", {});
  const Error e = error_of([&] { structure.advance({0, 0.1}, {}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(e.problem().find("exited with code 7 while Advance was awaited"), std::string::npos);
}

TEST_F(Faults, ASolversOwnErrorArrivesWithPlaceProblemAndFix) {
  launch("fluid", "error");
  RemoteParticipant& fluid = roster().connect("fluid", {});
  const Error e = error_of([&] { fluid.advance({0.5, 0.1}, {}); });
  EXPECT_EQ(e.code(), ExitCode::solver_fault);
  EXPECT_EQ(e.where(), "fluid, window 1 (t = 0.5 s), iteration 1, toy");
  EXPECT_EQ(e.problem(), "pressure did not converge\n500 iterations");
  EXPECT_EQ(e.fix(), "lower fluid.scheme.cfl");
  EXPECT_NE(read(log("fluid")).find("pressure did not converge"), std::string::npos);
}

TEST_F(Faults, AValueThatIsNotFiniteIsASolverFault) {
  launch("structure", "nan");
  RemoteParticipant& structure = roster().connect("structure", {});
  const Error e = error_of([&] { structure.advance({0, 0.1}, {}); });
  EXPECT_EQ(e.code(), ExitCode::solver_fault);
  EXPECT_NE(e.problem().find("displacement is not finite: nan m at point 2 of 3, component 1"),
            std::string::npos);
}

TEST_F(Faults, AFieldThatDoesNotFitTheMeshIsRefused) {
  launch("structure", "size");
  RemoteParticipant& structure = roster().connect("structure", {});
  const Error e = error_of([&] { structure.advance({0, 0.1}, {}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_EQ(e.problem(), "sent displacement at 2 points, its mesh has 3");
}

TEST_F(Faults, AParticipantStartedByHandEndsWithItsCoupler) {
  roster().attach("structure");
  Launch launch{fs::path(STRAKE_TOYS) / "toy_participant",
                {"--connect", endpoint_, "--name", "structure", "--fault", "sleep", "--case-hash"},
                log("structure"),
                1,
                {{"STRAKE_TOKEN", roster().token()}}};
  std::string hash;
  for (int i = 0; i < 32; ++i) hash += "2a";
  launch.arguments.push_back(hash);
  Child by_hand(launch);
  roster().connect("structure", {}).start({0, 0.1}, {});
  wait_for(log("structure"), "step begins");
  signalled_ = steady_clock::now();
  roster_.reset();  // the coupler is gone, without a word to one that is busy
  const auto exit = by_hand.wait(std::chrono::seconds(30));
  ASSERT_TRUE(exit);
  report_delay();
  EXPECT_EQ(exit->code, static_cast<int>(ExitCode::participant_lost));
  EXPECT_NE(read(log("structure")).find("the coupler is gone"), std::string::npos);
}

TEST_F(Faults, CtrlCInsideALongStepEndsTheRun) {
  const StopRequest stop;
  options_.stop = &stop;
  options_.deadlines.grace = milliseconds(200);
  launch("structure", "sleep");
  RemoteParticipant& structure = roster().connect("structure", {});
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

/// The coupler as a process of its own, so that it can be killed.
class CouplerFaults : public Faults {
 protected:
  Child couple(const std::string& fault) {
    Child coupler({fs::path(STRAKE_TOYS) / "toy_coupler",
                   {fs::path(STRAKE_TOYS) / "toy_participant", log("structure"), fault},
                   log("coupler"),
                   1,
                   {}});
    wait_for(log("structure"), "step begins");
    std::istringstream(read(log("coupler"))) >> endpoint_;
    return coupler;
  }
};

class DeadCoupler : public CouplerFaults, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(, DeadCoupler, testing::Values("sleep", "deaf"));

TEST_P(DeadCoupler, EndsItsParticipantInsideAStepWhateverBecameOfItsSignals) {
  Child coupler = couple(GetParam());
  const pid_t participant = pid_of("structure");
  ASSERT_TRUE(fs::exists(folder_of(endpoint_)));
  signalled_ = steady_clock::now();
  kill(coupler.pid(), SIGKILL);
  int status = 0;
  EXPECT_TRUE(coupler.wait(milliseconds(1000)));
  while (waitpid(participant, &status, 0) < 0 && runs(participant)) {
  }  // its parent is this process now
  report_delay();
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), static_cast<int>(ExitCode::participant_lost));
  EXPECT_NE(read(log("structure")).find(fmt::format("the coupler (process {}) is gone", coupler.pid())),
            std::string::npos);
  EXPECT_EQ(read(log("structure")).find("step ends"), std::string::npos);
}

TEST_F(CouplerFaults, ASuspendedCouplerIsWaitedForAndGoesOn) {
  Child coupler = couple("nap");
  kill(coupler.pid(), SIGSTOP);
  wait_for(log("structure"), "no heartbeat from the coupler");
  EXPECT_TRUE(runs(pid_of("structure")));
  kill(coupler.pid(), SIGCONT);
  const auto exit = coupler.wait(std::chrono::seconds(20));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 0) << read(log("coupler"));
  EXPECT_NE(read(log("structure")).find("commit 3"), std::string::npos) << read(log("structure"));
}

TEST_F(CouplerFaults, CtrlCEndsAllProcessesAndExits130) {
  Child coupler = couple("sleep");
  const pid_t participant = pid_of("structure");
  signalled_ = steady_clock::now();
  kill(coupler.pid(), SIGINT);
  const auto exit = coupler.wait(std::chrono::seconds(10));
  ASSERT_TRUE(exit);
  report_delay();
  EXPECT_EQ(exit->code, 130) << read(log("coupler"));
  EXPECT_FALSE(runs(participant));
}

TEST_F(CouplerFaults, ASecondCtrlCEndsAtOnceAndLeavesNothing) {
  Child coupler = couple("sleep");
  const pid_t participant = pid_of("structure");
  kill(coupler.pid(), SIGINT);
  while (read(fmt::format("/proc/{}/status", coupler.pid())).find("SigPnd:\t0000000000000000") ==
         std::string::npos) {
  }  // until the first is delivered: two at once would count as one
  std::this_thread::sleep_for(milliseconds(20));
  kill(coupler.pid(), SIGINT);
  const auto exit = coupler.wait(std::chrono::seconds(4));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 130);
  while (waitpid(participant, nullptr, 0) < 0 && runs(participant)) {
  }
  EXPECT_FALSE(runs(participant));
}

}  // namespace
}  // namespace strake
