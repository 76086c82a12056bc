#pragma once

#include "proto/participant.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace strake {

namespace wire {
struct Lead;
struct Ready;
}  // namespace wire

/// The coupling itself, run by a participant that leads (coupling.placement = "fluid"): its own side is asked
/// without a message.
class Leader {
 public:
  virtual ~Leader() = default;
  /// Meets the other side and says what it is.
  virtual wire::Ready meet(const wire::Lead&) = 0;
  /// Advances and commits windows, `count` at most, and reports each.
  virtual void run(Participant& own, std::uint64_t count, const std::function<void(Advanced)>& report) = 0;
  virtual void checkpoint(Participant& own, const std::filesystem::path& folder) = 0;
  virtual void resume(Participant& own, const std::filesystem::path& folder) = 0;
  virtual void finish() = 0;  // the other side ends in order
};

struct ServeOptions {
  std::string endpoint, name;  // --connect, --name
  std::string token;           // hexadecimal, from STRAKE_TOKEN
  std::string solver, version;
  std::array<std::uint8_t, 32> case_hash{};
  std::filesystem::path key = {};  // its key file (strake keys); empty: what STRAKE_KEY names, if anything
  std::function<std::unique_ptr<Leader>()> leader = {};  // of one that can lead
};

using ParticipantFactory = std::function<std::unique_ptr<Participant>(const Setup&)>;

/// The solver side: says Hello, builds the participant when Setup comes, answers until Stop. Returns the exit
/// code of the process; an Error goes to the coupler as a Fault and to standard error (the log).
///
/// The numerics run in the calling thread. A watch thread ends the process (a line in the log, exit 5) within
/// a second of the coupler's death, whatever the numerics do; a coupler that is only suspended is waited for.
int serve(const ServeOptions&, const ParticipantFactory&);

/// For a solver inside a long computation: tells the coupler that work goes on, at most once a second, which
/// restarts its deadline. Call it from the thread that serves; does nothing elsewhere.
void working(double fraction, const std::string& what);
/// For one that leads: a line for the coupler's console, told at once.
void tell_coupler(const std::string& line);

}  // namespace strake
