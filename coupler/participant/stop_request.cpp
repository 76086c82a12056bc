#include "coupler/participant/stop_request.hpp"

#include <time.h>

#include <array>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <signal.h>
#include <string_view>
#include <unistd.h>

namespace strake {
namespace {

static_assert(std::atomic<int>::is_always_lock_free && std::atomic<long long>::is_always_lock_free,
              "the handler may only touch what needs no lock");
std::atomic<int> received{0};        // the first signal
std::atomic<long long> since{0};     // [ns] its time on the steady clock
std::atomic<bool> looked_at{false};  // since the first signal
std::atomic<bool> in_order{false};
std::atomic<bool> installed{false};
constexpr std::array<int, 4> signals{SIGINT, SIGTERM, SIGHUP, SIGALRM};
std::array<struct sigaction, signals.size()> former;
constexpr unsigned longest_unheard = 1;  // [s]

// Programs such as timeout(1) send one request twice, to the process and to its group.
constexpr long long one_request = 200'000'000;  // [ns]

void on_signal(int number) {
  const int before = errno;
  timespec clock{};
  clock_gettime(CLOCK_MONOTONIC, &clock);  // the clock of std::chrono::steady_clock
  const long long now = static_cast<long long>(clock.tv_sec) * 1'000'000'000 + clock.tv_nsec;
  if (received.load() == 0) {
    since = now;
    received = number;
    alarm(longest_unheard);
  } else if (number != SIGHUP && now - since.load() > one_request) {  // a terminal that goes may say so twice
    _exit(128 + number);
  }
  errno = before;
}

/// Runs a second after the first signal. If the flag was not tested, it ends the process or writes a line.
void on_alarm(int) {
  constexpr std::string_view line =
      "strake: the signal was heard; what is under way is finished first, one more ends at once\n";
  const int before = errno;
  if (!looked_at && !in_order) _exit(128 + received.load());
  if (!looked_at) {
    [[maybe_unused]] const ssize_t ignored = write(STDERR_FILENO, line.data(), line.size());
  }
  errno = before;
}

}  // namespace

StopRequest::StopRequest() {
  assert(!installed.load() && "one StopRequest per process");
  installed = true;
  received = 0;
  looked_at = in_order = false;
  struct sigaction action {};
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < signals.size(); ++i) {
    action.sa_handler = signals[i] == SIGALRM ? on_alarm : on_signal;
    action.sa_flags = signals[i] == SIGALRM ? SA_RESTART : 0;  // a wait under way returns at the signal
    sigaction(signals[i], &action, &former[i]);
    const bool left_running = signals[i] == SIGHUP && former[i].sa_handler == SIG_IGN;  // nohup
    if (left_running) sigaction(SIGHUP, &former[i], nullptr);
  }
}

StopRequest::~StopRequest() {
  alarm(0);
  for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &former[i], nullptr);
  installed = false;
}

bool StopRequest::requested() const {
  const bool is = received.load() != 0;
  if (is) looked_at = true;
  return is;
}

void StopRequest::end_in_order() const {
  in_order = true;
}

ExitCode StopRequest::code() const {
  switch (received.load()) {
    case 0:
      return ExitCode::done;
    case SIGTERM:
      return ExitCode::terminated;
    case SIGHUP:
      return ExitCode::hung_up;
    default:
      return ExitCode::interrupted;
  }
}

std::string StopRequest::in_words() const {
  if (code() == ExitCode::hung_up) return "ended by SIGHUP (the terminal is gone)";
  return code() == ExitCode::interrupted ? "interrupted by Ctrl-C" : "ended by SIGTERM";
}

std::chrono::steady_clock::duration StopRequest::elapsed() const {
  if (!requested()) return {};
  return std::chrono::steady_clock::now().time_since_epoch() - std::chrono::nanoseconds(since.load());
}

}  // namespace strake
