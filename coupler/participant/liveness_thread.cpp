#include "coupler/participant/liveness_thread.hpp"

#include "coupler/transport/endpoint.hpp"
#include "proto/files/whole_file.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

namespace strake {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Data for the end of the process, prepared beforehand. The end may come inside a signal handler during a
/// factorisation, where only plain system calls are allowed.
struct LastMoments {
  std::array<char, 512> gone{}, terminated{};  // lines for the log
  std::array<char, 128> socket{},
      folder{};       // of an ipc endpoint: the dead coupler cannot remove them any more
  pid_t coupler = 0;  // our parent, 0 if the coupler did not start us
  pid_t named = 0;    // what STRAKE_COUPLER says: the same, or the coupler above a script that started us
};
LastMoments last_moments;

/// The coupler's process as STRAKE_COUPLER names it; 0 for a participant that is started by hand.
pid_t named_coupler() {
  const char* text = std::getenv("STRAKE_COUPLER");
  return text ? static_cast<pid_t>(std::atol(text)) : 0;
}

/// Whether a process runs. One that has ended and was not reaped yet does not.
bool runs(pid_t pid) {
  std::ifstream stat(fmt::format("/proc/{}/stat", pid));
  const std::string text{std::istreambuf_iterator<char>(stat), {}};
  const std::size_t name_end = text.rfind(')');  // pid (name) state …
  return name_end != std::string::npos && name_end + 2 < text.size() && text[name_end + 2] != 'Z';
}

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
  remove_unfinished_file();  // last: other threads may still begin a file
  _exit(static_cast<int>(ExitCode::participant_lost));
}

bool parent_is_gone() {
  return last_moments.coupler != 0 && getppid() != last_moments.coupler;
}

void on_sigterm(int) {
  write_line(last_moments.terminated);
  remove_unfinished_file();
  _exit(static_cast<int>(ExitCode::terminated));
}

/// The kernel's word that the coupler has died. A signal of its own: SIGTERM may come from the living coupler
/// too, and getppid still names a process of which only the first thread has ended.
constexpr int death_of_parent = SIGHUP;
void on_death_of_parent(int) {
  end_without_coupler();
}

}  // namespace

void end_with_starter() {
  const pid_t starter = named_coupler();
  if (starter == 0) return;
  if (starter == getppid()) prctl(PR_SET_PDEATHSIG, SIGTERM, 0, 0, 0);
  if (!runs(starter) && getppid() != starter) _exit(static_cast<int>(ExitCode::participant_lost));
}

void take_signals() {
  struct sigaction action {};
  action.sa_handler = on_sigterm;
  sigemptyset(&action.sa_mask);
  sigaction(SIGTERM, &action, nullptr);
  signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is an error of the write, reported like a full
                             // disk
  if (last_moments.coupler == 0) return;
  action.sa_handler = on_death_of_parent;
  sigaction(death_of_parent, &action, nullptr);
  signal(SIGINT, SIG_IGN);  // the coupler receives Ctrl-C and ends us in order
}

void prepare_last_moments(const std::string& name, const std::string& endpoint) {
  const pid_t parent = last_moments.named = named_coupler();
  const bool launched = parent != 0 && parent == getppid();
  const std::string whose = parent != 0 ? fmt::format("the coupler (process {})", parent) : "the coupler";
  set_text(last_moments.gone, fmt::format("{}: {} is gone, so this process ends (exit 5)\n", name, whose));
  set_text(last_moments.terminated, fmt::format("{}: ended by SIGTERM\n", name));
  // Removes only folders that the coupler made for itself. The endpoint of a user lies in a folder of the
  // user's.
  const char* own = std::getenv("STRAKE_COUPLER_FOLDER");
  const std::string folder = own ? own : "", path = path_of(endpoint);
  if (launched && !folder.empty() && path.starts_with(folder + "/") &&
      path.size() < last_moments.socket.size()) {
    set_text(last_moments.socket, path);
    set_text(last_moments.folder, folder);
  }
  if (launched) last_moments.coupler = parent;
  take_signals();
  if (!launched) return;
  prctl(PR_SET_PDEATHSIG, death_of_parent, 0, 0, 0);
  if (parent_is_gone()) end_without_coupler();  // it died before the line above
}

