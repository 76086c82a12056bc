// A coupler that is killed, suspended or interrupted, and what becomes of its participant.

#include "tests/system/faults.hpp"

namespace strake {
namespace coupler_fault_test {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

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
    std::istringstream(content(log("coupler"))) >> endpoint_;
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
  EXPECT_NE(content(log("structure")).find(fmt::format("the coupler (process {}) is gone", coupler.pid())),
            std::string::npos);
  EXPECT_EQ(content(log("structure")).find("step ends"), std::string::npos);
}

TEST_F(CouplerFaults, ASuspendedCouplerIsWaitedForAndGoesOn) {
  Child coupler = couple("nap");
  kill(coupler.pid(), SIGSTOP);
  wait_for(log("structure"), "no heartbeat from the coupler");
  EXPECT_TRUE(runs(pid_of("structure")));
  kill(coupler.pid(), SIGCONT);
  const auto exit = coupler.wait(std::chrono::seconds(20));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 0) << content(log("coupler"));
  EXPECT_NE(content(log("structure")).find("commit 3"), std::string::npos) << content(log("structure"));
}

TEST_F(CouplerFaults, CtrlCEndsAllProcessesAndExits130) {
  Child coupler = couple("sleep");
  const pid_t participant = pid_of("structure");
  signalled_ = steady_clock::now();
  kill(coupler.pid(), SIGINT);
  const auto exit = coupler.wait(std::chrono::seconds(10));
  ASSERT_TRUE(exit);
  report_delay();
  EXPECT_EQ(exit->code, 130) << content(log("coupler"));
  EXPECT_FALSE(runs(participant));
}

TEST_F(CouplerFaults, ASecondCtrlCEndsAtOnceAndLeavesNothing) {
  Child coupler = couple("sleep");
  const pid_t participant = pid_of("structure");
  kill(coupler.pid(), SIGINT);
  while (content(fmt::format("/proc/{}/status", coupler.pid())).find("SigPnd:\t0000000000000000") ==
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

}  // namespace coupler_fault_test
}  // namespace strake
