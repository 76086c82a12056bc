#include "coupler/processes/stopped_ranks.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace strake {
namespace {

constexpr std::chrono::milliseconds between_looks{250};
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
  next_ = now + between_looks;
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
