#include "coupler/participant/conversation.hpp"

#include "coupler/participant/launch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <utility>
#include <variant>

namespace strake {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// The keys of this participant; nothing where it has none.
std::optional<ParticipantKeys> keys_of(const ServeOptions& options) {
  const char* named = std::getenv("STRAKE_KEY");
  const std::filesystem::path file = options.key.empty() ? (named ? named : "") : options.key;
  if (file.empty()) return {};
  ParticipantKeys keys = read_participant_keys(file);
  if (keys.name != options.name)
    throw Error(ExitCode::command_line, file.string(),
                fmt::format("is the key of \"{}\", and this participant is \"{}\"", keys.name, options.name),
                "STRAKE_KEY must name the key file of this participant");
  return keys;
}

std::int64_t steady_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}

std::string bytes_of_token(const std::string& token) {
  std::string bytes = bytes_of(token);
  if (bytes.empty() && !token.empty())
    throw Error(ExitCode::command_line, "STRAKE_TOKEN", "is not hexadecimal",
                "give it the token that the coupler printed");
  return bytes;
}

}  // namespace

Conversation::Conversation(const ServeOptions& options)
    : options_(options),
      keys_(keys_of(options)),
      socket_(options.endpoint, keys_),
      watch_(socket_, options.endpoint, keys_) {
  say_hello();
}

void Conversation::say_hello() {
  const std::string hash(options_.case_hash.begin(), options_.case_hash.end());
  socket_.send(wire::encode(
      wire::Reply{sequence_, wire::Hello{wire::protocol, options_.name, bytes_of_token(options_.token),
                                         options_.solver, options_.version, hash}},
      options_.name));
}

/// After a new connection the coupler has another routing id for us, and messages under way are lost.
void Conversation::renew() {
  if (!watch_.take_renewed()) return;
  say_hello();
  if (!last_reply_.empty()) socket_.send(last_reply_);
}

void Conversation::answer(wire::Reply message) {
  message.sequence = sequence_;
  message.times = {received_, steady_now()};
  wire::Parts parts = wire::encode(std::move(message), options_.name);
  last_reply_.clear();
  renew();
  last_reply_ = std::move(parts);
  socket_.send(last_reply_);
}

wire::Request Conversation::next() {
  for (;;)
    if (auto request = next_within(milliseconds(1000))) return std::move(*request);
}

std::optional<wire::Request> Conversation::next_within(milliseconds limit) {
  constexpr milliseconds look{100};  // between two tests of the connection
  const auto end = Clock::now() + limit;
  for (;;) {
    renew();
    const auto left = std::chrono::ceil<milliseconds>(end - Clock::now());
    if (left <= milliseconds(0)) return {};
    const auto parts = socket_.receive(std::min(look, left));
    if (!parts) continue;
    const std::int64_t received = steady_now();
    wire::Request request = wire::decode_request(*parts);
    if (std::holds_alternative<wire::Refused>(request.what)) return request;
    if (request.sequence == sequence_ && !last_reply_.empty()) {  // sent again over a new connection
      socket_.send(last_reply_);
      continue;
    }
    if (request.sequence != sequence_ + 1)
      throw Error(ExitCode::participant_lost, options_.name,
                  fmt::format("the coupler sent request {} after {}", request.sequence, sequence_));
    sequence_ = request.sequence;
    received_ = received;
    last_reply_.clear();  // it was heard: the next one takes its memory
    return request;
  }
}

void Conversation::working(double fraction, const std::string& what) {
  const auto now = Clock::now();
  if (now - last_working_ < std::chrono::seconds(1)) return;
  last_working_ = now;
  if (watch_.take_renewed()) say_hello();
  socket_.send(wire::encode(wire::Reply{sequence_, wire::Working{fraction, what}}, options_.name));
}

}  // namespace strake
