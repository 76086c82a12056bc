// What is done when a participant falls silent, leaves or dies.

#include "coupler/processes/log_tail.hpp"
#include "coupler/processes/participants_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace strake {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds fault_arrives{100};  // a dead process's Fault may still be on its way
constexpr milliseconds heartbeat_gap{500};  // silence before the link counts as cut
constexpr milliseconds to_come_back{500};   // for a new connection after one that the other end closed

}  // namespace

void Participants::State::look_after_all() {
  for (const auto& m : members) look_after(*m);
  look_after_strangers();
}

void Participants::State::look_after(Member& m) {
  if (m.child)
    if (const auto exit = m.child->exit()) return died(m, *exit);
  if (m.child && m.log_length.look(m.log, Clock::now()))
    say(fmt::format("{} prints so much that the middle of {} is left out", m.name,
                    m.log.filename().string()));
  if (!m.connection.greeted) return check_ranks(m);
  if (socket.connected(m.connection.peer)) {
    m.connection.silent_since.reset();
    return;
  }
  // Heartbeats are answered by a thread of their own: no answer means frozen, or a dead machine.
  const bool has_left = !m.child && socket.left(m.connection.peer);
  if (!m.connection.silent_since && socket.cut_short(m.connection.peer)) ++m.connection.cut_short;
  if (!m.connection.silent_since)
    m.connection.silent_since = Clock::now() - (has_left ? Clock::duration(0) : heartbeat_gap);
  check_cut_short(m, Clock::now() - *m.connection.silent_since);
  // A participant that is alive reconnects at once. But inside a step it has no time to send Hello on the
  // connection. On a machine that is short of processors or memory that connection may be cut as well, and
  // the next one: each of them ends the silence.
  const bool perhaps_back = socket.somebody_is_new() && !(m.child && m.child->stopped());
  if (perhaps_back && !m.asked.empty()) m.last_sign = Clock::now();
  const auto silence = Clock::now() - std::max(*m.connection.silent_since, m.last_sign);
  if (has_left && silence > to_come_back && !perhaps_back) left(m);
  const std::string state = has_left   ? "has closed its connection"
                            : !m.child ? "is frozen or cannot be reached"
                            : m.child && m.child->stopped()
                                ? "is suspended (" + m.process() + ")"
                                : "is frozen or gets no processor (" + m.process() + " lives)";
  if (!m.connection.silence_told && silence > silence_to_tell) {
    m.connection.silence_told = true;
    say(fmt::format("{}: {}, no heartbeat for {}; waiting {}", m.place(), state, in_seconds(silence),
                    options.deadlines.patient
                        ? "until it is back"
                        : fmt::format("{:g} s", options.deadlines.frozen_after.count())));
  }
  if (options.deadlines.patient || silence < options.deadlines.frozen_after) return;
  m.broken = true;
  throw Error(
      ExitCode::participant_lost, m.place(),
      fmt::format("{}: no heartbeat for {}{}", state, in_seconds(silence),
                  m.asked.empty() ? "" : ", " + m.asked + " was awaited"),
      fmt::format("{}, or --patient when debugging; the limit is coupling.frozen_after", m.see_log()));
}

/// Ends the run where one of several ranks is stopped before the first Hello.
void Participants::State::check_ranks(Member& m) const {
  if (!m.child || m.launcher.empty() || options.deadlines.patient) return;
  const auto stopped = m.stopped_ranks.look(m.child->pid(), Clock::now());
  if (!stopped) return;
  m.broken = true;
  throw Error(ExitCode::participant_lost, m.place(),
              fmt::format("one of its ranks or their launcher is stopped (process {}) before the first Hello",
                          *stopped),
              m.see_log() + ", or --patient when debugging");
}