bool started_by_coupler() {
  return last_moments.coupler != 0;
}

void Watch::give_up(ExitCode code, const std::string& problem, const std::string& fix) const {
  spdlog::error(to_text(Error(code, endpoint_, problem, fix)));
  remove_unfinished_file();
  _exit(static_cast<int>(code));
}

void Watch::judge(LinkEvent event, int in_a_row, std::chrono::steady_clock::duration since_first) const {
  constexpr int enough = 5;  // a greeting may fail once when a coupler ends or a network is cut
  constexpr std::chrono::seconds crowded{
      5};  // a coupler with a crowd at its port turns some away for a while
  const std::string file = keys_ ? keys_->file.string() : "";
  if (event == LinkEvent::key_refused)
    give_up(ExitCode::command_line, "the coupler does not admit the key " + file,
            "give this machine the key file that `strake keys` made with the coupler's");
  const bool never = event == LinkEvent::no_greeting && in_a_row >= enough && since_first >= crowded;
  if (event != LinkEvent::other_greeting && !never) return;
  // Which end notices first that keys stand on one side only is a matter of luck.
  if (keys_)
    give_up(ExitCode::command_line,
            "what answers there is not the coupler that " + file + " was made with, or one without keys",
            "give this machine the key file that `strake keys` made with the coupler's;\n"
            "leave STRAKE_KEY unset if the case has no coupling.keys");
  give_up(ExitCode::command_line, "what answers there is no coupler, or one that asks for a key",
          "STRAKE_KEY must name the key file of this participant if the case has coupling.keys;\n"
          "the endpoint stands on the coupler's console and in its run.json");
}

void Watch::run(ParticipantSocket& socket) {
  constexpr milliseconds beat{100};
  constexpr std::chrono::seconds to_thaw{10}, to_be_there{30}, to_find_named{1};
  // On one machine a living coupler's kernel accepts at once, even if it is frozen; a network may be cut.
  const milliseconds to_reconnect{leaves_machine(endpoint_) ? 10'000 : 500};
  const auto start = Clock::now();
  bool was_ready = false, accepted = false, told = false;
  Clock::time_point last_accepted;
  int failed = 0;  // consecutive greetings
  Clock::time_point first_failed;
  std::optional<Clock::time_point> lost;
  while (!stop_) {
    if (const auto event = socket.next_event(beat)) {
      if (*event == LinkEvent::connected) accepted = true;
      if (accepted) last_accepted = Clock::now();
      failed = *event == LinkEvent::ready ? 0 : failed + (*event == LinkEvent::no_greeting ? 1 : 0);
      if (failed == 1 && *event == LinkEvent::no_greeting) first_failed = Clock::now();
      if (!was_ready) judge(*event, failed, Clock::now() - first_failed);
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
    if (!was_ready && last_moments.named != 0 && Clock::now() - start > to_find_named &&
        !runs(last_moments.named))
      end_without_coupler();  // it died while this program was loaded
    if (!was_ready && Clock::now() - start > to_be_there)
      give_up(ExitCode::participant_lost,
              fmt::format("no coupler answers there for {} s", to_be_there.count()),
              "the endpoint stands on the coupler's console and in its run.json");
    if (!lost) continue;
    const auto silence = Clock::now() - *lost;
    // One with a crowd at its port accepts, and may close the connection again.
    const bool lives = accepted || Clock::now() - last_accepted < to_reconnect;
    if (last_moments.coupler == 0 &&
        silence > (lives ? Clock::duration(to_thaw) : Clock::duration(to_reconnect)))
      end_without_coupler();
    if (!told && silence > to_reconnect) {
      told = true;
      spdlog::warn("no heartbeat from the coupler, which lives; waiting until it is back");
    }
  }
}

}  // namespace strake
