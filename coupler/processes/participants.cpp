// Requests and replies: the wait loop that receives the messages of all participants of a run.

#include "coupler/participant/stop_request.hpp"
#include "coupler/processes/log_tail.hpp"
#include "coupler/processes/participants_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace strake {
namespace {

using std::chrono::milliseconds;
using Seconds = std::chrono::duration<double>;

constexpr milliseconds beat{50};           // between two tests of the processes, while nothing arrives
constexpr milliseconds stop_to_tell{500};  // until a line says what a requested end waits for

/// Adds the window to the place of a solver's fault. "fluid, pressure" in window 3 becomes "fluid, window 3
/// (t = 2e-05 s), iteration 1, pressure", and "structure (fem), static" has "fem, static" behind it.
std::string with_place(std::string where, const std::string& name, const std::string& place) {
  if (where.starts_with(name)) where.erase(0, name.size());
  if (where.starts_with(", ")) where.erase(0, 2);
  if (const auto end = where.find(')'); where.starts_with(" (") && end != std::string::npos)
    where = where.substr(2, end - 2) + where.substr(end + 1);
  return where.empty() ? place : place + ", " + where;
}

}  // namespace

std::string in_seconds(Clock::duration d) {
  return fmt::format("{:.3g} s", Seconds(d).count());
}

std::string Participants::Member::place() const {
  const auto& [committed, window, iteration, before, write_output] = progress;
  if (iteration > 0)
    return fmt::format("{}, window {} (t = {:.6g} s), iteration {}", name, committed + 1, window.t,
                       iteration);
  if (committed == 0 || window.dt == 0) return name;
  return fmt::format("{}, after window {} (t = {:.6g} s)", name, committed, window.t + window.dt);
}

std::string Participants::Member::process() const {
  if (!child) return "started by hand";
  return fmt::format("process {}", child->pid());
}

std::string Participants::Member::said() const {
  return fmt::format("{} ({:.0f} %)", work.doing, 100 * work.part);
}

std::string Participants::Member::see_log() const {
  return log.empty() ? "see what it printed itself" : "see " + log.string();
}

std::string Participants::Member::fix_launcher() const {
  if (launcher.empty() || has_words_of_ranks(log)) return {};
  if (log_tail(log).find(".launcher: ") != std::string::npos) return {};  // start_ranks says what is wrong
  return launcher + " must start the ranks by the command behind it, as mpirun -n {ranks} does; ";
}

Participants::State::State(Options o)
    : options(std::move(o)),
      socket(options.endpoint, {options.keys, options.unencrypted}),
      token(options.token.empty() ? random_token() : options.token),
      raw_token(bytes_of(token)) {}

Participants::Member* Participants::State::find(const std::string& name) {
  for (const auto& m : members)
    if (m->name == name) return m.get();
  return nullptr;
}

void Participants::State::say(const std::string& line) const {
  if (options.say) options.say(line);
}

// ---- asking and waiting

void Participants::State::ask(Member& m, wire::Request request) {
  request.sequence = ++m.sequence;
  m.asked = wire::name_of(request);
  m.reply.reset();
  m.request = wire::encode(std::move(request));
  m.asked_at = m.last_heard = Clock::now();
  m.tell_after = options.deadlines.tell;
  m.work.doing.clear();
  try {
    socket.send(m.connection.peer, m.request);
  } catch (const Error& e) {
    m.asked.clear();  // it was not
    throw Error(e.code(), m.place(), e.problem(), e.fix());
  }
}

wire::Reply Participants::State::await(Member& m) {
  Clock::time_point looked = Clock::now();
  while (!m.reply) {
    receive(beat);
    if (Clock::now() - looked < beat) continue;
    looked = Clock::now();
    look_after_all();
    check_deadlines(m);
    if (!m.reply) tell_wait(m, looked - m.asked_at);
    if (!m.reply) tell_waiting(m, looked - m.asked_at);
    check_stop(m);
  }
  m.asked.clear();
  m.request.clear();
  return *std::exchange(m.reply, std::nullopt);
}

