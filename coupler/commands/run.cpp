#include "coupler/case/case_view.hpp"
#include "coupler/case/find_case.hpp"
#include "coupler/case/rank_threads.hpp"
#include "coupler/case/side_programs.hpp"
#include "coupler/commands/commands.hpp"
#include "coupler/commands/run_messages.hpp"
#include "coupler/participant/stop_request.hpp"
#include "coupler/run/checkpoint.hpp"
#include "coupler/run/run_files.hpp"
#include "coupler/run/run_folder.hpp"
#include "coupler/run/run_log.hpp"
#include "coupler/run/session.hpp"
#include "coupler/summary/summary.hpp"
#include "coupler/timing/run_clocks.hpp"
#include "proto/case/size_limit.hpp"
#include "proto/error.hpp"
#include "proto/files/json_file.hpp"
#include "proto/files/result_file.hpp"
#include "proto/peak_memory.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

namespace strake {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// One run, from its folder to its last file.
class Run {
 public:
  Run(const CaseView& view, RunFolder folder, const RunOptions& options, const StopRequest& stop,
      Reporter& reporter)
      : case_(view),
        folder_(std::move(folder)),
        lock_(folder_.path),
        options_(options),
        stop_(stop),
        messages_{reporter},
        record_(folder_.path, options.command_line),
        summary_(folder_.case_name, folder_.tag),
        verdicts_(view),
        clocks_(folder_.path,
                {.trace = options.trace, .profile = options.profile, .resumed = options.folder.resume}),
        checkpoints_(std::filesystem::absolute(folder_.path)) {}

  ExitCode execute() {
    stop_.end_in_order();
    try {
      prepare();
      windows();
      session_->participants().finish();
      conclude(ExitCode::done);
    } catch (const Error& error) {
      // Not for what stops a run before it begins.
      const std::filesystem::path last = started_ ? checkpoints_.latest() : std::filesystem::path();
      const Error told =
          started_ && !saved_on_request_
              ? with_resume_hint(error, last.empty() ? last : std::filesystem::path(in_folder(last)), saved_,
                                 summary_, cannot_resume())
              : error;
      fail(told);
      throw told;
    } catch (const std::exception& error) {
      const Error told = error_of(error, position());
      fail(told);
      throw told;
    }
    if (options_.strict && !summary_.alarms().empty()) return ExitCode::outside_tolerance;
    for (const Verdict& verdict : summary_.verdicts)
      if (options_.strict && verdict.result == Verdict::Result::fail) return ExitCode::outside_tolerance;
    return ExitCode::done;
  }

 private:
  void prepare() {
    const bool resume = options_.folder.resume;
    std::filesystem::path checkpoint;
    if (resume) {
      check_same_case(case_, folder_.path);
      check_can_resume(string_of(read_json(folder_.path / "run.json"), "cannot_resume"), folder_.path);
      checkpoint = checkpoints_.choose([this](const std::string& line) { messages_.warn(line); });
      check_end_time(case_, folder_.path, checkpoint);
      remove_unfinished(folder_.path);
    }
    begin_record();
    clocks_.open();
    open_session(resume ? std::optional(Checkpoints::window_of(checkpoint) + 1) : std::nullopt);
    if (resume) check_can_resume(cannot_resume(), folder_.path);
    if (!cannot_resume().empty()) record_.set("cannot_resume", cannot_resume());
    plan_ = resume ? checkpoints_.resume(checkpoint, *session_, summary_) : session_->plan();
    if (resume) record_.set("resumed_at", {{"window", plan_.start.windows}, {"time", plan_.start.time}});
    saved_ = plan_.start;
    wall_before_ = summary_.wall_seconds;
    record_.write();
    open_files();
    summary_.describe(files_->table().columns);
    summary_.resolution = session_->resolution();
    summary_.mechanical = session_->is_mechanical();
    summary_.bodies = case_.bodies();
    summary_.coupler_seconds["setup"] = seconds_since(start_);

    const RunHeader header =
        header_of(case_, *session_, plan_, folder_.path, files_->table().columns, resume);
    for (const auto& [name, lines] : header.blocks)
      for (const std::string& line : lines) messages_.log->info(fmt::format("{}: {}", name, line));
    for (const std::string& warning : header.warnings) messages_.log->warn(warning);
    messages_.reporter.start(header);
  }

  /// The first files of the folder: what is run, by whom, and the log.
  void begin_record() {
    recorded_ = true;
    record_.set("case", std::filesystem::absolute(case_.path).string());
    record_.set("tag", folder_.tag);
    record_.set("set", case_.sets);
    record_.set("threads", most_threads_of(case_));
    for (const SideView* side : case_.sides()) programs_[side->side] = record_of(case_, *side);
    if (const Json lines = record_attachments(case_, programs_); !lines.empty())
      record_.set("attachments", lines);
    record_.set("participants", programs_);
    record_.write();  // the first file: by it the folder is known as a run's
    messages_.log = open_run_log(folder_.path / "coupler.log");
    write_text(folder_.path / "case.toml", case_.resolved);
    for (const SideView* side : case_.sides())
      if (is_large(*side))
        messages_.warn(side->side + ", long to set up: " + lines_with(size_words, *side).front());
  }

