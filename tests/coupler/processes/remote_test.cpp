// RemoteParticipant and Participants against a participant that follows a script, in a thread of this
// process.

#include "coupler/processes/remote.hpp"

#include "coupler/participant/stop_request.hpp"
#include "coupler/transport/sockets.hpp"
#include "proto/error.hpp"
#include "tests/text/golden.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zmq.hpp>

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <signal.h>
#include <span>
#include <sys/mman.h>
#include <thread>
#include <vector>

namespace strake {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

std::string raw(const std::string& hexadecimal) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hexadecimal.size(); i += 2)
    bytes += static_cast<char>(std::stoi(hexadecimal.substr(i, 2), nullptr, 16));
  return bytes;
}

InterfaceMesh three_points() {
  InterfaceMesh mesh;
  mesh.position = Points::Zero(3, 3);
  return mesh;
}
Advanced force(double value) {
  Advanced advanced;
  advanced.output = {{"force", "N", true, Points::Constant(3, 3, value)}};
  advanced.dt_limit = 1e-3;
  return advanced;
}

/// The other end, one message at a time.
class Script {
 public:
  Script(const std::string& endpoint, std::string name)
      : name_(std::move(name)), line_(std::make_unique<ParticipantSocket>(endpoint)) {}
  void leave() { line_.reset(); }

  void hello(const std::string& token, const std::string& hash = std::string(32, '\0'),
             std::uint32_t protocol = wire::protocol) {
    line_->send(
        wire::encode(wire::Reply{0, wire::Hello{protocol, name_, raw(token), "script", "1", hash}}, name_));
  }
  /// The next request, decoded as T.
  template <class T>
  T hear() {
    const auto parts = line_->receive(std::chrono::seconds(5));
    if (!parts) throw std::runtime_error("nothing was asked");
    wire::Request request = wire::decode_request(*parts);
    sequence_ = request.sequence;
    return std::get<T>(std::move(request.what));
  }
  template <class T>
  void say(T what) {
    say(sequence_, std::move(what));
  }
  template <class T>
  void say(std::uint64_t sequence, T what) {
    line_->send(wire::encode(wire::Reply{sequence, std::move(what)}, name_));
  }
  void send(const wire::Parts& parts) { line_->send(parts); }
  std::uint64_t sequence() const { return sequence_; }
  void join(const std::string& token) {
    hello(token);
    hear<strake::Setup>();
    say(wire::Ready{three_points(), {}});
  }

 private:
  std::string name_;
  std::unique_ptr<ParticipantSocket> line_;
  std::uint64_t sequence_ = 0;
};

class Remote : public testing::Test {
 protected:
  void SetUp() override {
    options_.say = [this](const std::string& line) { said_ += line + "\n"; };
    options_.deadlines.answer_within = std::chrono::seconds(5);
  }
  Participants& participants() {
    if (!participants_) {
      participants_ = std::make_unique<Participants>(options_);
      participants_->attach("fluid");
    }
    return *participants_;
  }
  /// Plays `script` beside what the coupler does in `act`.
  void play(const std::function<void(Script&)>& script, const std::function<void()>& act) {
    std::thread other([&, endpoint = participants().endpoint()] {
      try {
        Script s(endpoint, "fluid");
        script(s);
        while (!over_) std::this_thread::sleep_for(milliseconds(1));  // it stays until the coupler is done
      } catch (const std::exception& e) {
        ADD_FAILURE() << "the script: " << e.what();
      }
    });
    act();
    over_ = true;
    other.join();
    participants_.reset();
  }
  /// The error of the first window, which the script spoils.
  Error error_of(const std::function<void(Script&)>& spoil) {
    std::optional<Error> error;
    play(
        [&](Script& s) {
          s.join(participants().token());
          s.hear<wire::Advance>();
          spoil(s);
        },
        [&] {
          try {
            participants().connect("fluid", {}).advance({0.5, 0.25}, {});
          } catch (const Error& e) {
            error = e;
          }
        });
    if (!error) {
      ADD_FAILURE() << "no error";
      return {ExitCode::done, "", ""};
    }
    expect_stored("faults.txt", this_test(), without_chance(said_ + to_text(*error)));
    return *error;
  }

  Participants::Options options_;
  std::string said_;
  std::unique_ptr<Participants> participants_;
  std::atomic<bool> over_{false};
};

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

