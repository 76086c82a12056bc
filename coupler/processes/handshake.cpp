// Who may take part in a run: the first word of a participant, one that comes back, and strangers.

#include "coupler/processes/participants_state.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>

namespace strake {
namespace {

bool equal_secret(const std::string& a, const std::string& b) {
  return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace

void Participants::State::greet(const CouplerSocket::Message& message) {
  wire::Reply reply;
  try {
    reply = wire::decode_reply(message.parts, "a stranger");
  } catch (const Error& e) {
    return refuse(message, nullptr, e.problem(), "");
  }
  const auto* hello = std::get_if<wire::Hello>(&reply.what);
  // One whose connection was cut may answer before it notices: its Hello follows, and the answer once more.
  const auto answers = [&](const auto& m) {
    return m->connection.greeted && !m->asked.empty() && m->sequence == reply.sequence;
  };
  if (!hello && std::any_of(members.begin(), members.end(), answers)) return;
  if (!hello) return refuse(message, nullptr, fmt::format("spoke {} before Hello", wire::name_of(reply)), "");
  if (!equal_secret(hello->token, raw_token))
    return refuse(message, nullptr, fmt::format("\"{}\" does not know the token of this run", hello->name),
                  "STRAKE_TOKEN must hold the token that the coupler printed");
  Member* m = find(hello->name);
  if (!m) {
    std::string names;
    for (const auto& known : members) names += (names.empty() ? "" : ", ") + known->name;
    return refuse(message, nullptr,
                  fmt::format("\"{}\" has no part in this run, expected: {}", hello->name, names), "--name");
  }
  if (!message.key.empty() && message.key != hello->name)
    return refuse(message, m, fmt::format("\"{}\" comes with the key of \"{}\"", hello->name, message.key),
                  "STRAKE_KEY must name the key file of this participant");
  if (hello->protocol != wire::protocol)
    return refuse(
        message, m,
        fmt::format("{} speaks protocol {}, the coupler {}", m->name, hello->protocol, wire::protocol),
        "use programs of one version");
  const std::string hash(options.case_hash.begin(), options.case_hash.end());
  if (hello->case_hash != hash)
    return refuse(message, m,
                  fmt::format("{} has read another case than the coupler (their hashes differ)", m->name),
                  "give it the same --case and --set; a file of the case may have changed in between");
  if (m->connection.greeted && reply.sequence == 0 && socket.connected(m->connection.peer))
    return refuse(message, m, fmt::format("{} already takes part", m->name), "--name");
  if (m->connection.greeted && socket.connected(m->connection.peer))
    return put_aside(*m, message, reply.sequence);
  if (m->connection.greeted) return welcome_back(*m, message, reply.sequence);
  m->connection.greeted = true;
  take_connection(*m, message.peer);
  m->last_heard = Clock::now();
  m->refusal.clear();
}

/// A participant with a live connection is not replaced. One that was frozen may return before its old
/// connection has ended; its message waits until then.
void Participants::State::put_aside(Member& m, const CouplerSocket::Message& message,
                                    std::uint64_t last_received) {
  socket.admit(message.peer);  // it knows the token: what it says next is heard
  returning.push_back({&m, message, last_received, Clock::now(), {}});
}

void Participants::State::look_after_returning() {
  constexpr std::chrono::milliseconds to_let_go{1200};  // heartbeats end the old connection earlier
  for (std::size_t i = 0; i < returning.size();) {
    const bool stands = socket.connected(returning[i].member->connection.peer);
    if (stands && Clock::now() - returning[i].since < to_let_go) {
      ++i;
      continue;
    }
    Returning r = std::move(returning[i]);
    returning.erase(returning.begin() + static_cast<std::ptrdiff_t>(i));
    if (stands) {
      refuse(r.hello, r.member, fmt::format("{} already takes part", r.member->name), "--name");
      continue;
    }
    if (!socket.connected(r.hello.peer)) continue;
    welcome_back(*r.member, r.hello, r.last_received);
    for (CouplerSocket::Message& message : r.rest) hear(std::move(message));
  }
}

/// For a process that we did not start, only the connection shows whether it lives. For any process, the way
/// its connection ends is used.
void Participants::State::take_connection(Member& m, const std::string& peer) {
  m.connection.peer = peer;
  socket.admit(peer);
  socket.watch_close(peer);
}

/// A participant that was frozen (or a coupler that was) has a new connection. What the old one lost is sent
/// again. What it did not lose comes twice: an answer, which may be late and meet the next request, and a
/// request, which is answered twice.
void Participants::State::welcome_back(Member& m, const CouplerSocket::Message& message,
                                       std::uint64_t last_received) {
  const auto silence =
      m.connection.silent_since ? Clock::now() - *m.connection.silent_since : Clock::duration(0);
  say(fmt::format("{}: is back after {} without a heartbeat", m.place(), in_seconds(silence)));
  take_connection(m, message.peer);
  m.connection.silent_since.reset();
  m.connection.silence_told = false;
  m.last_heard = Clock::now();
  m.may_repeat = m.sequence;
  if (!m.asked.empty() && !m.reply && last_received < m.sequence) socket.send(m.connection.peer, m.request);
}

void Participants::State::refuse(const CouplerSocket::Message& message, Member* m, const std::string& problem,
                                 const std::string& fix) {
  note_stranger("refused a participant: " + harmless(problem), 1);
  if (m && !m->connection.greeted) m->refusal = "was refused: " + problem;
  socket.send(message.peer, wire::encode(wire::Request{0, wire::Refused{"coupler", harmless(problem), fix}}));
}

void Participants::State::note_stranger(const std::string& what, int times) {
  for (const std::string& line : strangers.note(what, times, Clock::now())) say(line);
}

void Participants::State::look_after_strangers() {
  for (const auto& [what, times] : socket.take_strangers())
    note_stranger("refused a connection: " + what, times);
  for (const std::string& line : strangers.due(Clock::now())) say(line);
}

namespace {

constexpr std::size_t most_kinds = 20;
constexpr std::chrono::seconds first_quiet{10}, longest_quiet{600};
const std::string other_kinds = "others";  // what one more kind is counted as

}  // namespace

std::vector<std::string> StrangerLog::note(const std::string& what, int times, Clock::time_point now) {
  const bool known = kinds_.contains(what);
  const std::string& kind = known || kinds_.size() < most_kinds ? what : other_kinds;
  const auto [entry, is_new] = kinds_.try_emplace(kind, Kind{0, now, first_quiet});
  entry->second.untold += is_new ? times - 1 : times;
  if (!is_new) return {};
  return {kind};
}

std::vector<std::string> StrangerLog::due(Clock::time_point now) {
  std::vector<std::string> lines;
  for (auto entry = kinds_.begin(); entry != kinds_.end();) {
    Kind& kind = entry->second;
    const auto since = now - kind.told;
    if (since >= longest_quiet && kind.untold == 0) {
      entry = kinds_.erase(entry);
      continue;
    }
    if (since >= kind.quiet && kind.untold > 0) {
      lines.push_back(fmt::format("{} ({} more in {:.0f} s)", entry->first, kind.untold,
                                  std::chrono::duration<double>(since).count()));
      kind = {0, now, std::min<Clock::duration>(2 * kind.quiet, longest_quiet)};
    }
    ++entry;
  }
  return lines;
}

std::string harmless(const std::string& text) {
  constexpr std::size_t longest = 200;
  const std::string plain = visible(std::string_view(text).substr(0, longest), "");
  return text.size() > longest ? plain + "..." : plain;
}

}  // namespace strake