/// ZeroMQ cuts the connection of whoever sends a part that is too large. A participant of Strake never does;
/// it may be cut once after the coupler was frozen, and is then back at once.
void Participants::State::check_cut_short(Member& m, Clock::duration silence) const {
  const std::chrono::duration<double> patience(2);
  if (m.connection.cut_short == 0) return;
  if (m.connection.cut_short < 2 && silence < std::min(patience, options.deadlines.frozen_after)) return;
  m.broken = true;
  throw Error(
      ExitCode::participant_lost, m.place(),
      fmt::format("its connection was cut while it sent {}: a part of a message may have at most {} MB",
                  m.asked.empty() ? "something" : "its answer to " + m.asked, CouplerSocket::most_megabytes),
      "a coarser interface mesh; " + m.see_log());
}

/// A participant started by hand: only its own shell knows whether it ended or was killed.
void Participants::State::left(Member& m) {
  m.broken = true;
  throw Error(ExitCode::participant_lost, m.place(),
              fmt::format("has ended ({}): its connection was closed at the other end{}", m.process(),
                          m.asked.empty() ? " between two requests" : " while " + m.asked + " was awaited"),
              m.see_log());
}

void Participants::State::died(Member& m, const Exit& exit) {
  const auto end = Clock::now() + fault_arrives;
  const auto has_stopped = [&] { return m.asked == "Stop" && m.reply; };
  while (Clock::now() < end && !has_stopped())
    receive(end - Clock::now());  // its Fault, if it sent one, says more: it is thrown
  if (has_stopped()) return;      // a regular end: its last answer lay behind another word of it
  m.broken = true;
  const std::string what = !m.refusal.empty()      ? "\n" + m.refusal
                           : !m.connection.greeted ? " before it said Hello"
                           : m.asked.empty()       ? " between two requests"
                                                   : fmt::format(" while {} was awaited", m.asked);
  // Before Hello a program can report only by its exit code.
  ExitCode code = ExitCode::participant_lost;
  for (ExitCode own : {ExitCode::command_line, ExitCode::case_file, ExitCode::cannot_write})
    if (!m.connection.greeted && m.refusal.empty() && exit.signal == 0 && exit.code == static_cast<int>(own))
      code = own;
  std::string fix = m.connection.greeted ? "" : m.fix_launcher();
  if (!m.connection.greeted && fix.empty() && exit.signal == 0 && exit.code == 0)
    fix = "a solver in Python ends with CLASS.main(); ";
  if (fix.empty() && exit.signal == 0 && exit.code == 1) fix = missing_module(m.log);
  throw Error(code, m.place(), fmt::format("{} {}{}{}", m.process(), to_text(exit), what, log_tail(m.log)),
              fix + m.see_log());
}

namespace {

constexpr std::chrono::milliseconds between_rank_looks{250};
constexpr int patience = 12;  // looks: three seconds, as the ranks have for one another

/// Returns a process and all that it has started, and so on.
std::vector<pid_t> with_descendants(pid_t process) {
  std::vector<pid_t> found{process};
  for (std::size_t k = 0; k < found.size(); ++k) {
    std::error_code ended;
    std::filesystem::directory_iterator task(fmt::format("/proc/{}/task", found[k]), ended);
    for (; !ended && task != std::filesystem::directory_iterator(); task.increment(ended)) {
      std::ifstream list(task->path() / "children");
      for (pid_t child = 0; list >> child;) found.push_back(child);
    }
  }
  return found;
}

bool is_stopped(pid_t process) {
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string text;
  std::getline(file, text);
  const auto name_end = text.rfind(')');  // pid (name) state …
  return name_end != std::string::npos && name_end + 2 < text.size() && text[name_end + 2] == 'T';
}

}  // namespace

std::optional<pid_t> StoppedRanks::look(pid_t launcher, Clock::time_point now) {
  if (now < next_) return {};
  next_ = now + between_rank_looks;
  std::map<pid_t, int> stopped;
  for (const pid_t process : with_descendants(launcher)) {
    if (!is_stopped(process)) continue;
    const auto before = stopped_.find(process);
    stopped[process] = 1 + (before == stopped_.end() ? 0 : before->second);
    if (stopped[process] >= patience) return process;
  }
  stopped_ = std::move(stopped);
  return {};
}

}  // namespace strake