  /// Starts the participants.
  void open_session(std::optional<long> resumed_at) {
    const std::filesystem::path absolute = std::filesystem::absolute(folder_.path);
    session_ = std::make_unique<Session>(
        case_, Session::Options{.run_folder = absolute,
                                .log_folder = absolute,
                                .resumed_at = resumed_at,
                                .patient = options_.patient,
                                .by_hand = options_.by_hand,
                                .invite = [this](const std::string& side,
                                                 const std::string& command) { invite(side, command); },
                                .say = [this](const std::string& line) { messages_.warn(line); },
                                .note = [this](const std::string& line) { messages_.note(line); },
                                .stop = &stop_,
                                .on_exchange = clocks_.observer(),
                                .on_wait = [this](const Awaited& whom) { messages_.wait(whom, elapsed()); }});
    record_.set("endpoints", {{"coupling", session_->participants().endpoint()}});
  }

  /// The files that grow with each window.
  void open_files() {
    RunFiles::Options files{.folder = folder_.path,
                            .coupled = case_.coupled(),
                            .dimension = session_->dimension(),
                            .columns = session_->columns(),
                            .mesh = {},
                            .initial = {},
                            .measured = {},
                            .resumed = options_.folder.resume ? std::optional(plan_.start) : std::nullopt,
                            .say = [this](const std::string& line) { messages_.warn(line); }};
    if (case_.coupled()) {
      files.mesh = session_->structure()->mesh();
      files.initial = session_->structure()->description().initial;
      files.measured = session_->scheme()->measured();
      files.mechanical = session_->scheme()->is_mechanical();
    }
    files_ = std::make_unique<RunFiles>(std::move(files));
  }

  void windows() {
    started_ = true;
    MonitorNotes notes(case_, plan_.start.time, session_->columns());
    WindowLoop loop = session_->loop(plan_);
    auto saved = Clock::now();
    while (!loop.finished()) {
      if (stop_.requested()) interrupt(loop);
      const auto begin = Clock::now();
      const std::int64_t trace_begin = Trace::now();
      const CommittedWindow window = next(loop);
      const double wall = seconds_since(begin);
      const std::int64_t trace_end = Trace::now();
      summary_.coupler_seconds["windows"] += wall;
      summary_.add(window);
      files_->append(window, session_->values(window.report), wall);
      RunRow row{.window = &window,
                 .force = window.report.total_force(),
                 .elapsed = elapsed(),
                 .history = &files_->table()};
      messages_.reporter.window(row);
      notes.tell(window.report, messages_);
      if (window.taken_back > 0)
        messages_.log->warn(
            fmt::format("window {} (t = {:.6g} s): {}; {} longer window{} taken back, now {:.3g} s",
                        window.number, window.time, window.why, window.taken_back,
                        window.taken_back == 1 ? "" : "s", window.report.window.dt));
      if (!window.report.converged)
        messages_.log->warn(
            fmt::format("window {} (t = {:.6g} s): accepted unconverged, residual {:.2e}, wanted {:.2e}",
                        window.number, window.time, window.report.residual, window.report.threshold));
      tell_verdicts();
      const int every = case_.coupling.checkpoint_windows;
      const bool due = every > 0 && window.number % every == 0;
      const bool late = seconds_since(saved) > case_.coupling.checkpoint;
      if (!window.last && (due || late)) {
        save(loop);
        saved = Clock::now();
      }
      summary_.coupler_seconds["files"] += seconds_since(begin) - wall;
      clocks_.end_window(window, trace_begin, trace_end);
      messages_.console.look(*messages_.log, folder_.path / "coupler.log");
    }
  }

  CommittedWindow next(WindowLoop& loop) {
    try {
      return loop.next();
    } catch (const Error& error) {
      // Ctrl-C inside a window: the windows before it are kept, if the solvers answer in time.
      const bool asked_to_stop = stop_.requested() && error.code() == stop_.code();
      if (asked_to_stop && session_->participants().come_to_rest()) interrupt(loop);
      throw;
    }
  }

  std::string cannot_resume() const { return session_ ? session_->cannot_resume() : ""; }
  void save(const WindowLoop& loop) {
    if (!cannot_resume().empty()) return;
    summary_.wall_seconds = elapsed();
    files_->flush();  // state from which a resume continues
    checkpoints_.write(*session_, loop, summary_);
    saved_ = loop.state();
  }

  /// Ctrl-C between two windows: the participants are at rest, so that what is committed can be kept.
  [[noreturn]] void interrupt(const WindowLoop& loop) {
    if (!cannot_resume().empty()) throw Error(stop_.code(), position(), stop_.in_words());
    save(loop);
    saved_on_request_ = true;
    throw Error(stop_.code(), position(), stop_.in_words() + ", the state is saved",
                fmt::format("--resume goes on with this window, from {}; no finished window is lost",
                            in_folder(checkpoints_.latest())));
  }

  /// A checkpoint, as the user would type it.
  std::string in_folder(const std::filesystem::path& checkpoint) const {
    return (folder_.path / "checkpoint" / checkpoint.filename()).string();
  }

