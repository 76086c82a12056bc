#include "coupler/watch/run_status.hpp"

#include "coupler/case/case_view.hpp"
#include "coupler/console/console.hpp"
#include "coupler/report/recorded.hpp"
#include "coupler/transport/system_calls.hpp"
#include "proto/descriptor.hpp"
#include "proto/error.hpp"
#include "proto/files/json_file.hpp"
#include "proto/lookup.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fcntl.h>
#include <sstream>
#include <sys/file.h>
#include <sys/stat.h>
#include <tuple>
#include <utility>

namespace strake::watch {
namespace {

namespace fs = std::filesystem;

constexpr double long_silence = 10;  // [s] without a word until a run counts as silent
constexpr double pace_over = 20;     // [s] of wall clock over which the pace is taken

/// "2025-11-21T02:04:42Z" → seconds since 1970.
std::optional<double> clock_of(const std::string& text) {
  std::tm parts{};
  const char* end = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  if (end == nullptr || *end != '\0') return std::nullopt;
  return static_cast<double>(timegm(&parts));
}

bool holds_a_run(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "run.json", error) || fs::exists(folder / "case.toml", error) ||
         fs::exists(folder / "coupler.log", error);
}

/// The state of a run that recorded its end, and its sentence; at: the last window.
std::pair<State, std::string> how_it_ended(int exit_code, const std::string& at) {
  switch (exit_code) {
    case 0:
      return {State::finished, "finished"};
    case 1:
      return {State::finished, "finished, outside tolerance"};
    case 129:
    case 130:
    case 143:
      return {State::stopped, fmt::format("stopped before its end by {}, after {}",
                                          exit_code == 130   ? "Ctrl-C"
                                          : exit_code == 129 ? "SIGHUP"
                                                             : "SIGTERM",
                                          at)};
    default:
      return {State::failed, fmt::format("failed after {}, exit code {}", at, exit_code)};
  }
}

}  // namespace

std::string name_of(State state) {
  constexpr std::array names{"starting", "running", "silent", "finished",
                             "stopped",  "failed",  "killed", "elsewhere"};
  return names.at(static_cast<std::size_t>(state));
}

WatchedRun::WatchedRun(fs::path folder)
    : folder_(std::move(folder)),
      history_(folder_ / "history.csv"),
      iterations_(folder_ / "iterations.csv"),
      timing_(folder_ / "timing.csv") {
  std::error_code error;
  if (!fs::exists(folder_, error))
    throw Error(ExitCode::command_line, folder_.string(), "there is no such run folder",
                "name a folder that `strake run` has made, e.g. runs/plate_entry");
  if (!fs::is_directory(folder_, error))
    throw Error(ExitCode::command_line, folder_.string(), "is a file, not the folder of a run",
                holds_a_run(fs::absolute(folder_).parent_path())
                    ? "name the folder that it lies in: " + fs::absolute(folder_).parent_path().string()
                    : "name the folder that `strake run` has made, e.g. runs/" + folder_.stem().string());
  if (!holds_a_run(folder_))
    throw Error(ExitCode::case_file, folder_.string(), "is not the folder of a run: it has no run.json",
                "name a folder that `strake run` has made, e.g. runs/plate_entry");
}

std::string WatchedRun::name() const {
  return report::name_of_run(folder_);
}

std::string WatchedRun::title() const {
  const std::string title = at_or(keys_, "title");
  return title.empty() ? name() : title;
}

std::optional<double> WatchedRun::number(const std::string& key) const {
  const std::string text = at_or(keys_, key);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return end == text.c_str() ? std::nullopt : std::optional(value);
}

WatchedRun::Stamp WatchedRun::stamp_of(const fs::path& path) {
  struct stat now {};
  if (::stat(path.c_str(), &now) != 0) return {};
  return {.size = now.st_size, .nanoseconds = written_at(path), .inode = now.st_ino};
}

bool WatchedRun::changed(const std::string& file) {
  const Stamp stamp = stamp_of(folder_ / file);
  Stamp& before = stamps_[file];
  if (stamp == before) return false;
  before = stamp;
  return true;
}

void WatchedRun::read_case() {
  keys_.clear();
  probes_.clear();
  const fs::path path = folder_ / "case.toml";
  const std::string echo = read_text(path).value_or("");
  try {
    keys_ = flatten_toml(echo, path.string());
  } catch (const Error&) {  // damaged: title, end and spacing are not known then
    return;
  }
  // Arrays of tables are not among the keys; the echo writes one line per key.
  std::istringstream lines(echo);
  bool probe = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("[")) probe = line.starts_with("[[output.probe]]");
    const std::string name = "name = \"";
    if (probe && line.starts_with(name))
      probes_.push_back(line.substr(name.size(), line.find('"', name.size()) - name.size()));
  }
}

