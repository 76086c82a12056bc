#include "coupler/study/runner.hpp"

#include "coupler/case/case_queries.hpp"
#include "coupler/case/rank_threads.hpp"
#include "coupler/console/console.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/participant/stop_request.hpp"
#include "proto/files/json_file.hpp"
#include "proto/files/result_file.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <deque>
#include <fstream>
#include <sstream>
#include <thread>

namespace strake::study {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// What a run depends on: the case's bytes, its keys, the files it names, the run it replays.
std::string fingerprint(const Plan& plan, const PlannedRun& run) {
  return run.source + ":" + hexadecimal(case_hash(plan.case_file, run.sets));
}

/// The error in a run's log, without its verdicts and warnings.
std::string problem_in(const fs::path& log) {
  std::ifstream stream(log);
  std::deque<std::string> last;
  const auto is_news = [](const std::string& line) {  // what a quiet run prints besides
    for (const char* word : {"pass  ", "FAIL  ", "not reached  ", "warning  "})
      if (line.starts_with(word)) return true;
    return false;
  };
  for (std::string line; std::getline(stream, line);) {
    if (is_news(line)) continue;
    last.push_back(line);
    if (last.size() > 6) last.pop_front();
  }
  return joined({last.begin(), last.end()}, "\n");
}

/// What a run without a window yet waits for, from its log (WaitLog). Example: "CalculiX computes all 300
/// windows to 0.003 s, 34 % after 20 s".
std::string before_first_window(const fs::path& folder) {
  std::ifstream stream(folder / "coupler.log");
  std::string last;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) last = std::move(line);
  const std::string level = " info ";
  const auto text = last.find(level);
  if (text == std::string::npos || last.find(" % after ") == std::string::npos) return "starting";
  const std::string said = last.substr(text + level.size());
  const auto name = said.find(": ");
  return "(" + (name == std::string::npos ? said : said.substr(name + 2)) + ")";
}

/// Progress of a run, from the last whole line of its history: "34 %".
std::string progress_of(const fs::path& folder, double end_time) {
  std::ifstream stream(folder / "history.csv", std::ios::binary | std::ios::ate);
  const std::streamoff size = stream ? static_cast<std::streamoff>(stream.tellg()) : 0;
  if (size <= 0) return before_first_window(folder);
  const std::streamoff tail = std::min<std::streamoff>(size, 4096);
  std::string text(static_cast<std::size_t>(tail), '\0');
  stream.seekg(size - tail);
  stream.read(text.data(), tail);
  const auto end = text.rfind('\n');
  const auto begin = end == std::string::npos || end == 0 ? std::string::npos : text.rfind('\n', end - 1);
  if (begin == std::string::npos) return before_first_window(folder);
  std::istringstream row(text.substr(begin + 1, end - begin - 1));
  std::string window, time;
  std::getline(row, window, ',');
  std::getline(row, time, ',');
  try {
    return fmt::format("{:.0f} %", 100 * std::stod(time) / end_time);
  } catch (const std::exception&) {
    return before_first_window(folder);  // the header alone
  }
}

/// What the last study left, by run; written anew after each run.
class Ledger {
 public:
  explicit Ledger(const fs::path& folder) : path_(folder / "state.json") {
    const Json before = read_json(path_);
    for (const auto& [run, entry] : before.items())
      if (before.is_object()) data_[run] = entry;
  }
  /// The seconds that a run of these very inputs took, if it was finished.
  bool is_done(const std::string& run, const std::string& print, const fs::path& folder,
               double& seconds) const {
    if (!same(run, print) || string_of(data_.at(run), "state") != "done") return false;
    if (number_of(read_json(folder / "summary.json"), "exit_code") != 0) return false;
    seconds = number_of(data_.at(run), "seconds").value_or(0);
    return true;
  }
  bool same(const std::string& run, const std::string& print) const {
    return data_.contains(run) && member(data_.at(run), "inputs") == print;
  }
  void set(const std::string& run, const std::string& print, const Outcome& outcome) {
    put(run, {{"inputs", print}, {"seconds", outcome.seconds}, {"state", to_text(outcome.state)}});
  }
  void begin(const std::string& run, const std::string& print) {
    put(run, {{"inputs", print}, {"state", "begun"}});
  }