  double elapsed() const { return wall_before_ + seconds_since(start_); }

  RunData data(bool finished) const {
    return {.monitor = summary_.probe_results(),
            .history = files_ ? &files_->table() : nullptr,
            .time = summary_.end_time(),
            .finished = finished};
  }

  void tell_verdicts() {
    for (const Verdict& verdict : verdicts_.settle(data(false))) {
      messages_.reporter.verdict(verdict);
      messages_.log->info(verdict.line());
    }
  }

  /// Everything that says how it ended. Run after the processes are gone, so that their files are complete.
  void conclude(ExitCode code) {
    session_.reset();
    if (files_) files_->flush();
    write_end(code);
  }

  void write_end(ExitCode code) {
    summary_.exit_code = code;
    summary_.wall_seconds = elapsed();
    summary_.coupler_seconds["cpu"] = cpu_seconds();
    summary_.coupler_memory = peak_memory();
    if (files_) summary_.take_history(files_->table());
    summary_.verdicts = verdicts_.all(data(code == ExitCode::done));
    write_text(folder_.path / "summary.json", json_text(summary_.json(), 2) + "\n");
    record_.set("contact", contact_times(summary_));
    if (code == ExitCode::done) record_.ended(code);
    record_.write();
    if (messages_.log) messages_.log->info(fmt::format("exit code {}", static_cast<int>(code)));

    clocks_.close();
    if (started_) messages_.reporter.end(end_of(code, summary_, folder_.path, clocks_.profile()));
  }

  void fail(const Error& error) noexcept {
    // The error that stopped the run is rethrown: it counts more than a trace that cannot be written.
    const auto attempt = [](const auto& write) {
      try {
        write();
      } catch (const std::exception&) {
      }
    };
    session_.reset();
    attempt([&] {
      if (messages_.log) messages_.log->error(to_text(error));
      messages_.reporter.error(error);
    });
    // A refused case leaves no folder: the corrected one may take its name.
    if (!started_ && !options_.folder.resume &&
        (error.code() == ExitCode::case_file || error.code() == ExitCode::command_line)) {
      messages_.log.reset();
      std::error_code ignored;
      std::filesystem::remove_all(folder_.path, ignored);
      return;
    }
    if (!recorded_) return;  // a refused resume: run.json and summary.json tell of the run as it is
    record_.failed(error);
    attempt([&] { record_.write(); });
    if (!started_ && options_.folder.resume) return;
    attempt([&] {
      if (files_) files_->flush();
    });
    attempt([&] { write_end(error.code()); });
  }

  /// Shows the line that starts a side by hand. It contains the token, so it is written where only the user
  /// can read it.
  void invite(const std::string& side, const std::string& command) {
    programs_[side]["start_by_hand"] = command;
    record_.set("participants", programs_);
    record_.keep_private();
    record_.write();
    messages_.log->info(
        fmt::format("waiting for {}, to be started by hand; its command line is in run.json", side));
    messages_.reporter.warning(fmt::format("start {} by hand, here or elsewhere:\n    {}", side, command));
  }

  std::string position() const {
    return fmt::format("window {} (t = {:.6g} s)", summary_.windows() + 1, summary_.end_time());
  }

  const CaseView& case_;
  RunFolder folder_;
  FolderLock lock_;
  const RunOptions& options_;
  const StopRequest& stop_;
  Clock::time_point start_ = Clock::now();
  RunMessages messages_;
  RunRecord record_;
  Summary summary_;
  Json programs_;
  ComparisonStatus verdicts_;
  RunClocks clocks_;
  std::unique_ptr<RunFiles> files_;
  std::unique_ptr<Session> session_;
  Checkpoints checkpoints_;
  RunPlan plan_;
  LoopState saved_;                // of the latest checkpoint
  double wall_before_ = 0;         // [s] of the run that this one resumes
  bool recorded_ = false;          // run.json tells of this run
  bool started_ = false;           // the first window has begun
  bool saved_on_request_ = false;  // Ctrl-C found time for a checkpoint
};

std::vector<std::string> sets_of(const RunOptions& options) {
  if (!options.folder.resume) return options.sets;
  return settled_sets(options.case_file, options.sets,
                      find_run_folder(options.case_file, options.folder).path);
}

}  // namespace

ExitCode run(const RunOptions& options, const StopRequest& stop) {
  const std::unique_ptr<Reporter> reporter = reporter_of(options);
  std::optional<CaseView> view;
  std::optional<Run> run;
  try {
    refuse_study(options.case_file);
    std::error_code none;  // of a folder, the reader of the case says that it is no case
    if (!options.folder.first_free_tag && !std::filesystem::is_directory(options.case_file, none))
      find_run_folder(options.case_file, options.folder);  // the quickest refusal first
    view = read_case(options.case_file, sets_of(options), &stop, options.by_hand);
    check_by_hand(options.by_hand, *view);
    run.emplace(*view, create_run_folder(options.case_file, options.folder), options, stop, *reporter);
  } catch (const Error& error) {
    reporter->error(error);
    throw;
  }
  return run->execute();
}

}  // namespace strake