/// True if a run is under way: it then has a lock on its folder (FolderLock). A shared lock is tried and
/// released at once. Some disks have no locks; there the processes are searched.
bool WatchedRun::under_way() const {
  if (!status_.processes.empty()) return true;
  const Descriptor folder(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  return folder && ::flock(folder.get(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

double WatchedRun::last_written() const {
  std::int64_t latest = 0;
  for (const char* file : {"history.csv", "timing.csv", "run.json", "case.toml", "coupler.log", "fluid.log",
                           "structure.log", "summary.json", "trace.json", "frames", "checkpoint"})
    latest = std::max(latest, written_at(folder_ / file));
  return 1e-9 * static_cast<double>(latest);
}

std::optional<double> WatchedRun::time_left() const {
  const auto wall = timing_.find("wall"), clock = timing_.find("time");
  if (!status_.end_time || !wall || !clock || timing_.rows() < 2) return std::nullopt;
  const auto &seconds = timing_.value()[*wall], &time = timing_.value()[*clock];
  double taken = 0;
  std::size_t row = timing_.rows() - 1;
  for (; row > 0 && taken < pace_over; --row) taken += std::isnan(seconds[row]) ? 0 : seconds[row];
  const double done = time.back() - time[row];
  const double left = std::max(0.0, *status_.end_time - time.back());
  return done > 0 && taken > 0 ? std::optional(left * taken / done) : std::nullopt;
}

void WatchedRun::judge() {
  RunStatus& g = status_;
  const auto code = number_of(record_, "exit_code");
  const auto ended = clock_of(string_of(record_, "ended"));
  g.exit_code = code ? std::optional(static_cast<int>(*code)) : std::nullopt;
  const Json& error = member(record_, "error");
  g.error.clear();
  if (error.is_object()) {
    g.error = string_of(error, "where") + ": " + string_of(error, "problem");
    if (const std::string fix = string_of(error, "fix"); !fix.empty()) g.error += "\nfix: " + fix;
  }
  const std::string host = string_of(record_, "host");
  const bool here = host.empty() || host == host_name();
  const std::string at = fmt::format("window {} (t = {:.6g} s)", grouped(g.window), g.time);
  const auto set = [&](State state, std::string words) {
    g.state = state;
    g.words = std::move(words);
  };
  if (ended && g.exit_code) {
    std::tie(g.state, g.words) = how_it_ended(*g.exit_code, at);
    return;
  }
  const std::string nothing = fmt::format("nothing written for {}", duration_text(g.silence));
  if (!here && !under_way()) {
    set(g.silence > long_silence ? State::away : (g.window > 0 ? State::running : State::starting),
        g.silence > long_silence
            ? fmt::format("{}; it was started on {}, and whether it runs there cannot be told from here",
                          nothing, host)
            : (g.window > 0 ? "running on " : "starting on ") + host);
    return;
  }
  if (!under_way()) {
    set(State::killed,
        g.window > 0 ? fmt::format("killed after {}: no process computes it, and no end was recorded", at)
                     : "killed while it started: no process computes it, and no end was recorded");
    return;
  }
  const bool any = g.window > 0;
  if (g.silence > long_silence)
    set(State::silent,
        any ? fmt::format("{}, since {}", nothing, at) : nothing + ", still before its first window");
  else
    set(any ? State::running : State::starting, any ? "running" : "starting: no window is done yet");
}

/// Known processes are read alone; all processes of the machine are searched now and then.
void WatchedRun::find_processes() {
  constexpr std::chrono::seconds between{2};
  constexpr std::size_t most = 3;  // coupler, fluid, structure
  const bool there = refresh(status_.processes);
  if (there && status_.processes.size() == most) return;
  const auto now = std::chrono::steady_clock::now();
  if (there && searched_.time_since_epoch().count() != 0 && now - searched_ < between) return;
  searched_ = now;
  status_.processes = processes_of(string_of(member(record_, "endpoints"), "coupling"));
}

const RunStatus& WatchedRun::update() {
  RunStatus& g = status_;
  if (changed("run.json")) record_ = read_json(folder_ / "run.json");
  if (changed("summary.json")) summary_ = read_json(folder_ / "summary.json");
  if (changed("case.toml")) read_case();
  history_.update();
  iterations_.update();
  timing_.update();

  g.end_time = number("end_time");
  g.time = history_.last("time").value_or(0);
  g.window = static_cast<long>(history_.last("window").value_or(0));
  g.started = clock_of(string_of(record_, "started"));
  const auto ended = clock_of(string_of(record_, "ended"));
  const double clock = 1e-9 * static_cast<double>(clock_now()), written = last_written();
  g.silence = written > 0 ? std::max(0.0, clock - written) : 0;
  if (ended)
    g.processes.clear();
  else
    find_processes();
  judge();
  const double until = ended           ? *ended
                       : open(g.state) ? clock
                                       : std::max(written, g.started.value_or(written));
  g.elapsed = g.started ? std::max(0.0, until - *g.started) : 0;
  // run.json has whole seconds only; the summary of a short run is more exact.
  if (const auto wall = number_of(member(summary_, "seconds"), "wall"); ended && wall) g.elapsed = *wall;
  g.left = g.state == State::running || g.state == State::silent ? time_left() : std::nullopt;
  return g;
}

fs::path newest_run(const fs::path& runs) {
  fs::path newest;
  std::int64_t latest = 0;
  const auto visit = [&](const fs::path& folder, const auto& again, int deeper) -> void {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      if (!entry.is_directory(error)) continue;
      if (!holds_a_run(entry.path())) {
        if (deeper > 0) again(entry.path(), again, deeper - 1);  // the runs of a study
        continue;
      }
      std::int64_t written = 0;
      for (const char* file : {"history.csv", "run.json", "coupler.log"})
        written = std::max(written, written_at(entry.path() / file));
      if (written <= latest) continue;
      latest = written;
      newest = entry.path();
    }
  };
  visit(runs, visit, 1);
  if (newest.empty())
    throw Error(ExitCode::command_line, "strake watch",
                fmt::format("there is no run in the folder {}", runs.string()),
                "name a run folder: strake watch runs/plate_entry");
  return newest;
}

}  // namespace strake::watch
