// RemoteParticipant and Participants against a participant that follows a script, in a thread of this
// process. What goes wrong: remote_fault_test.cpp.

#include "coupler/participant/stop_request.hpp"
#include "tests/coupler/processes/remote_fixture.hpp"

#include <algorithm>
#include <signal.h>
#include <span>
#include <thread>
#include <vector>

namespace strake {
namespace remote_test {

TEST_F(Remote, AWaitIsNoWarningUntilHalfOfWhatItMayLast) {
  std::string noted;
  options_.note = [&](const std::string& line) { noted += line + "\n"; };
  options_.deadlines.tell = milliseconds(100);
  options_.deadlines.answer_within = std::chrono::seconds(1);
  play(
      [&](Script& s) {
        s.join(participants().token());
        s.hear<wire::Advance>();
      },
      [&] {
        EXPECT_THROW(participants().connect("fluid", {}).advance({0.5, 0.25}, {}), Error);
      });
  EXPECT_EQ(std::count(noted.begin(), noted.end(), '\n'), 3) << noted;  // after 0.1, 0.2 and 0.4 s
  EXPECT_EQ(std::count(said_.begin(), said_.end(), '\n'), 1) << said_;  // after 0.8 s
  EXPECT_NE(said_.find("was asked 0.8"), std::string::npos) << said_;
}

TEST_F(Remote, CommitAndRewindRideOnTheNextRequest) {
  using wire::Before;
  std::vector<wire::Advance> heard;
  bool checkpoint_commits = false, stop_commits = true;
  const auto script = [&](Script& s) {
    s.join(participants().token());
    for (int i = 0; i < 3; ++i) {
      heard.push_back(s.hear<wire::Advance>());
      s.say(force(i));
    }
    const auto checkpoint = s.hear<wire::Checkpoint>();
    checkpoint_commits = checkpoint.before == Before::commit && checkpoint.write_output;
    s.say(wire::Done{});
    heard.push_back(s.hear<wire::Advance>());
    s.say(force(3));
    stop_commits = s.hear<wire::Stop>().commit;
    s.say(wire::Done{});
  };
  play(script, [&] {
    RemoteParticipant& fluid = participants().connect("fluid", {});
    fluid.advance({0, 0.25}, {});
    fluid.rewind();
    fluid.advance({0, 0.25}, {});
    fluid.commit(true);
    const Advanced a = fluid.advance({0.25, 0.25}, {});
    EXPECT_EQ(a.output.at(0).value(0, 0), 2);
    EXPECT_EQ(a.dt_limit, 1e-3);
    fluid.commit(true);
    fluid.checkpoint("somewhere");
    fluid.advance({0.5, 0.25}, {});
    participants().finish();
  });
  ASSERT_EQ(heard.size(), 4u);
  const Before expected[] = {Before::nothing, Before::rewind, Before::commit, Before::nothing};
  const std::uint32_t iterations[] = {1, 2, 1, 1};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(heard[i].before, expected[i]) << i;
    EXPECT_EQ(heard[i].iteration, iterations[i]) << i;
    EXPECT_EQ(heard[i].write_output, i == 2) << i;
  }
  EXPECT_TRUE(checkpoint_commits);
  EXPECT_FALSE(stop_commits) << "the last window was never committed";
}

TEST_F(Remote, StartReturnsAtOnceAndFinishWaits) {
  play(
      [&](Script& s) {
        s.join(participants().token());
        s.hear<wire::Advance>();
        std::this_thread::sleep_for(milliseconds(100));
        s.say(force(1));
      },
      [&] {
        RemoteParticipant& fluid = participants().connect("fluid", {});
        Input input{{{0.25, {{"displacement", "m", false, Points::Ones(3, 3)}}}}};
        fluid.start({0, 0.25}, input);
        EXPECT_EQ(input.samples.at(0).fields.at(0).value, Points::Ones(3, 3)) << "it is lent";
        input = {};  // what start was given need not outlive it
        EXPECT_EQ(fluid.finish().output.at(0).value(0, 0), 1);
      });
}

TEST_F(Remote, WhoDoesNotBelongIsRefusedAndTheRightOneStillAccepted) {
  const auto refused = [&](Script& s, const std::string& why) {
    const std::string problem = s.hear<wire::Refused>().problem;
    EXPECT_NE(problem.find(why), std::string::npos) << problem;
  };
  play(
      [&](Script& s) {
        const std::string token = participants().token(), endpoint = participants().endpoint();
        Script stranger(endpoint, "fluid"), other(endpoint, "structure"), old(endpoint, "fluid"),
            hash(endpoint, "fluid"), rude(endpoint, "fluid"), noise(endpoint, "fluid");
        stranger.hello(std::string(32, '0'));
        refused(stranger, "does not know the token");
        other.hello(token);
        refused(other, "\"structure\" has no part in this run, expected: fluid");
        old.hello(token, std::string(32, '\0'), 2);
        refused(old, "speaks protocol 2, the coupler 1");
        hash.hello(token, std::string(32, '\1'));
        refused(hash, "another case");
        rude.say(force(1));
        refused(rude, "spoke Advanced before Hello");
        const std::string bytes(100, '\xff');
        noise.send({{std::as_bytes(std::span(bytes)), nullptr}});
        refused(noise, "cannot be read");
        s.join(token);
        Script twin(endpoint, "fluid");
        twin.hello(token);
        refused(twin, "already takes part");
        s.hear<wire::Advance>();
        s.say(force(1));
      },
      [&] {
        RemoteParticipant& fluid = participants().connect("fluid", {});
        EXPECT_EQ(fluid.advance({0, 1}, {}).output.at(0).value(0, 0), 1);
      });
  EXPECT_NE(said_.find("does not know the token"), std::string::npos) << said_;
}

TEST_F(Remote, AnAnswerAheadOfTheHelloOfANewConnectionIsNotHeldAgainstIt) {
  play(
      [&](Script& s) {
        s.join(participants().token());
        s.hear<wire::Advance>();
        Script again(participants().endpoint(), "fluid");
        again.say(s.sequence(), force(7));
        again.say(s.sequence(), wire::Hello{wire::protocol, "fluid", raw(participants().token()), "script",
                                            "1", std::string(32, '\0')});
        again.say(s.sequence(), force(1));
        std::this_thread::sleep_for(milliseconds(100));  // meanwhile the old connection stands
        s.leave();
        again.hear<wire::Stop>();
        again.say(wire::Done{});
        while (!over_) std::this_thread::sleep_for(milliseconds(1));
      },
      [&] {
        EXPECT_EQ(participants().connect("fluid", {}).advance({0, 0.1}, {}).output.at(0).value(0, 0), 1);
        participants().finish();
      });
  EXPECT_EQ(said_.find("refused"), std::string::npos) << said_;
  EXPECT_NE(said_.find("is back"), std::string::npos) << said_;
}

TEST_F(Remote, AnAnswerThatANewConnectionRepeatsDoesNotMeetTheNextRequest) {
  play(
      [&](Script& s) {
        s.join(participants().token());
        s.hear<wire::Advance>();
        const auto first = s.sequence();
        s.say(force(1));
        s.hear<wire::Advance>();
        Script again(participants().endpoint(), "fluid");  // it has not read that request
        again.say(first, wire::Hello{wire::protocol, "fluid", raw(participants().token()), "script", "1",
                                     std::string(32, '\0')});
        again.say(first, force(1));
        s.leave();
        again.hear<wire::Advance>();
        again.say(first + 1, force(2));
        again.hear<wire::Advance>();
        again.say(first + 1, force(2));  // the request came over both connections
        again.say(first, force(1));
        again.say(first + 2, force(3));
        again.hear<wire::Stop>();
        again.say(wire::Done{});
        while (!over_) std::this_thread::sleep_for(milliseconds(1));
      },
      [&] {
        RemoteParticipant& fluid = participants().connect("fluid", {});
        for (int k = 1; k <= 3; ++k) {
          EXPECT_EQ(fluid.advance({0.1 * k, 0.1}, {}).output.at(0).value(0, 0), k);
          fluid.commit(false);
        }
        participants().finish();
      });
  EXPECT_NE(said_.find("s without a heartbeat"), std::string::npos) << said_;
}

TEST_F(Remote, NobodyTakesThePlaceOfOneWhoseConnectionStands) {
  play(
      [&](Script& s) {
        s.join(participants().token());
        s.hear<wire::Advance>();
        Script other(participants().endpoint(), "fluid");
        other.say(s.sequence(), wire::Hello{wire::protocol, "fluid", raw(participants().token()), "script",
                                            "1", std::string(32, '\0')});
        other.say(s.sequence(), force(13));
        std::this_thread::sleep_for(milliseconds(100));  // it has been heard
        s.say(force(1));
        s.hear<wire::Advance>();
        const std::string problem = other.hear<wire::Refused>().problem;
        EXPECT_EQ(problem, "fluid already takes part");
        s.say(force(2));
      },
      [&] {
        RemoteParticipant& fluid = participants().connect("fluid", {});
        EXPECT_EQ(fluid.advance({0, 0.1}, {}).output.at(0).value(0, 0), 1);
        fluid.commit(false);
        EXPECT_EQ(fluid.advance({0.1, 0.1}, {}).output.at(0).value(0, 0), 2);
      });
  EXPECT_EQ(said_.find("is back"), std::string::npos) << said_;
}

TEST_F(Remote, WorkingRestartsTheLimitAndPatienceSwitchesItOff) {
  for (const bool patient : {false, true}) {
    options_.deadlines.answer_within = milliseconds(300);
    options_.deadlines.patient = patient;
    over_ = false;
    play(
        [&](Script& s) {
          s.join(participants().token());
          s.hear<wire::Advance>();
          for (int i = 0; i < 4; ++i) {  // 0.4 s in all
            std::this_thread::sleep_for(milliseconds(100));
            if (!patient) s.say(wire::Working{0.25 * i, "factorising"});
          }
          s.say(force(1));
        },
        [&] {
          EXPECT_NO_THROW(participants().connect("fluid", {}).advance({0, 1}, {}));
        });
  }
}

TEST_F(Remote, CtrlCEndsAWaitForHello) {
  const StopRequest stop;
  options_.stop = &stop;
  EXPECT_EQ(stop.code(), ExitCode::done);
  raise(SIGINT);
  EXPECT_EQ(stop.code(), ExitCode::interrupted);
  try {
    participants().connect("fluid", {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::interrupted);
  }
}

TEST_F(Remote, AWindowUnderWayMayEndAfterCtrlC) {
  const StopRequest stop;
  options_.stop = &stop;
  play(
      [&](Script& s) {
        s.join(participants().token());
        s.hear<wire::Advance>();
        raise(SIGTERM);
        std::this_thread::sleep_for(milliseconds(150));
        s.say(force(1));
        s.hear<wire::Checkpoint>();
        s.say(wire::Done{});
      },
      [&] {
        RemoteParticipant& fluid = participants().connect("fluid", {});
        EXPECT_NO_THROW(fluid.advance({0, 1}, {}));
        EXPECT_EQ(stop.code(), ExitCode::terminated);
        fluid.commit(false);
        EXPECT_NO_THROW(fluid.checkpoint("somewhere")) << "the state can still be saved";
      });
}

}  // namespace remote_test
}  // namespace strake
