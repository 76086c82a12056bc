#include "proto/ranks/rank_watch.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <string>
#include <unistd.h>

namespace strake {

namespace {

constexpr std::chrono::milliseconds between_looks{250};
/// Looks in a row that find a rank stopped, after which it is killed: three seconds.
constexpr int patience = 12;

struct Place {
  std::array<char, 64> machine{};
  pid_t process = 0;
};

/// Counts the looks in a row that find the process stopped. A clock would also count the time in which this
/// rank was stopped itself, as all are when a batch system suspends a job. They do not go on at one instant.
void watch(const std::stop_token& stop, const std::string& part, int rank, pid_t process) {
  int stopped = 0;
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(between_looks);
    stopped = is_stopped(process) ? stopped + 1 : 0;
    if (stopped < patience) continue;
    std::fprintf(stderr, "rank %d of the %s is stopped (process %d): the run ends\n", rank, part.c_str(),
                 static_cast<int>(process));
    kill(process, SIGKILL);  // the launcher names it, and ends the others
    return;
  }
}

}  // namespace

bool is_stopped(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(file, text);
  // The name of the program stands in brackets, and may have brackets itself.
  const auto end = text.rfind(')');
  return end != std::string::npos && end + 2 < text.size() && text[end + 2] == 'T';
}

RankWatch::RankWatch(Communicator& ranks, const std::string& part) {
  Place own;
  gethostname(own.machine.data(), own.machine.size() - 1);
  own.process = getpid();
  const std::vector<Place> all = ranks.all(own);
  for (int step = 1; step < ranks.size(); ++step) {
    const int next = (ranks.rank() + step) % ranks.size();
    const Place& place = all[static_cast<std::size_t>(next)];
    if (place.machine != own.machine) continue;
    thread_ = std::jthread([part, next, process = place.process](const std::stop_token& stop) {
      watch(stop, part, next, process);
    });
    return;
  }
}

}  // namespace strake
