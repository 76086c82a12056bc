// Who comes in by tcp and who does not, by their keys and words. All on loopback. Strangers:
// strangers_test.cpp.

#include "coupler/processes/remote.hpp"
#include "coupler/transport/endpoint.hpp"
#include "proto/error.hpp"
#include "tests/coupler/transport/network_fixture.hpp"

#include <algorithm>

namespace strake {
namespace network_test {

TEST_F(Network, HoldersOfAListedKeyComeInAndAreKnownByIt) {
  CouplerSocket coupler("tcp://127.0.0.1:*", {coupler_keys(), false});
  ParticipantSocket fluid(coupler.endpoint(), keys("fluid")),
      structure(coupler.endpoint(), keys("structure"));
  fluid.send(one_word());
  const auto first = coupler.receive(std::chrono::seconds(5));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->key, "fluid");
  structure.send(one_word());
  const auto second = coupler.receive(std::chrono::seconds(5));
  ASSERT_TRUE(second);
  EXPECT_EQ(second->key, "structure");
  coupler.send(first->peer, one_word());
  EXPECT_TRUE(fluid.receive(std::chrono::seconds(5)));
  EXPECT_TRUE(coupler.connected(first->peer));
}

TEST_F(Network, AKeyThatIsNotListedStaysOutAndIsToldSo) {
  CouplerSocket coupler("tcp://127.0.0.1:*", {coupler_keys(), false});
  ParticipantKeys forged = keys("fluid");
  forged.own = new_key_pair();
  ParticipantSocket participant(coupler.endpoint(), forged);
  participant.send(one_word());
  EXPECT_EQ(first_failure(participant), LinkEvent::key_refused);
  EXPECT_TRUE(tells(coupler, {"holds no key of this run"}));
  EXPECT_FALSE(coupler.receive(milliseconds(50)));
}

TEST_F(Network, AKeyOfAnotherCouplerIsNoGreeting) {
  CouplerSocket coupler("tcp://127.0.0.1:*", {coupler_keys(), false});
  ParticipantKeys other = keys("fluid");
  other.coupler = new_key_pair().public_key;
  ParticipantSocket participant(coupler.endpoint(), other);
  EXPECT_EQ(first_failure(participant), LinkEvent::no_greeting);
  EXPECT_TRUE(tells(coupler, {"has the key of another coupler"}));
}

TEST_F(Network, KeysOnOneSideOnlyAreNoGreeting) {
  CouplerSocket with("tcp://127.0.0.1:*", {coupler_keys(), false}), without("tcp://127.0.0.1:*");
  ParticipantSocket plain(with.endpoint()), encrypted(without.endpoint(), keys("fluid"));
  const auto failed = [](LinkEvent e) {
    return e == LinkEvent::no_greeting || e == LinkEvent::other_greeting;
  };
  EXPECT_TRUE(failed(first_failure(plain)));
  EXPECT_TRUE(tells(with, {"comes without a key", cut}));
  EXPECT_TRUE(failed(first_failure(encrypted)));
  EXPECT_TRUE(tells(without, {unlike, cut}));
}

TEST_F(Network, WhatOtherMachinesReachNeedsKeysOrPlainWords) {
  const auto problem = [](Admission admission) {  // of an address that no machine here has
    try {
      const CouplerSocket coupler("tcp://192.0.2.1:5555", std::move(admission));
    } catch (const Error& e) {
      return e.problem();
    }
    return std::string();
  };
  EXPECT_EQ(problem({}), "can be reached from other machines, and nothing protects it");
  EXPECT_TRUE(problem({coupler_keys(), false}).starts_with("cannot be bound"));
  EXPECT_TRUE(problem({std::nullopt, true}).starts_with("cannot be bound"));
  for (const char* here :
       {"ipc:///tmp/a", "tcp://127.0.0.1:5", "tcp://127.1.2.3:*", "tcp://localhost:5", "tcp://[::1]:5"})
    EXPECT_FALSE(leaves_machine(here)) << here;
  for (const char* away : {"tcp://0.0.0.0:5", "tcp://*:5", "tcp://127.0.0.1.example.org:5",
                           "tcp://192.0.2.1:5", "tcp://[::]:5", "tcp://eth0:5", "nonsense"})
    EXPECT_TRUE(leaves_machine(away)) << away;
}

TEST_F(Network, AParticipantMayNotUseTheKeyOfAnother) {
  Participants::Options options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.keys = coupler_keys();
  options.deadlines.by_hand = milliseconds(500);
  std::string said;
  options.say = [&](const std::string& line) { said += line + "\n"; };
  Participants participants(options);
  participants.attach("structure");
  std::string raw;
  for (std::size_t i = 0; i + 1 < participants.token().size(); i += 2)
    raw += static_cast<char>(std::stoi(participants.token().substr(i, 2), nullptr, 16));
  ParticipantSocket participant(participants.endpoint(), keys("fluid"));
  participant.send(wire::encode(
      wire::Reply{0, wire::Hello{wire::protocol, "structure", raw, "x", "1", std::string(32, '\0')}}, "x"));
  EXPECT_THROW(participants.connect("structure", {}), Error);
  EXPECT_EQ(said, "refused a participant: \"structure\" comes with the key of \"fluid\"\n");
}

TEST_F(Network, AParticipantWithoutAKeyInTheFolderIsRefusedBeforeAnyWait) {
  Participants::Options options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.keys = coupler_keys();
  Participants participants(options);
  try {
    participants.attach("hull");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::case_file);
    EXPECT_EQ(e.problem(), "admits no participant \"hull\"");
  }
}

TEST_F(Network, WhoeverIsAwaitedForLongIsNamedLongBeforeTheLimit) {
  Participants::Options options;
  options.deadlines.tell = milliseconds(100);
  options.deadlines.by_hand = milliseconds(900);
  std::string said;
  options.say = [&](const std::string& line) { said += line + "\n"; };
  Participants participants(options);
  participants.attach("fluid");
  try {
    participants.connect("fluid", {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::participant_lost);
    EXPECT_EQ(e.where(), "fluid");
    EXPECT_TRUE(e.problem().starts_with("has not been started by hand within 0.9")) << e.problem();
  }
  EXPECT_TRUE(said.starts_with("waiting for fluid, to be started by hand, for 0.1")) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 4) << said;  // after 0.1, 0.2, 0.4 and 0.8 s
}

TEST_F(Network, TheCommandLineOfOneStartedByHandCanBePastedIntoAShell) {
  Participants::Options options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.keys = coupler_keys();
  options.case_hash.fill(0x2a);
  const Participants participants(options);
  const std::string line =
      participants.command("fluid", {"/opt/a b/strake-fluid", {"--set", "title=it's"}, {}, 3, {}});
  EXPECT_TRUE(line.starts_with("STRAKE_TOKEN=" + participants.token() + " ")) << line;
  EXPECT_NE(line.find(" OMP_NUM_THREADS=3 "), std::string::npos) << line;
  EXPECT_NE(line.find(" STRAKE_KEY=" + (place_ / "keys/fluid.key").string() + " "), std::string::npos)
      << line;
  EXPECT_NE(line.find(" '/opt/a b/strake-fluid' --connect " + participants.endpoint() +
                      " --name fluid --case-hash 2a2a"),
            std::string::npos)
      << line;
  EXPECT_TRUE(line.ends_with(" --set 'title=it'\\''s'")) << line;
}

}  // namespace network_test
}  // namespace strake
