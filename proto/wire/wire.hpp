#pragma once

#include "proto/error.hpp"
#include "proto/participant.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

/// The messages of coupling.proto as C++ values, and their bytes.
///
/// A message is one header part (a protobuf Request or Reply), followed by raw parts of little-endian
/// numbers, column by column. There is one raw part per array that the header announces:
/// - for a mesh: its position (3×n float64), faces (dimension×m int32, absent if m = 0) and mass (n float64,
///   absent if has_mass is false);
/// - for each field: its values (components×n float64).
///
/// Arrays come in the order in which the header names them:
/// - Setup: the partner's mesh, then its initial fields;
/// - Ready: the mesh, then its initial fields;
/// - Advance: sample by sample;
/// - Advanced: field by field, then its history sample by sample.
namespace strake::wire {

inline constexpr std::uint32_t protocol = 1;

struct Hello {
  std::uint32_t protocol = wire::protocol;
  std::string name, token, solver, version, case_hash;  // token and case_hash: raw bytes
};
struct Refused {
  std::string where, problem, fix;
};
struct Ready {
  InterfaceMesh mesh;
  Description description;
};
enum class Before { nothing = 0, commit = 1, rewind = 2 };
struct Advance {
  Before before =
      Before::nothing;  // what happens to the former window first: it costs no round trip of its own
  Window window;
  std::uint32_t iteration = 1;
  Input input;
  bool write_output = false;  // of the commit
};
struct Checkpoint {
  std::string folder;
  bool resume = false;
  Before before = Before::nothing;
  bool write_output = false;
};
struct Stop {
  bool commit = false, write_output = false;
};
struct Working {
  double fraction = 0;
  std::string what;
};
struct Fault {
  std::string where, problem, fix;
  ExitCode code = ExitCode::solver_fault;
};
struct Done {};

struct Request {
  std::uint64_t sequence = 0;
  std::variant<Setup, Advance, Checkpoint, Stop, Refused> what;
};
/// When a participant received the request and when its reply is sent, on its own steady clock. 0: not given.
struct Times {
  std::int64_t received = 0, answered = 0;  // [ns]
};
struct Reply {
  std::uint64_t sequence = 0;  // of the request that it answers; in Hello the last one received
  std::variant<Hello, Ready, Advanced, Done, Fault, Working> what;
  Times times = {};
};

/// One part of a message. `owner` keeps the bytes alive, so that the transport need not copy them.
struct Part {
  std::span<const std::byte> bytes;
  std::shared_ptr<const void> owner;
};
using Parts = std::vector<Part>;

/// Every function below checks its message, in every build type. It compares sizes with the announced counts,
/// and these with the bytes that came, before it allocates anything. It checks names and units, and that all
/// values are finite. Errors: solver_fault for a value that is not finite, participant_lost for a message
/// that breaks the rules. `who` is the sender, for Error::where.
Parts encode(Request, const std::string& who = "coupler");
Parts encode(Reply, const std::string& who);
Request decode_request(const Parts&, const std::string& who = "coupler");
Reply decode_reply(const Parts&, const std::string& who);

/// "Setup", "Advance", …
const char* name_of(const Request&);
const char* name_of(const Reply&);

}  // namespace strake::wire