 private:
  void put(const std::string& run, const Json& entry) {
    data_[run] = entry;
    write_text(path_, json_text(data_, 2) + "\n");
  }
  fs::path path_;
  std::map<std::string, Json> data_;
};

struct Running {
  const PlannedRun* run = nullptr;
  Child child;
  Clock::time_point since;
  std::string print;
};

class Performance {
 public:
  Performance(const Plan& plan, const RunnerOptions& options, const StopRequest& stop)
      : plan_(plan), options_(options), stop_(stop), ledger_(options.folder) {}

  std::map<std::string, Outcome> execute() {
    stop_.end_in_order();  // the runs under way would continue without this process
    for (const PlannedRun& run : plan_.runs) look_back(run);
    while (!(waiting_.empty() && running_.empty())) {
      if (stop_.requested()) {
        end_all();
        break;
      }
      start_what_can();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      reap();
      tell_progress();
    }
    return outcomes_;
  }

 private:
  void look_back(const PlannedRun& run) {
    Outcome& outcome = outcomes_[run.name];
    outcome.folder = folder_of(plan_, run, options_.folder);
    print_[run.name] = fingerprint(plan_, run);
    // A replayed record that is made anew makes its replay anew.
    const bool source_new = !run.source.empty() && outcomes_[run.source].state != Outcome::State::done;
    if (!options_.again && !source_new &&
        ledger_.is_done(run.name, print_[run.name], outcome.folder, outcome.seconds)) {
      outcome.state = Outcome::State::done;
      outcome.exit_code = 0;
      say(fmt::format("{:<28} done before, {}", run.name, duration_text(outcome.seconds)));
    } else {
      waiting_.push_back(&run);
    }
  }

  void start_what_can() {
    for (auto next = waiting_.begin(); next != waiting_.end() && running_.size() < jobs();) {
      const PlannedRun& run = **next;
      const Outcome* source = run.source.empty() ? nullptr : &outcomes_[run.source];
      if (source && source->state == Outcome::State::failed) {
        Outcome& outcome = outcomes_[run.name];
        outcome.state = Outcome::State::failed;
        outcome.problem = fmt::format("{}, whose loads it replays, has failed", run.source);
        say(fmt::format("{:<28} left out: {}", run.name, outcome.problem));
        next = waiting_.erase(next);
      } else if (source && source->state != Outcome::State::done) {
        ++next;
      } else {
        start(run);
        next = waiting_.erase(next);
      }
    }
  }

  std::size_t jobs() const { return static_cast<std::size_t>(std::max(1, options_.jobs)); }

  /// Threads of each solver, or of each of its ranks, of the runs that are under way at once, this one among
  /// them. Results are the
  /// same for any number, and threads that take turns on a core cost twice the time.
  int threads_of(const PlannedRun& run) const {
    const std::size_t at_once = std::min(jobs(), running_.size() + waiting_.size());
    const std::size_t cores = std::max(1u, std::thread::hardware_concurrency()),
                      ranks = static_cast<std::size_t>(most_ranks_of(plan_.case_file, run.sets));
    return static_cast<int>(std::max<std::size_t>(1, cores / ranks / std::max<std::size_t>(1, at_once)));
  }

  void start(const PlannedRun& run) {
    const fs::path folder = outcomes_[run.name].folder;
    std::vector<std::string> arguments = arguments_of(plan_, run, options_.folder);
    const auto names_threads = [](const std::string& set) { return set.starts_with("run.threads="); };
    if (std::none_of(run.sets.begin(), run.sets.end(), names_threads))
      arguments.insert(arguments.end(), {"--set", fmt::format("run.threads={}", threads_of(run))});
    std::error_code error;
    if (fs::exists(folder, error)) {
      const bool unfinished = !options_.again && ledger_.same(run.name, print_[run.name]) &&
                              fs::exists(folder / "checkpoint" / "latest", error) &&
                              number_of(read_json(folder / "summary.json"), "exit_code") != 0;
      arguments.push_back(unfinished ? "--resume" : "--force");
    }
    arguments.push_back("--quiet");
    ledger_.begin(run.name, print_[run.name]);
    Launch launch{.program = fs::read_symlink("/proc/self/exe"),
                  .arguments = std::move(arguments),
                  .log = options_.folder / (run.name + ".log"),
                  .threads = 1,
                  .environment = {},
                  .keep_log = false};
    running_.push_back(
        {.run = &run, .child = Child(launch), .since = Clock::now(), .print = print_[run.name]});
  }

