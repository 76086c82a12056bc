// Who takes part in a run: the wait loop that hears all, and what is done when one of them falls silent.

#include "coupler/log_tail.hpp"
#include "coupler/roster_state.hpp"
#include "coupler/stop_request.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <utility>

namespace strake {
namespace {

using std::chrono::milliseconds;
using Seconds = std::chrono::duration<double>;

constexpr milliseconds beat{50};               // between two looks at the processes, while nothing arrives
constexpr milliseconds last_words{100};        // a dead process's Fault may still be on its way
constexpr milliseconds heartbeat_gap{800};     // silence before the link counts as cut
constexpr milliseconds silence_to_tell{1000};  // silence before a line says so
constexpr milliseconds to_come_back{500};      // for a new connection after one that the other end closed

std::string in_seconds(Clock::duration d) {
  return fmt::format("{:.3g} s", Seconds(d).count());
}

std::string raw(const std::string& hexadecimal) {
  std::string bytes(hexadecimal.size() / 2, '\0');
  std::size_t length = 0;
  if (sodium_hex2bin(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), hexadecimal.data(),
                     hexadecimal.size(), nullptr, &length, nullptr) != 0)
    length = 0;
  bytes.resize(length);
  return bytes;
}

bool equal_secret(const std::string& a, const std::string& b) {
  return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace

std::string with_place(std::string where, const std::string& name, const std::string& place) {
  if (where.starts_with(name)) where.erase(0, name.size());
  if (where.starts_with(", ")) where.erase(0, 2);
  return where.empty() ? place : place + ", " + where;
}

std::string Roster::Member::place() const {
  if (iteration == 0)
    return committed == 0 || window.dt == 0
               ? name
               : fmt::format("{}, after window {} (t = {:.6g} s)", name, committed, window.t + window.dt);
  return fmt::format("{}, window {} (t = {:.6g} s), iteration {}", name, committed + 1, window.t, iteration);
}

std::string Roster::Member::process() const {
  if (started_by_coupler != 0) return fmt::format("process {}", started_by_coupler);
  if (!child) return "started by hand";
  return fmt::format("process {}", child->pid());
}

std::string Roster::Member::see_log() const {
  return log.empty() ? "see what it printed itself" : "see " + log.string();
}

Roster::State::State(Options o)
    : options(std::move(o)),
      hub(options.endpoint, {options.keys, options.unencrypted}),
      token(options.token.empty() ? random_token() : options.token),
      raw_token(raw(token)) {}

Roster::Member* Roster::State::find(const std::string& name) {
  for (const auto& m : members)
    if (m->name == name) return m.get();
  return nullptr;
}

void Roster::State::say(const std::string& line) const {
  if (options.say) options.say(line);
}

// ---- asking and waiting

void Roster::State::ask(Member& m, wire::Request request) {
  request.sequence = ++m.sequence;
  m.asked = wire::name_of(request);
  m.reply.reset();
  m.may_repeat.reset();
  m.request = wire::encode(std::move(request));
  m.asked_at = m.last_heard = Clock::now();
  m.tell_after = options.deadlines.tell;
  m.doing.clear();
  hub.send(m.peer, m.request);
}

void Roster::State::await_word(Member& m) {
  Clock::time_point looked = Clock::now();
  while (!m.reply && m.reports.empty()) {
    receive(beat);
    if (Clock::now() - looked < beat) continue;
    looked = Clock::now();
    look_after_all();
    check_deadlines(m);
    if (!m.reply) tell_waiting(m, looked - m.asked_at);
    if (m.asked != "Checkpoint" && m.asked != "Stop") check_stop(m);
  }
}

wire::Reply Roster::State::await(Member& m) {
  while (!m.reply) {
    m.reports.clear();
    await_word(m);
  }
  m.asked.clear();
  m.request.clear();
  return *std::exchange(m.reply, std::nullopt);
}

void Roster::State::await_hello(Member& m) {
  while (!m.greeted) {
    receive(beat);
    look_after_all();
    check_stop(m);
    if (m.greeted) continue;
    const auto waited = Clock::now() - m.expected_since;
    tell_waiting(m, waited);
    const auto limit =
        m.child || m.started_by_coupler != 0 ? options.deadlines.hello : options.deadlines.by_hand;
    if (options.deadlines.patient || waited < limit) continue;
    m.broken = true;
    const std::string refused = m.refusal.empty() ? "" : "\n" + m.refusal;
    if (!m.child && m.started_by_coupler == 0)
      throw Error(ExitCode::participant_lost, m.name,
                  fmt::format("has not been started by hand within {}{}", in_seconds(waited), refused),
                  "its command line was printed and stands in run.json; the limit is "
                  "coupling.attach_within, or --patient");
    throw Error(ExitCode::participant_lost, m.name,
                fmt::format("has not said Hello for {} ({} is alive){}{}", in_seconds(waited), m.process(),
                            refused, log_tail(m.log)),
                fmt::format("{}, or --patient when debugging", m.see_log()));
  }
}

/// One line after a while, then ever less often, so that nobody wonders for whom all are waiting.
void Roster::State::tell_waiting(Member& m, Clock::duration waited) const {
  constexpr Seconds longest{60};
  if (waited < m.tell_after) return;
  m.tell_after += std::min(m.tell_after, longest);
  const std::string alive = m.child ? m.process() + " is alive" : m.process();
  std::string line = "waiting for " + m.place();
  if (m.asked.empty() && !m.child && m.started_by_coupler == 0)
    line += fmt::format(", to be started by hand, for {}", in_seconds(waited));
  else if (m.asked.empty())
    line += fmt::format(", started {} ago ({})", in_seconds(waited), alive);
  else
    line += fmt::format(": {} was asked {} ago ({}{})", m.asked, in_seconds(waited), alive,
                        m.doing.empty() ? "" : ", last: " + m.doing);
  say(line);
}

void Roster::State::check_deadlines(const Member& m) const {
  const auto waited = Clock::now() - m.last_heard;
  // One that leads awaits another in its turn.
  const auto limit = (m.leads ? 2 : 1) * options.deadlines.answer_within;
  if (options.deadlines.patient || m.reply || waited < limit) return;
  throw Error(
      ExitCode::participant_lost, m.place(),
      fmt::format("has not answered {} for {} ({}{}{})", m.asked, in_seconds(waited), m.process(),
                  m.child ? " is alive" : "", m.doing.empty() ? "" : ", last: " + m.doing),
      fmt::format("{}, or --patient when debugging; the limit is coupling.answer_within", m.see_log()));
}

void Roster::State::check_stop(const Member& m) {
  const StopRequest* stop = options.stop;
  if (!stop || !stop->requested()) return;
  if ((m.asked == "Advance" || m.asked == "Windows") && stop->elapsed() < options.deadlines.grace) {
    if (!grace_told && stop->elapsed() > silence_to_tell) {
      grace_told = true;
      say(fmt::format(
          "{}: {}, waiting {:g} s at most for the answer to {}, to save the state; once more ends at once",
          m.place(), stop->in_words(), options.deadlines.grace.count(), m.asked));
    }
    return;
  }
  throw Error(stop->code(), m.place(),
              m.asked == "Advance"
                  ? fmt::format("{}, and {} was not answered within the {:g} s that are left for it",
                                stop->in_words(), m.asked, options.deadlines.grace.count())
                  : fmt::format("{} while {} was awaited", stop->in_words(), m.greeted ? m.asked : "Hello"));
}

void Roster::State::check_stop_between(const Member& m) const {
  if (options.stop && options.stop->requested())
    throw Error(options.stop->code(), m.place(), options.stop->in_words());
}

// ---- hearing

void Roster::State::receive(Clock::duration limit) {
  if (auto message = hub.receive(std::chrono::duration_cast<milliseconds>(limit))) hear(std::move(*message));
}

/// Where a participant stands is put into words only when something is wrong.
wire::Reply Roster::State::decode(const Member& m, const wire::Parts& parts) {
  try {
    return wire::decode_reply(parts, m.name);
  } catch (const Error& e) {
    throw Error(e.code(), m.place(), e.problem(), e.fix());
  }
}

void Roster::State::hear(Hub::Message message) {
  for (const auto& m : members) {
    if (!m->greeted || m->peer != message.peer) continue;
    try {
      answered(*m, decode(*m, message.parts));
    } catch (const Error&) {
      m->broken = true;
      throw;
    }
    return;
  }
  greet(message);
}

void Roster::State::answered(Member& m, wire::Reply reply) {
  m.last_heard = Clock::now();
  if (const auto* working = std::get_if<wire::Working>(&reply.what)) {
    if (m.leads && working->fraction < 0)
      say(harmless(working->what));
    else
      m.doing = fmt::format("{} ({:.0f} %)", working->what, 100 * working->fraction);
    return;
  }
  if (const auto* fault = std::get_if<wire::Fault>(&reply.what)) {
    std::string where = fault->where;
    // A solver does not know the window, unless it leads; a fault in a file or an option has its own place.
    if (m.leads) throw Error(fault->code, where, fault->problem, fault->fix);
    if (fault->code == ExitCode::solver_fault || where.empty()) where = with_place(where, m.name, m.place());
    throw Error(fault->code, where, fault->problem, fault->fix);
  }
  if (auto* report = std::get_if<Advanced>(&reply.what);
      report != nullptr && m.leads && m.asked == "Windows") {
    m.reports.push_back(std::move(*report));
    return;
  }
  if (m.may_repeat == reply.sequence && reply.sequence != (m.asked.empty() ? 0 : m.sequence)) {
    m.may_repeat.reset();
    return;
  }
  if (m.asked.empty() || m.reply)
    throw Error(ExitCode::participant_lost, m.place(),
                fmt::format("sent {} without being asked", wire::name_of(reply)), m.see_log());
  if (reply.sequence != m.sequence)
    throw Error(
        ExitCode::participant_lost, m.place(),
        fmt::format("answered request {} when {} (number {}) was asked", reply.sequence, m.asked, m.sequence),
        m.see_log());
  tell_exchange(m, reply);
  m.reply = std::move(reply);
}

void Roster::State::tell_exchange(const Member& m, const wire::Reply& reply) const {
  if (!options.on_exchange || m.asked == "Windows") return;
  const auto nanoseconds = [](Clock::time_point t) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(t.time_since_epoch()).count();
  };
  const bool in_window = m.asked == "Advance";
  options.on_exchange({.participant = m.name,
                       .asked = m.asked,
                       .window = static_cast<long>(m.committed) + (in_window ? 1 : 0),
                       .iteration = in_window ? m.iteration : 0,
                       .sent = nanoseconds(m.asked_at),
                       .heard = nanoseconds(m.last_heard),
                       .received = reply.times.received,
                       .answered = reply.times.answered});
}

void Roster::State::greet(const Hub::Message& message) {
  wire::Reply reply;
  try {
    reply = wire::decode_reply(message.parts, "a stranger");
  } catch (const Error& e) {
    return refuse(message, nullptr, e.problem(), "");
  }
  const auto* hello = std::get_if<wire::Hello>(&reply.what);
  // One whose connection was cut may answer before it notices: its Hello follows, and the answer once more.
  const auto answers = [&](const auto& m) {
    return m->greeted && !m->asked.empty() && m->sequence == reply.sequence;
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
  if (m->greeted && reply.sequence == 0 && hub.connected(m->peer))
    return refuse(message, m, fmt::format("{} already takes part", m->name), "--name");
  if (m->greeted) return welcome_back(*m, message, reply.sequence);
  m->greeted = true;
  take_connection(*m, message.peer);
  m->last_heard = Clock::now();
  m->refusal.clear();
}

/// Of a process that is not ours, only the connection tells whether it lives.
void Roster::State::take_connection(Member& m, const std::string& peer) {
  m.peer = peer;
  hub.admit(peer);
  if (!m.child) hub.keep_witness(peer);
}

/// A participant that was frozen (or a coupler that was) has a new connection. What the old one lost is sent
/// again.
void Roster::State::welcome_back(Member& m, const Hub::Message& message, std::uint64_t last_received) {
  const auto silence = m.silent_since ? Clock::now() - *m.silent_since : Clock::duration(0);
  say(fmt::format("{}: is back after {}", m.place(), in_seconds(silence)));
  take_connection(m, message.peer);
  m.silent_since.reset();
  m.silence_told = false;
  m.last_heard = Clock::now();
  m.may_repeat = last_received;
  if (!m.asked.empty() && !m.reply && last_received < m.sequence) hub.send(m.peer, m.request);
}

void Roster::State::refuse(const Hub::Message& message, Member* m, const std::string& problem,
                           const std::string& fix) {
  note_stranger("refused a participant: " + harmless(problem), 1);
  if (m && !m->greeted) m->refusal = "was refused: " + problem;
  hub.send(message.peer, wire::encode(wire::Request{0, wire::Refused{"coupler", harmless(problem), fix}}));
}

// ---- watching

void Roster::State::look_after_all() {
  for (const auto& m : members) look_after(*m);
  look_after_strangers();
}

void Roster::State::note_stranger(const std::string& what, int times) {
  for (const std::string& line : strangers.note(what, times, Clock::now())) say(line);
}

void Roster::State::look_after_strangers() {
  for (const auto& [what, times] : hub.take_strangers())
    note_stranger("refused a connection: " + what, times);
  for (const std::string& line : strangers.due(Clock::now())) say(line);
}

void Roster::State::look_after(Member& m) {
  if (m.child && !m.may_leave)
    if (const auto exit = m.child->exit()) died(m, *exit);
  if (!m.greeted) return;
  if (hub.connected(m.peer)) {
    m.silent_since.reset();
    return;
  }
  // Heartbeats are answered by a thread of their own: no answer means frozen, or a dead machine.
  const bool has_left = !m.child && hub.left(m.peer);
  if (!m.silent_since) m.silent_since = Clock::now() - (has_left ? Clock::duration(0) : heartbeat_gap);
  const auto silence = Clock::now() - *m.silent_since;
  // One that is alive makes a new connection at once, but inside a step it has no time to say Hello on it.
  const bool perhaps_back = hub.somebody_is_new() && !(m.child && m.child->stopped());
  if (has_left && silence > to_come_back && !perhaps_back) left(m);
  const bool known = m.child || m.started_by_coupler != 0;
  const std::string state = has_left                        ? "has closed its connection"
                            : !known                        ? "is frozen or cannot be reached"
                            : m.child && m.child->stopped() ? "is suspended (" + m.process() + ")"
                                                            : "is frozen (" + m.process() + " lives)";
  if (!m.silence_told && silence > silence_to_tell) {
    m.silence_told = true;
    say(fmt::format("{}: {}, no heartbeat for {}; waiting {}", m.place(), state, in_seconds(silence),
                    options.deadlines.patient
                        ? "until it is back"
                        : fmt::format("{:g} s", options.deadlines.frozen_after.count())));
  }
  if (options.deadlines.patient || silence < options.deadlines.frozen_after) return;
  if (perhaps_back && !m.asked.empty()) return;  // coupling.answer_within ends it
  m.broken = true;
  throw Error(
      ExitCode::participant_lost, m.place(),
      fmt::format("{}: no heartbeat for {}{}", state, in_seconds(silence),
                  m.asked.empty() ? "" : ", " + m.asked + " was awaited"),
      fmt::format("{}, or --patient when debugging; the limit is coupling.frozen_after", m.see_log()));
}

/// One that was started by hand: whether it ended or was killed, only its own shell knows.
void Roster::State::left(Member& m) {
  m.broken = true;
  throw Error(ExitCode::participant_lost, m.place(),
              fmt::format("has ended ({}): its connection was closed at the other end{}", m.process(),
                          m.asked.empty() ? " between two requests" : " while " + m.asked + " was awaited"),
              m.see_log());
}

void Roster::State::died(Member& m, const Exit& exit) {
  m.broken = true;
  const auto end = Clock::now() + last_words;
  while (Clock::now() < end)
    receive(end - Clock::now());  // its Fault, if it sent one, says more: it is thrown
  const std::string what = !m.refusal.empty() ? "\n" + m.refusal
                           : m.follows        ? ""
                           : !m.greeted       ? " before it said Hello"
                           : m.asked.empty()  ? " between two requests"
                                              : fmt::format(" while {} was awaited", m.asked);
  // Before Hello a program can only speak by its exit code.
  ExitCode code = ExitCode::participant_lost;
  for (ExitCode own : {ExitCode::command_line, ExitCode::case_file, ExitCode::cannot_write})
    if (!m.greeted && !m.follows && m.refusal.empty() && exit.signal == 0 &&
        exit.code == static_cast<int>(own))
      code = own;
  throw Error(code, m.place(), fmt::format("{} {}{}{}", m.process(), to_text(exit), what, log_tail(m.log)),
              m.see_log());
}

}  // namespace strake
