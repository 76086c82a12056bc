// What RemoteParticipant makes of answers that are wrong, late or too large.

#include "tests/coupler/processes/remote_fixture.hpp"

#include <zmq.hpp>

#include <limits>
#include <optional>
#include <span>
#include <sys/mman.h>
#include <thread>
#include <vector>

namespace strake {
namespace remote_fault_test {

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

// On a busy machine heartbeats end a connection twice before the participant has spoken.
TEST_F(Remote, ASecondHelloByANewConnectionIsNoAnswer) {
  const std::string token = participants().token(), endpoint = participants().endpoint();
  play(
      [&](Script& s) {
        s.join(token);
        s.hear<wire::Advance>();
        s.leave();
        Script again(endpoint, "fluid");
        const wire::Hello hello{wire::protocol, "fluid", raw(token), "script", "1", std::string(32, '\0')};
        again.say(s.sequence(), hello);
        again.say(s.sequence(), hello);
        again.say(s.sequence(), force(1));
        while (!over_) std::this_thread::sleep_for(milliseconds(1));
      },
      [&] {
        RemoteParticipant& fluid = participants().connect("fluid", {});
        EXPECT_NO_THROW(EXPECT_EQ(fluid.advance({0.5, 0.25}, {}).output.at(0).value(0, 0), 1));
      });
  EXPECT_NE(said_.find("is back after"), std::string::npos) << said_;
}

TEST_F(Remote, AStaleAnswerIsNamed) {
  const Error e = error_of([](Script& s) { s.say(s.sequence() - 1, force(1)); });
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_EQ(e.where(), "fluid, window 1 (t = 0.5 s), iteration 1");
  EXPECT_EQ(e.problem(), "answered request 1 when Advance (number 2) was asked");
}

TEST_F(Remote, APlaceNamesTheSolverAndItsMethodOnce) {
  const Error e = error_of([](Script& s) {
    s.say(wire::Fault{"fluid (toy), pressure", "did not converge", "", ExitCode::solver_fault});
  });
  EXPECT_EQ(e.where(), "fluid, window 1 (t = 0.5 s), iteration 1, toy, pressure");
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
    s.say(wire::Fault{"somewhere", "this is a bug in Strake", "please report it", ExitCode::our_bug});
  });
  EXPECT_EQ(e.code(), ExitCode::solver_fault);
  EXPECT_NE(e.where().find("fluid"), std::string::npos) << e.where();
  EXPECT_EQ(e.fix().find("report"), std::string::npos) << "nobody here can mend it";
  EXPECT_NE(e.fix().find("see what it printed"), std::string::npos) << e.fix();
}

TEST_F(Remote, SilenceBeyondTheLimitIsNamed) {
  options_.deadlines.answer_within = milliseconds(200);
  const Error e = error_of([](Script&) {});
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(e.problem().find("has not answered Advance for "), std::string::npos) << e.problem();
  EXPECT_NE(e.fix().find("coupling.answer_within"), std::string::npos);
}

}  // namespace remote_fault_test
}  // namespace strake
