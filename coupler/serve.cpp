#include "coupler/serve.hpp"

#include "coupler/link.hpp"
#include "proto/wire.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sodium.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

namespace strake {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// ---- the end of this process when the coupler is gone

/// What the last moments need, prepared beforehand: they may come inside a signal handler, in the middle of a
/// factorisation, so that nothing but plain system calls is allowed.
struct LastMoments {
  std::array<char, 512> gone{}, terminated{};  // lines for the log
  std::array<char, 128> socket{},
      folder{};       // of an ipc endpoint: the dead coupler cannot remove them any more
  pid_t coupler = 0;  // our parent, 0 if the coupler did not start us
};
LastMoments last_moments;

template <std::size_t n>
void set_text(std::array<char, n>& to, const std::string& from) {
  to.fill('\0');
  std::memcpy(to.data(), from.data(), std::min(from.size(), n - 1));
}

template <std::size_t n>
void write_line(const std::array<char, n>& line) {
  [[maybe_unused]] const ssize_t ignored = write(STDERR_FILENO, line.data(), std::strlen(line.data()));
}

[[noreturn]] void end_without_coupler() {
  write_line(last_moments.gone);
  if (last_moments.socket[0] != '\0') {
    unlink(last_moments.socket.data());
    rmdir(last_moments.folder.data());  // goes if it is empty
  }
  _exit(static_cast<int>(ExitCode::participant_lost));
}

bool parent_is_gone() {
  return last_moments.coupler != 0 && getppid() != last_moments.coupler;
}

void on_sigterm(int) {
  write_line(last_moments.terminated);
  _exit(static_cast<int>(ExitCode::terminated));
}

/// The kernel's word that the coupler has died. A signal of its own: SIGTERM may come from the living coupler
/// too, and getppid still names a process of which only the first thread has ended.
constexpr int death_of_parent = SIGHUP;
void on_death_of_parent(int) {
  end_without_coupler();
}

/// Libraries that a solver starts (MPI, PETSc) may have their own ideas about signals: called again after
/// Setup.
void take_signals() {
  struct sigaction action {};
  action.sa_handler = on_sigterm;
  sigemptyset(&action.sa_mask);
  sigaction(SIGTERM, &action, nullptr);
  if (last_moments.coupler == 0) return;
  action.sa_handler = on_death_of_parent;
  sigaction(death_of_parent, &action, nullptr);
  signal(SIGINT, SIG_IGN);  // the coupler hears Ctrl-C and ends us in order
}

void prepare_last_moments(const ServeOptions& options) {
  const char* coupler = std::getenv("STRAKE_COUPLER");
  const pid_t parent = coupler ? static_cast<pid_t>(std::atol(coupler)) : 0;
  const bool launched = parent != 0 && parent == getppid();
  const std::string whose = parent != 0 ? fmt::format("the coupler (process {})", parent) : "the coupler";
  set_text(last_moments.gone,
           fmt::format("{}: {} is gone, so this process ends (exit 5)\n", options.name, whose));
  set_text(last_moments.terminated, fmt::format("{}: ended by SIGTERM\n", options.name));
  const std::string path = options.endpoint.starts_with("ipc://") ? options.endpoint.substr(6) : "";
  const std::string folder = path.substr(0, path.rfind('/'));
  if (folder.find("/strake-") != std::string::npos && path.size() < last_moments.socket.size()) {
    set_text(last_moments.socket, path);  // the coupler's own folder, not an endpoint of the user's
    set_text(last_moments.folder, folder);
  }
  if (launched) last_moments.coupler = parent;
  take_signals();
  if (!launched) return;
  prctl(PR_SET_PDEATHSIG, death_of_parent, 0, 0, 0);
  if (parent_is_gone()) end_without_coupler();  // it died before the line above
}

// ---- the watch thread

/// Watches parent and connection while the numerics run.
class Watch {
 public:
  explicit Watch(Line& line) : thread_([this, &line] { run(line); }) {}
  ~Watch() {
    stop_ = true;
    thread_.join();
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// Whether the connection has been made anew since the last call: the other side must hear Hello again.
  bool take_renewed() { return renewed_.exchange(false); }

 private:
  void run(Line& line);

  std::atomic<bool> stop_{false}, renewed_{false};
  std::thread thread_;
};

void Watch::run(Line& line) {
  constexpr milliseconds beat{100};
  constexpr milliseconds to_reconnect{
      500};  // a living coupler's kernel accepts at once, even if it is frozen
  constexpr std::chrono::seconds to_thaw{10}, to_be_there{30};
  const auto start = Clock::now();
  bool was_ready = false, accepted = false, told = false;
  std::optional<Clock::time_point> lost;
  while (!stop_) {
    if (const auto event = line.next_event(beat)) {
      if (*event == LinkEvent::connected) accepted = true;
      if (*event == LinkEvent::ready) {
        if (lost) spdlog::info("the coupler is back");
        if (was_ready) renewed_ = true;
        was_ready = true;
        lost.reset();
        told = false;
      }
      if (*event == LinkEvent::disconnected) {
        accepted = false;
        if (was_ready && !lost) lost = Clock::now();
      }
    }
    if (parent_is_gone()) end_without_coupler();
    if (!was_ready && Clock::now() - start > to_be_there) {
      spdlog::error("no coupler answers at the endpoint; see its console for the right one");
      _exit(static_cast<int>(ExitCode::participant_lost));
    }
    if (!lost) continue;
    const auto silence = Clock::now() - *lost;
    if (last_moments.coupler == 0 &&
        silence > (accepted ? Clock::duration(to_thaw) : Clock::duration(to_reconnect)))
      end_without_coupler();
    if (!told && silence > to_reconnect) {
      told = true;
      spdlog::warn("no heartbeat from the coupler, which lives; waiting until it is back");
    }
  }
}

// ---- serving

std::int64_t steady_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}

std::string raw_bytes(const std::string& hexadecimal) {
  std::string bytes(hexadecimal.size() / 2, '\0');
  std::size_t length = 0;
  if (sodium_hex2bin(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), hexadecimal.data(),
                     hexadecimal.size(), nullptr, &length, nullptr) != 0)
    throw Error(ExitCode::command_line, "STRAKE_TOKEN", "is not hexadecimal",
                "give it the token that the coupler printed");
  bytes.resize(length);
  return bytes;
}