/// A participant of the user's own, with ZeroMQ and nothing else: one part of its answer is too large.
void answer_too_large(const std::string& endpoint, const std::string& token) {
  zmq::context_t context{1};
  zmq::socket_t socket{context, zmq::socket_type::dealer};
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::rcvtimeo, 3000);
  socket.connect(endpoint);
  const auto say = [&](wire::Reply reply) {
    const wire::Parts parts = wire::encode(std::move(reply), "fluid");
    for (std::size_t i = 0; i < parts.size(); ++i)
      socket.send(zmq::const_buffer(parts[i].bytes.data(), parts[i].bytes.size()),
                  i + 1 < parts.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
  };
  const auto hear = [&] {
    zmq::message_t part;
    do EXPECT_TRUE(socket.recv(part));
    while (part.more());
  };
  say({0, wire::Hello{wire::protocol, "fluid", raw(token), "own", "1", std::string(32, '\0')}});
  hear();
  say({1, wire::Ready{three_points(), {}}});
  hear();
  const std::size_t bytes = (std::size_t{1} << 28) + 1;
  void* zeros = mmap(nullptr, bytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  ASSERT_NE(zeros, MAP_FAILED);
  socket.send(zmq::message_t(zeros, bytes, [](void*, void*) {}), zmq::send_flags::none);
  socket.set(zmq::sockopt::rcvtimeo, 700);
  zmq::message_t part;
  EXPECT_FALSE(socket.recv(part)) << "nobody answers";
  context.shutdown();
  socket.close();
  context.close();
  munmap(zeros, bytes);
}

TEST_F(Remote, APartThatIsTooLargeIsNamedLongBeforeTheLimitOfAnAnswer) {
  options_.deadlines.answer_within = std::chrono::seconds(60);
  options_.deadlines.frozen_after = std::chrono::seconds(1);
  std::thread other([&, endpoint = participants().endpoint(), token = participants().token()] {
    answer_too_large(endpoint, token);
  });
  std::optional<Error> error;
  const auto start = steady_clock::now();
  try {
    participants().connect("fluid", {}).advance({0.5, 0.25}, {});
  } catch (const Error& e) {
    error = e;
  }
  const auto waited = steady_clock::now() - start;
  participants_.reset();
  other.join();
  ASSERT_TRUE(error);
  EXPECT_LT(waited, std::chrono::seconds(3));
  EXPECT_EQ(error->code(), ExitCode::participant_lost);
  EXPECT_EQ(error->where(), "fluid, window 1 (t = 0.5 s), iteration 1");
  EXPECT_EQ(error->problem(),
            "its connection was cut while it sent its answer to Advance: a part of a message may have at "
            "most 256 MB");
}

TEST_F(Remote, AStaleAnswerIsNamed) {
  const Error e = error_of([](Script& s) { s.say(s.sequence() - 1, force(1)); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_EQ(e.where(), "fluid, window 1 (t = 0.5 s), iteration 1");
  EXPECT_EQ(e.problem(), "answered request 1 when Advance (number 2) was asked");
}

TEST_F(Remote, AnAnswerOfTheWrongKindIsNamed) {
  const Error e = error_of([](Script& s) { s.say(wire::Done{}); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_EQ(e.problem(), "answered Advance with Done");
}

TEST_F(Remote, AWrongSizeIsFoundThoughTheSenderChecksNothing) {
  const Error e = error_of([](Script& s) {
    wire::Parts parts = wire::encode(wire::Reply{s.sequence(), force(1)}, "fluid");
    parts[1].bytes = parts[1].bytes.first(parts[1].bytes.size() - 8);
    s.send(parts);
  });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(e.problem().find("64 bytes for force, expected 3 x 3"), std::string::npos) << e.problem();
}

TEST_F(Remote, ANumberThatIsNotFiniteIsFoundThoughTheSenderChecksNothing) {
  const Error e = error_of([](Script& s) {
    wire::Parts parts = wire::encode(wire::Reply{s.sequence(), force(1)}, "fluid");
    const std::vector<double> numbers(9, std::numeric_limits<double>::quiet_NaN());
    parts[1] = {std::as_bytes(std::span(numbers)), nullptr};
    s.send(parts);
  });
  EXPECT_EQ(e.code(), ExitCode::solver_fault);
  EXPECT_NE(e.problem().find("force is not finite"), std::string::npos) << e.problem();
}

TEST_F(Remote, AFaultKeepsItsCodePlaceAndFix) {
  const Error e = error_of([](Script& s) {
    s.say(wire::Fault{"plate.toml:3:1: structure.young = 0", "expected > 0", "young = 2.1e11",
                      ExitCode::case_file});
  });
  EXPECT_EQ(e.code(), ExitCode::case_file);
  EXPECT_EQ(e.where(), "plate.toml:3:1: structure.young = 0") << "a file's place is not changed";
  EXPECT_EQ(e.fix(), "young = 2.1e11");
}

TEST_F(Remote, AFaultOfAForeignProgramIsNoBugOfOurs) {
  const Error e = error_of([](Script& s) {
    s.say(wire::Fault{"somewhere", "this is a bug in Strake", "", ExitCode::our_bug});
  });
  EXPECT_EQ(e.code(), ExitCode::solver_fault);
  EXPECT_NE(e.where().find("fluid"), std::string::npos) << e.where();
}

TEST_F(Remote, SilenceBeyondTheLimitIsNamed) {
  options_.deadlines.answer_within = milliseconds(200);
  const Error e = error_of([](Script&) {});
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(e.problem().find("has not answered Advance for "), std::string::npos) << e.problem();
  EXPECT_NE(e.fix().find("coupling.answer_within"), std::string::npos);
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

}  // namespace
}  // namespace strake
