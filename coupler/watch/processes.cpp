#include "coupler/watch/run_status.hpp"
#include "proto/files/json_file.hpp"
#include "proto/text.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>
#include <unistd.h>

namespace strake::watch {
namespace {

namespace fs = std::filesystem;

/// The words of /proc/PID/cmdline.
std::vector<std::string> words_of(const fs::path& process) {
  const std::string text = read_text(process / "cmdline").value_or("");
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin < text.size();) {
    const auto end = std::min(text.find('\0', begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

std::string option(const std::vector<std::string>& words, const std::string& name) {
  const auto found = std::find(words.begin(), words.end(), name);
  return found == words.end() || found + 1 == words.end() ? std::string() : *(found + 1);
}

struct Stat {
  std::string command;
  char state = '?';
  pid_t parent = 0;
  long long started = 0;
  double cpu_seconds = 0, memory_bytes = 0;
};

/// /proc/PID/stat (proc(5)): pid (comm) state ppid … utime stime are fields 14 and 15, starttime is 22,
/// rss [pages] 24.
std::optional<Stat> stat_of(const fs::path& process) {
  const std::string text = read_text(process / "stat").value_or("");
  const auto open = text.find('('), close = text.rfind(')');
  if (open == std::string::npos || close == std::string::npos || close < open) return std::nullopt;
  std::istringstream fields(text.substr(close + 1));
  std::vector<std::string> field;
  for (std::string word; fields >> word;) field.push_back(word);
  if (field.size() < 22) return std::nullopt;
  const auto number = [&](std::size_t nth) { return std::strtod(field[nth - 3].c_str(), nullptr); };
  Stat stat;
  stat.command = text.substr(open + 1, close - open - 1);
  stat.state = field[0][0];
  stat.parent = static_cast<pid_t>(number(4));
  stat.started = static_cast<long long>(number(22));
  stat.cpu_seconds = (number(14) + number(15)) / static_cast<double>(::sysconf(_SC_CLK_TCK));
  stat.memory_bytes = number(24) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  return stat;
}

/// Endpoints of one run on one machine lie in one private folder: "ipc:///…/strake-x/coupler", ".../fluid".
bool of_one_run(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return false;
  if (a == b) return true;
  const std::string ipc = "ipc://";
  return a.starts_with(ipc) && b.starts_with(ipc) && a.substr(0, a.rfind('/')) == b.substr(0, b.rfind('/'));
}

Process process_of(const std::string& name, pid_t pid, const Stat& stat) {
  return {.name = name,
          .pid = pid,
          .state = stat.state,
          .started = stat.started,
          .cpu_seconds = stat.cpu_seconds,
          .memory_bytes = stat.memory_bytes};
}

}  // namespace

std::string words_for_state(char state) {
  switch (state) {
    case 'R':
      return "computing";
    case 'S':
    case 'I':
      return "waiting";
    case 'D':
      return "waiting for a disk";
    case 'T':
    case 't':
      return "stopped by a signal";
    case 'Z':
    case 'X':
      return "ended";
    default:
      return "unknown";
  }
}

std::vector<Process> processes_of(const std::string& endpoint) {
  std::vector<Process> found;
  if (endpoint.empty()) return found;
  pid_t parent = 0;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/proc", error)) {
    const std::string name = entry.path().filename().string();
    const auto pid = number_from<pid_t>(name);
    if (!pid) continue;
    const std::vector<std::string> words = words_of(entry.path());
    if (!of_one_run(option(words, "--connect"), endpoint)) continue;
    const auto stat = stat_of(entry.path());
    if (!stat) continue;  // it has just ended
    found.push_back(process_of(option(words, "--name"), *pid, *stat));
    parent = stat->parent;
  }
  std::sort(found.begin(), found.end(), [](const Process& a, const Process& b) { return a.name < b.name; });
  if (parent > 1)
    if (const auto stat = stat_of(fs::path("/proc") / std::to_string(parent));
        stat && stat->command == "strake")
      found.insert(found.begin(), process_of("coupler", parent, *stat));
  return found;
}

bool refresh(std::vector<Process>& processes) {
  for (Process& process : processes) {
    const auto stat = stat_of(fs::path("/proc") / std::to_string(process.pid));
    if (!stat || stat->started != process.started) return false;
    process = process_of(process.name, process.pid, *stat);
  }
  return true;
}

}  // namespace strake::watch