/// One participant and its conversation.
class Server {
 public:
  Server(const ServeOptions& options, const ParticipantFactory& factory)
      : options_(options), factory_(factory), line_(options.endpoint), watch_(line_) {}

  int run();
  void working(double fraction, const std::string& what);

 private:
  wire::Request next_request();
  void say_hello();
  void send(wire::Reply);
  void renew();
  /// False after Stop.
  bool answer(wire::Request);
  wire::Reply reply(const Setup&);
  wire::Reply reply(const wire::Advance&);
  wire::Reply reply(const wire::Checkpoint&);
  wire::Reply reply(const wire::Stop&);
  wire::Reply reply(const wire::Refused&);
  void settle(wire::Before, bool write_output);
  Participant& participant(const char* message);

  const ServeOptions& options_;
  const ParticipantFactory& factory_;
  Line line_;
  Watch watch_;
  std::unique_ptr<Participant> participant_;
  std::uint64_t sequence_ = 0;  // of the last request
  std::int64_t received_ = 0;   // [ns] when it came
  wire::Parts last_reply_;
  bool stopped_ = false, refused_ = false;
  Clock::time_point last_working_;
};

thread_local Server* serving = nullptr;  // for working()

void Server::say_hello() {
  const std::string hash(options_.case_hash.begin(), options_.case_hash.end());
  line_.send(wire::encode(
      wire::Reply{sequence_, wire::Hello{wire::protocol, options_.name, raw_bytes(options_.token),
                                         options_.solver, options_.version, hash}},
      options_.name));
}

/// After a new connection the coupler knows us by another routing id, and what was under way is lost.
void Server::renew() {
  if (!watch_.take_renewed()) return;
  say_hello();
  if (!last_reply_.empty()) line_.send(last_reply_);
}

void Server::send(wire::Reply message) {
  message.sequence = sequence_;
  message.times = {received_, steady_now()};
  wire::Parts parts = wire::encode(std::move(message), options_.name);
  if (watch_.take_renewed()) say_hello();
  last_reply_ = std::move(parts);
  line_.send(last_reply_);
}

wire::Request Server::next_request() {
  for (;;) {
    renew();
    const auto parts = line_.receive(milliseconds(100));
    if (!parts) continue;
    const std::int64_t received = steady_now();
    wire::Request request = wire::decode_request(*parts);
    if (std::holds_alternative<wire::Refused>(request.what)) return request;
    if (request.sequence == sequence_ && !last_reply_.empty()) {  // sent again over a new connection
      line_.send(last_reply_);
      continue;
    }
    if (request.sequence != sequence_ + 1)
      throw Error(ExitCode::participant_lost, options_.name,
                  fmt::format("the coupler sent request {} after {}", request.sequence, sequence_));
    sequence_ = request.sequence;
    received_ = received;
    return request;
  }
}

