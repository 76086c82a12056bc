#pragma once

#include "coupler/participant/long_log.hpp"
#include "coupler/processes/remote.hpp"
#include "coupler/transport/sockets.hpp"
#include "proto/wire/wire.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace strake {

/// Counts what strangers did at the port, for console and log. Each kind is reported when it first happens,
/// then its number at growing intervals. A flood makes lines, and does not fill a disk.
class StrangerLog {
 public:
  using Clock = std::chrono::steady_clock;

  /// Lines that are due now.
  std::vector<std::string> note(const std::string& what, int times, Clock::time_point now);
  std::vector<std::string> due(Clock::time_point now);

 private:
  struct Kind {
    int untold = 0;
    Clock::time_point told;
    Clock::duration quiet;  // until the next line
  };
  std::map<std::string, Kind> kinds_;
};

/// Text of a stranger for a log: one line, without control characters (`visible`), of its first 200 bytes.
std::string harmless(const std::string&);

/// Finds a rank that is stopped by a signal before the first Hello. All others wait for it in the start of
/// MPI. Later the ranks watch one another (proto/ranks/rank_watch.hpp).
class StoppedRanks {
 public:
  using Clock = std::chrono::steady_clock;

  /// Looks at a launcher and at the processes that it has started on this machine, four times a second at
  /// most. Returns one of them that was stopped in all looks of three seconds. A clock would also count the
  /// time in which this process was stopped itself.
  std::optional<pid_t> look(pid_t launcher, Clock::time_point now);

 private:
  Clock::time_point next_;
  std::map<pid_t, int> stopped_;  // looks in a row that have found it stopped
};

}  // namespace strake

/// What Participants and RemoteParticipant share, for the files of this folder alone.
namespace strake {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds silence_to_tell{700};  // until a line says that a participant is silent

std::string in_seconds(Clock::duration);  // "1.25 s"

/// State of one participant in the coupler.
struct Participants::Member {
  std::string name;
  std::optional<Child> child;  // none: started by hand
  bool ours = false;           // a program of Strake that this run started
  std::filesystem::path log;
  LogLength log_length;
  std::string launcher;  // Launch::launcher
  StoppedRanks stopped_ranks;
  Clock::time_point expected_since;
  std::chrono::duration<double> tell_after{0};  // of waiting, until a line says so (again)
  std::string refusal;                          // why its last Hello was refused

  struct Connection {
    bool greeted = false;  // said an accepted Hello
    std::string peer;
    std::optional<Clock::time_point> silent_since;
    bool silence_told = false;
    int cut_short = 0;  // connections in a row that ended in the middle of what it sent
  };
  Connection connection;
  bool broken = false;  // the run ends because of it

  // the request under way
  std::uint64_t sequence = 0;
  std::string asked;  // "Advance"; empty: idle
  wire::Parts request;
  std::optional<wire::Reply> reply;
  std::uint64_t may_repeat = 0;  // answers up to this one may come twice: a new connection repeats them
  Clock::time_point asked_at, last_heard, last_sign;  // of life: a connection that may be its next one
  struct Work {
    std::string doing;  // its last Working
    double part = 0;    // of that, in [0, 1]
  };
  Work work;

  struct Progress {
    std::uint64_t committed = 0;  // windows
    Window window;
    std::uint32_t iteration = 0;  // 0: no window has been started
    wire::Before before = wire::Before::nothing;
    bool write_output = false;
  };
  Progress progress;
  InterfaceMesh mesh;
  Description description;
  std::unique_ptr<RemoteParticipant> remote;

  /// "fluid, window 420 (t = 0.0042 s), iteration 3"; between two windows "fluid, after window 419 (t =
  /// 0.0042 s)".
  std::string place() const;
  /// "process 41273", for messages.
  std::string process() const;
  std::string see_log() const;
  std::string fix_launcher() const;  // empty: it has no launcher, or the log says why no rank has started
  /// "CalculiX computes all 300 windows (34 %)".
  std::string said() const;
};

struct Participants::State {
  explicit State(Options);

  Options options;
  CouplerSocket socket;
  std::string token;      // hexadecimal
  std::string raw_token;  // its bytes
  std::vector<std::unique_ptr<Member>> members;
  StrangerLog strangers;
  /// A participant that says it is back while its old connection stands, with what it has said since.
  struct Returning {
    Member* member = nullptr;
    CouplerSocket::Message hello;
    std::uint64_t last_received = 0;
    Clock::time_point since;
    std::vector<CouplerSocket::Message> rest;
  };
  std::vector<Returning> returning;
  bool ended = false;
  bool grace_told = false;

  Member* find(const std::string& name);
  void await_end(Member&) const;
  void say(const std::string& line) const;
  std::vector<std::string> arguments(const std::string& endpoint, const std::string& name,
                                     const Launch&) const;
  /// What each program of a run finds in its environment: whom it talks to, and as whom.
  std::map<std::string, std::string> connection(const std::string& endpoint, const std::string& name) const;

  void ask(Member&, wire::Request);
  /// The answer to the request under way. Sees to all other participants meanwhile.
  wire::Reply await(Member&);
  template <class Expected>
  Expected await_as(Member&);
  void await_hello(Member&);

  void receive(Clock::duration limit);
  void look_after_all();
  void tell_waiting(Member&, Clock::duration waited) const;
  void tell_wait(const Member&, Clock::duration waited) const;
  void check_deadlines(const Member&) const;
  void check_stop(const Member&);
  void check_stop_between(const Member&) const;  // before a request that begins something new

 private:
  void hear(CouplerSocket::Message);
  static wire::Reply decode(const Member&, const wire::Parts&);
  void greet(const CouplerSocket::Message&);
  void welcome_back(Member&, const CouplerSocket::Message&, std::uint64_t last_received);
  void put_aside(Member&, const CouplerSocket::Message&, std::uint64_t last_received);
  void look_after_returning();
  void refuse(const CouplerSocket::Message&, Member*, const std::string& problem, const std::string& fix);
  void answered(Member&, wire::Reply);
  void tell_exchange(const Member&, const wire::Reply&) const;
  void look_after(Member&);
  void check_ranks(Member&) const;
  void look_after_strangers();
  void note_stranger(const std::string& what, int times);
  void died(Member&, const Exit&);
  [[noreturn]] void left(Member&);
  void check_cut_short(Member&, Clock::duration silence) const;
  void take_connection(Member&, const std::string& peer);
};

template <class Expected>
Expected Participants::State::await_as(Member& m) {
  const std::string asked = m.asked;
  wire::Reply reply = await(m);
  if (auto* value = std::get_if<Expected>(&reply.what)) return std::move(*value);
  m.broken = true;
  throw Error(ExitCode::participant_lost, m.place(),
              std::string("answered ") + asked + " with " + wire::name_of(reply), m.see_log());
}

}  // namespace strake
