// A coupler with one toy participant, to be killed: toy_coupler PARTICIPANT LOG FAULT. Prints its endpoint.

#include "coupler/participant/stop_request.hpp"
#include "coupler/processes/remote.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <cstdio>

int main(int argc, char** argv) {
  using namespace strake;
  if (argc != 4) return static_cast<int>(ExitCode::command_line);
  const StopRequest stop;
  try {
    Participants::Options options;
    options.stop = &stop;
    options.deadlines.grace = std::chrono::milliseconds(300);
    options.say = [](const std::string& line) { fmt::print("{}\n", line); };
    Participants participants(options);
    fmt::print("{}\n", participants.endpoint());
    std::fflush(stdout);
    participants.launch("structure", {argv[1], {"--fault", argv[3]}, argv[2], 1, {}});
    RemoteParticipant& toy = participants.connect("structure", {});
    for (int window = 0; window < 3; ++window) {
      toy.advance({window * 0.1, 0.1}, {});
      toy.commit(false);
    }
    participants.finish();
  } catch (const Error& e) {
    fmt::print("{}", to_text(e));
    return static_cast<int>(e.code());
  }
  return 0;
}