Participant& Server::participant(const char* message) {
  if (!participant_)
    throw Error(ExitCode::participant_lost, options_.name,
                fmt::format("the coupler sent {} before Setup", message));
  return *participant_;
}

void Server::settle(wire::Before before, bool write_output) {
  if (before == wire::Before::commit) participant_->commit(write_output);
  if (before == wire::Before::rewind) participant_->rewind();
}

wire::Reply Server::reply(const Setup& setup) {
  if (participant_) throw Error(ExitCode::participant_lost, options_.name, "the coupler sent Setup twice");
  participant_ = factory_(setup);
  take_signals();
  const Description& description = participant_->description();
  for (const std::string& text : description.lines) spdlog::info("{}", text);
  return {0, wire::Ready{participant_->mesh(), description}};
}

wire::Reply Server::reply(const wire::Advance& advance) {
  Participant& p = participant("Advance");
  for (const Sample& sample : advance.input.samples)
    for (const Field& field : sample.fields)
      if (field.value.cols() != p.mesh().position.cols())
        throw Error(ExitCode::participant_lost, options_.name,
                    fmt::format("the coupler sent {} at {} points, the mesh has {}", field.quantity,
                                field.value.cols(), p.mesh().position.cols()));
  settle(advance.before, advance.write_output);
  return {0, p.advance(advance.window, advance.input)};
}

wire::Reply Server::reply(const wire::Checkpoint& checkpoint) {
  Participant& p = participant("Checkpoint");
  settle(checkpoint.before, checkpoint.write_output);
  if (checkpoint.resume)
    p.resume(checkpoint.folder);
  else
    p.checkpoint(checkpoint.folder);
  return {0, wire::Done{}};
}

wire::Reply Server::reply(const wire::Stop& stop) {
  if (participant_ && stop.commit) participant_->commit(stop.write_output);
  if (participant_) participant_->flush();
  participant_.reset();  // Done means that everything is written
  stopped_ = true;
  return {0, wire::Done{}};
}

wire::Reply Server::reply(const wire::Refused& refused) {
  refused_ = true;  // nobody listens to this participant
  throw Error(ExitCode::participant_lost, options_.name,
              "the coupler refused this participant: " + refused.problem, refused.fix);
}

bool Server::answer(wire::Request request) {
  send(std::visit([this](const auto& what) { return reply(what); }, request.what));
  return !stopped_;
}

int Server::run() {
  serving = this;
  say_hello();
  const auto fault = [this](const Error& e) {
    spdlog::error("{}", to_text(e));
    if (!refused_) send({0, wire::Fault{e.where(), e.problem(), e.fix(), e.code()}});
    return static_cast<int>(e.code());
  };
  int code = 0;
  try {
    while (answer(next_request())) {
    }
  } catch (const Error& e) {
    code = fault(e);
  } catch (const std::bad_alloc&) {
    code = fault(
        Error(ExitCode::solver_fault, options_.name, "is out of memory", "a coarser spacing needs less"));
  } catch (const std::exception& e) {
    code = fault(
        Error(ExitCode::our_bug, options_.name, fmt::format("unexpected: {}", e.what()), "please report it"));
  }
  serving = nullptr;
  return code;
}

void Server::working(double fraction, const std::string& what) {
  const auto now = Clock::now();
  if (now - last_working_ < std::chrono::seconds(1)) return;
  last_working_ = now;
  if (watch_.take_renewed()) say_hello();
  line_.send(wire::encode(wire::Reply{sequence_, wire::Working{fraction, what}}, options_.name));
}

}  // namespace

int serve(const ServeOptions& options, const ParticipantFactory& factory) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // a log is read while it is written, and ends with the process
  prepare_last_moments(options);
  spdlog::flush_on(spdlog::level::info);
  spdlog::info("{} {} as {}, process {}, coupler at {}", options.solver, options.version, options.name,
               getpid(), options.endpoint);
  try {
    return Server(options, factory).run();
  } catch (const Error& e) {  // before anybody could hear it
    spdlog::error("{}", to_text(e));
    return static_cast<int>(e.code());
  }
}

void working(double fraction, const std::string& what) {
  if (serving) serving->working(fraction, what);
}

}  // namespace strake