void Participants::State::await_hello(Member& m) {
  while (!m.connection.greeted) {
    receive(beat);
    look_after_all();
    check_stop(m);
    if (m.connection.greeted) continue;
    const auto waited = Clock::now() - m.expected_since;
    tell_wait(m, waited);
    tell_waiting(m, waited);
    const auto limit = m.child ? options.deadlines.hello : options.deadlines.by_hand;
    if (options.deadlines.patient || waited < limit) continue;
    m.broken = true;
    const std::string refused = m.refusal.empty() ? "" : "\n" + m.refusal;
    if (!m.child)
      throw Error(ExitCode::participant_lost, m.name,
                  fmt::format("has not been started by hand within {}{}", in_seconds(waited), refused),
                  "its command line was printed and stands in run.json; the limit is "
                  "coupling.attach_within, or --patient");
    throw Error(ExitCode::participant_lost, m.name,
                fmt::format("has not said Hello for {} ({} is alive){}{}", in_seconds(waited), m.process(),
                            refused, log_tail(m.log)),
                fmt::format("{}{}, or --patient when debugging", m.fix_launcher(), m.see_log()));
  }
}

/// For whoever shows it in place.
void Participants::State::tell_wait(const Member& m, Clock::duration waited) const {
  if (options.on_wait) options.on_wait({m.name, m.asked, m.work.doing, m.work.part, Seconds(waited).count()});
}

/// Writes one line after a while, then less and less often. The user so knows which participant the run waits
/// for.
void Participants::State::tell_waiting(Member& m, Clock::duration waited) const {
  constexpr Seconds longest{60};
  if (waited < m.tell_after) return;
  m.tell_after += std::min(m.tell_after, longest);
  const std::string alive = m.child ? m.process() + " is alive" : m.process();
  std::string line = "waiting for " + m.place();
  const bool by_hand = m.asked.empty() && !m.child;
  if (by_hand)
    line += fmt::format(", to be started by hand, for {}", in_seconds(waited));
  else if (m.asked.empty())
    line += fmt::format(", started {} ago ({})", in_seconds(waited), alive);
  else
    line += fmt::format(": {} was asked {} ago ({}{})", m.asked, in_seconds(waited), alive,
                        m.work.doing.empty() ? "" : ", last: " + m.said());
  // A participant to be started by hand needs the user now; a computation only needs time, until its deadline
  // nears.
  const Seconds silent = m.asked.empty() ? waited : Clock::now() - m.last_heard;
  const Seconds limit = m.asked.empty() ? options.deadlines.hello : options.deadlines.answer_within;
  if (options.note && !by_hand && silent < limit / 2)
    options.note(line);
  else
    say(line);
}

void Participants::State::check_deadlines(const Member& m) const {
  const auto waited = Clock::now() - m.last_heard;
  if (options.deadlines.patient || m.reply || waited < options.deadlines.answer_within) return;
  throw Error(
      ExitCode::participant_lost, m.place(),
      fmt::format("has not answered {} for {} ({}{}{})", m.asked, in_seconds(waited), m.process(),
                  m.child ? " is alive" : "", m.work.doing.empty() ? "" : ", last: " + m.said()),
      fmt::format("{}, or --patient when debugging; the limit is coupling.answer_within", m.see_log()));
}

void Participants::State::check_stop(const Member& m) {
  const StopRequest* stop = options.stop;
  if (!stop || !stop->requested()) return;
  const bool saves = m.asked == "Checkpoint" || m.asked == "Stop";  // its answer is what the user waits for
  if (saves || (m.asked == "Advance" && stop->elapsed() < options.deadlines.grace)) {
    if (!grace_told && stop->elapsed() > stop_to_tell) {
      grace_told = true;
      const auto limit = saves ? options.deadlines.answer_within : options.deadlines.grace;
      say(fmt::format(
          "{}: {}, waiting {:g} s at most for the answer to {}, to save the state; once more ends at once",
          m.place(), stop->in_words(), limit.count(), m.asked));
    }
    return;
  }
  throw Error(stop->code(), m.place(),
              m.asked == "Advance"
                  ? fmt::format("{}, and {} was not answered within the {:g} s that are left for it",
                                stop->in_words(), m.asked, options.deadlines.grace.count())
                  : fmt::format("{} while {} was awaited", stop->in_words(),
                                m.connection.greeted ? m.asked : "Hello"));
}

