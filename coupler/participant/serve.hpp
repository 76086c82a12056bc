#pragma once

#include "proto/participant.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace strake {

struct ServeOptions {
  std::string endpoint, name;  // --connect, --name
  std::string token;           // hexadecimal, from STRAKE_TOKEN
  std::string solver, version;
  std::array<std::uint8_t, 32> case_hash{};
  std::filesystem::path key = {};  // its key file (strake keys); empty: what STRAKE_KEY names, if anything
};

using ParticipantFactory = std::function<std::unique_ptr<Participant>(const Setup&)>;

/// The solver side: says Hello, builds the participant when Setup comes, answers until Stop. Returns the exit
/// code of the process; an Error goes to the coupler as a Fault and to standard error (the log).
///
/// The numerics run in the calling thread. A watch thread ends the process (a line in the log, exit 5) within
/// a second of the coupler's death, whatever the numerics do; a coupler that is only suspended is waited for.
int serve(const ServeOptions&, const ParticipantFactory&);

/// Reports progress of a long computation to the coupler, at most once a second, which restarts its deadline.
/// Call it from the thread that serves; does nothing elsewhere.
void working(double fraction, const std::string& what);

}  // namespace strake
