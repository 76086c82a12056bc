#pragma once

#include "coupler/participant/liveness_thread.hpp"
#include "coupler/participant/serve.hpp"
#include "coupler/transport/curve_keys.hpp"
#include "coupler/transport/sockets.hpp"
#include "proto/wire/wire.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace strake {

/// A participant's side of the conversation: it says Hello, then takes one question after the other and
/// answers each. A connection that was made anew gets Hello and the last answer again; a question that comes
/// twice gets the same answer twice.
///
/// A thread of its own watches the coupler (liveness_thread.hpp) and ends the process when the coupler is
/// gone.
class Conversation {
 public:
  /// Connects and says Hello. Error(command_line) for an endpoint, a token or a key that cannot be.
  explicit Conversation(const ServeOptions&);

  /// Waits for the next question. Error(participant_lost) if the coupler breaks the order of its questions.
  wire::Request next();
  /// The next question; nothing where none comes within `limit`.
  std::optional<wire::Request> next_within(std::chrono::milliseconds limit);
  /// Answers the last question.
  void answer(wire::Reply);
  /// Reports progress of a long computation, at most once a second.
  void working(double fraction, const std::string& what);

 private:
  void say_hello();
  void renew();

  ServeOptions options_;
  std::optional<ParticipantKeys> keys_;
  ParticipantSocket socket_;
  Watch watch_;
  std::uint64_t sequence_ = 0;  // of the last question
  std::int64_t received_ = 0;   // [ns] when it came
  wire::Parts last_reply_;
  std::chrono::steady_clock::time_point last_working_;
};

}  // namespace strake