void Participants::State::check_stop_between(const Member& m) const {
  if (options.stop && options.stop->requested())
    throw Error(options.stop->code(), m.place(), options.stop->in_words());
}

// ---- hearing

void Participants::State::receive(Clock::duration limit) {
  if (auto message = socket.receive(std::chrono::duration_cast<milliseconds>(limit)))
    hear(std::move(*message));
  if (!returning.empty()) look_after_returning();
}

/// Where a participant stands is put into words only when something is wrong.
wire::Reply Participants::State::decode(const Member& m, const wire::Parts& parts) {
  try {
    return wire::decode_reply(parts, m.name);
  } catch (const Error& e) {
    throw Error(e.code(), m.place(), e.problem(), e.fix());
  }
}

void Participants::State::hear(CouplerSocket::Message message) {
  for (const auto& m : members) {
    if (!m->connection.greeted || m->connection.peer != message.peer) continue;
    try {
      answered(*m, decode(*m, message.parts));
    } catch (const Error&) {
      m->broken = true;
      throw;
    }
    return;
  }
  constexpr std::size_t enough = 100;  // of messages from one that waits to be let in again
  for (Returning& r : returning)
    if (r.hello.peer == message.peer) {
      if (r.rest.size() < enough) r.rest.push_back(std::move(message));
      return;
    }
  greet(message);
}

void Participants::State::answered(Member& m, wire::Reply reply) {
  m.last_heard = Clock::now();
  m.connection.cut_short = 0;
  if (const auto* working = std::get_if<wire::Working>(&reply.what)) {
    m.work.doing = harmless(working->what);
    m.work.part = std::isfinite(working->fraction) ? std::clamp(working->fraction, 0.0, 1.0) : 0;
    return;
  }
  if (const auto* fault = std::get_if<wire::Fault>(&reply.what)) {
    std::string where = fault->where;
    // A solver does not know the window; an error in a file or an option has its own place.
    // "A bug of ours" is believed of our own programs alone.
    const bool bug_of_others = fault->code == ExitCode::our_bug && !m.ours;
    const ExitCode code = bug_of_others ? ExitCode::solver_fault : fault->code;
    const bool of_rank = where.starts_with("rank ");  // of several that are this participant
    if (code == ExitCode::solver_fault || of_rank || where.empty())
      where = with_place(where, m.name, m.place());
    throw Error(code, where, fault->problem, bug_of_others ? m.see_log() : fault->fix);
  }
  // After two new connections in a short time the second brings the Hello of both.
  if (m.may_repeat > 0 && std::holds_alternative<wire::Hello>(reply.what)) return;
  const bool awaited = !m.asked.empty() && !m.reply && reply.sequence == m.sequence;
  if (!awaited && reply.sequence > 0 && reply.sequence <= m.may_repeat) return;
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

void Participants::State::tell_exchange(const Member& m, const wire::Reply& reply) const {
  if (!options.on_exchange) return;
  const auto nanoseconds = [](Clock::time_point t) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(t.time_since_epoch()).count();
  };
  const bool in_window = m.asked == "Advance";
  options.on_exchange({.participant = m.name,
                       .asked = m.asked,
                       .window = static_cast<long>(m.progress.committed) + (in_window ? 1 : 0),
                       .iteration = in_window ? m.progress.iteration : 0,
                       .sent = nanoseconds(m.asked_at),
                       .heard = nanoseconds(m.last_heard),
                       .received = reply.times.received,
                       .answered = reply.times.answered});
}

}  // namespace strake
