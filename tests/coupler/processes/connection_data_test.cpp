// What a started program is told of its connection: by options, or by its environment alone.

#include "coupler/participant/launch.hpp"
#include "coupler/processes/remote.hpp"
#include "proto/error.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace strake {
namespace connection_data_test {

Participants::Options options() {
  Participants::Options options;
  options.case_hash.fill(0x2a);
  options.deadlines.hello = std::chrono::milliseconds(400);
  return options;
}

Launch solver(const std::string& program, std::vector<std::string> arguments) {
  Launch launch;
  launch.program = program;
  launch.arguments = std::move(arguments);
  launch.own_command_line = true;
  return launch;
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(ConnectionData, StandsInTheEnvironmentOfAProgramThatGetsItsOwnArgumentsAlone) {
  const TemporaryFolder folder;
  Participants participants(options());
  Launch launch = solver("/bin/sh", {"-c", "echo $#; pwd; env", "sh", "-i", "flap"});
  launch.folder = folder.path();
  launch.log = folder.path() / "log";
  participants.launch("structure", launch);
  EXPECT_THROW(participants.connect("structure", {}), Error);  // it has ended without a word
  std::map<std::string, std::string> found;
  std::ifstream log(launch.log);
  std::string count, place;
  std::getline(log, count);
  std::getline(log, place);
  for (std::string line; std::getline(log, line);)
    found[line.substr(0, line.find('='))] = line.substr(line.find('=') + 1);
  EXPECT_EQ(count, "2");
  EXPECT_EQ(place, std::filesystem::canonical(folder.path()).string());
  EXPECT_EQ(found["STRAKE_CONNECT"], participants.endpoint());
  EXPECT_EQ(found["STRAKE_NAME"], "structure");
  EXPECT_EQ(found["STRAKE_CASE_HASH"], repeated("2a", 32));
  EXPECT_EQ(found["STRAKE_TOKEN"], participants.token());
}

TEST(ConnectionData, StandsInTheLineForOneThatIsStartedByHand) {
  Participants::Options tcp = options();
  tcp.endpoint = "tcp://127.0.0.1:*";
  const Participants participants(tcp);
  Launch launch = solver("/opt/solver", {"-i", "flap"});
  launch.folder = "/a b";
  const std::string line = participants.command("structure", launch);
  EXPECT_TRUE(line.starts_with("env -C '/a b' STRAKE_TOKEN=" + participants.token() + " ")) << line;
  EXPECT_TRUE(line.ends_with(" /opt/solver -i flap")) << line;
  for (const std::string& setting :
       {"STRAKE_CONNECT=" + participants.endpoint(), std::string("STRAKE_NAME=structure"),
        "STRAKE_CASE_HASH=" + repeated("2a", 32)})
    EXPECT_NE(line.find(" " + setting + " "), std::string::npos) << line;
}

}  // namespace connection_data_test
}  // namespace strake