  void reap() {
    for (auto now = running_.begin(); now != running_.end();) {
      const auto exit = now->child.exit();
      if (!exit) {
        ++now;
        continue;
      }
      Outcome& outcome = outcomes_[now->run->name];
      outcome.seconds = std::chrono::duration<double>(Clock::now() - now->since).count();
      outcome.exit_code = exit->signal != 0 ? 128 + exit->signal : exit->code;
      outcome.state = outcome.exit_code == 0 ? Outcome::State::done : Outcome::State::failed;
      if (outcome.state == Outcome::State::failed)
        outcome.problem = problem_in(options_.folder / (now->run->name + ".log"));
      ledger_.set(now->run->name, now->print, outcome);
      say(fmt::format("{:<28} {}, {}", now->run->name, to_text(outcome.state),
                      duration_text(outcome.seconds)));
      if (!outcome.problem.empty()) say("  " + outcome.problem);
      now = running_.erase(now);
    }
  }

  /// Ctrl-C: each run saves its state and ends by itself, as it would at its own console.
  void end_all() {
    say(fmt::format("{}: {} run{} under way keep{} what they have, within 30 s; once more ends at once",
                    stop_.in_words(), running_.size(), running_.size() == 1 ? "" : "s",
                    running_.size() == 1 ? "s" : ""));
    for (Running& now : running_) now.child.signal(SIGINT);
    for (Running& now : running_) now.child.wait(std::chrono::seconds(30));
    running_.clear();
  }

  void tell_progress() {
    if (running_.empty() || Clock::now() - told_ < std::chrono::seconds(10)) return;
    told_ = Clock::now();
    std::string line;
    for (const Running& now : running_)
      line += fmt::format("  {} {}", now.run->name,
                          progress_of(outcomes_[now.run->name].folder, end_time(*now.run)));
    say(fmt::format("under way:{}   waiting: {}", line, waiting_.size()));
  }

  double end_time(const PlannedRun& run) {
    const auto known = end_time_.find(run.name);
    if (known != end_time_.end()) return known->second;
    return end_time_[run.name] = common_keys_of(plan_.case_file, run.sets).end_time;
  }

  void say(const std::string& text) {
    if (options_.console) put(options_.console, fmt::format("  {}\n", visible(text)));
  }

  const Plan& plan_;
  const RunnerOptions& options_;
  const StopRequest& stop_;
  Ledger ledger_;
  std::map<std::string, Outcome> outcomes_;
  std::map<std::string, std::string> print_;
  std::map<std::string, double> end_time_;
  std::vector<const PlannedRun*> waiting_;
  std::vector<Running> running_;
  Clock::time_point told_ = Clock::now();
};

}  // namespace

std::string to_text(Outcome::State state) {
  switch (state) {
    case Outcome::State::done:
      return "done";
    case Outcome::State::failed:
      return "failed";
    case Outcome::State::missing:
      break;
  }
  return "missing";
}

fs::path folder_of(const Plan& plan, const PlannedRun& run, const fs::path& study_folder) {
  return study_folder / (plan.case_file.stem().string() + "-" + run.name);
}

std::vector<std::string> arguments_of(const Plan& plan, const PlannedRun& run, const fs::path& folder) {
  std::vector<std::string> arguments;
  if (run.source.empty()) {
    arguments = {"run", plan.case_file.string()};
  } else {
    const fs::path recorded = folder / (plan.case_file.stem().string() + "-" + run.source);
    arguments = {"replay", recorded.string(), "--onto", plan.case_file.string()};
  }
  for (const std::string& set : run.sets) {
    arguments.push_back("--set");
    arguments.push_back(set);
  }
  arguments.insert(arguments.end(), {"--runs", folder.string(), "--tag", run.name});
  return arguments;
}

std::map<std::string, Outcome> perform(const Plan& plan, const RunnerOptions& options,
                                       const StopRequest& stop) {
  return Performance(plan, options, stop).execute();
}

}  // namespace strake::study
