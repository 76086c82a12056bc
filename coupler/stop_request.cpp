#include "coupler/stop_request.hpp"

#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cassert>

namespace strake {
namespace {

static_assert(std::atomic<int>::is_always_lock_free && std::atomic<long long>::is_always_lock_free,
              "the handler may only touch what needs no lock");
std::atomic<int> received{0};     // the first signal
std::atomic<long long> since{0};  // [ns] its time on the steady clock
std::atomic<bool> installed{false};
std::array<struct sigaction, 2> former;
constexpr std::array<int, 2> signals{SIGINT, SIGTERM};

// Programs such as timeout(1) send one request twice, to the process and to its group.
constexpr long long one_request = 200'000'000;  // [ns]

void on_signal(int number) {
  timespec clock{};
  clock_gettime(CLOCK_MONOTONIC, &clock);  // the clock of std::chrono::steady_clock
  const long long now = static_cast<long long>(clock.tv_sec) * 1'000'000'000 + clock.tv_nsec;
  if (received.load() != 0) {
    if (now - since.load() > one_request) _exit(128 + number);
    return;
  }
  since = now;
  received = number;
}

}  // namespace

StopRequest::StopRequest() {
  assert(!installed.load() && "one StopRequest per process");
  installed = true;
  received = 0;
  struct sigaction action {};
  action.sa_handler = on_signal;  // no SA_RESTART: a wait under way returns
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &action, &former[i]);
}

StopRequest::~StopRequest() {
  for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &former[i], nullptr);
  installed = false;
}

bool StopRequest::requested() const {
  return received.load() != 0;
}

ExitCode StopRequest::code() const {
  switch (received.load()) {
    case 0:
      return ExitCode::done;
    case SIGTERM:
      return ExitCode::terminated;
    default:
      return ExitCode::interrupted;
  }
}

std::string StopRequest::in_words() const {
  return code() == ExitCode::interrupted ? "interrupted by Ctrl-C" : "ended by SIGTERM";
}

std::chrono::steady_clock::duration StopRequest::elapsed() const {
  if (!requested()) return {};
  return std::chrono::steady_clock::now().time_since_epoch() - std::chrono::nanoseconds(since.load());
}

}  // namespace strake
