#include "coupler/run/checkpoint.hpp"

#include "coupler/case/case_queries.hpp"
#include "proto/error.hpp"
#include "proto/files/history.hpp"
#include "proto/files/json_file.hpp"
#include "proto/files/result_file.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <system_error>
#include <vector>

namespace strake {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kept = 2;  // the one before the last stays until the next is whole

[[noreturn]] void cannot_write(const fs::path& path, const std::error_code& error) {
  throw Error(ExitCode::cannot_write, path.string(), error.message(),
              "free space, or choose another folder with --runs DIR");
}

bool is_number(const std::string& name) {
  return !name.empty() && name.find_first_not_of("0123456789") == std::string::npos;
}

/// Names are numbers of at least six digits: a longer one is a larger one.
bool earlier(const fs::path& a, const fs::path& b) {
  const std::string one = a.filename().string(), other = b.filename().string();
  return one.size() != other.size() ? one.size() < other.size() : one < other;
}

std::vector<fs::path> checkpoints_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none))
    if (is_number(entry.path().filename().string()) && entry.is_directory(none) && !entry.is_symlink(none))
      found.push_back(entry.path());
  std::sort(found.begin(), found.end(), earlier);
  return found;
}

void save_coupling(Session& session, Archive& archive) {
  if (const Scheme* scheme = session.scheme()) scheme->state().save(archive);
  if (const Assembly* bodies = session.assembly()) bodies->save(archive);
}

/// After all participants have resumed.
void load_coupling(Session& session, const Archive& archive) {
  Scheme* scheme = session.scheme();
  if (scheme == nullptr) return;
  CouplingState state;
  state.load(archive);
  Assembly* bodies = session.assembly();
  if (bodies != nullptr && !state.structure.empty() && state.structure.back().motion)
    bodies->load(archive, state.structure.back(), state.windows);
  scheme->set_state(std::move(state));
}

// Keys that may differ between a run and its continuation.
bool may_change(const std::string& key) {
  for (const char* prefix :
       {"title", "end_time", "output.every", "run.", "compare", "coupling.frozen_after",
        "coupling.answer_within", "coupling.start_within", "coupling.attach_within", "coupling.endpoint",
        "coupling.keys", "coupling.unencrypted", "coupling.placement", "fluid.ranks", "fluid.launcher"})
    if (key.starts_with(prefix)) return true;
  // Of a structure, or of one of several.
  return key.starts_with("structure") && (key.ends_with(".ranks") || key.ends_with(".launcher"));
}

}  // namespace

Checkpoints::Checkpoints(const fs::path& run_folder) : folder_(run_folder / "checkpoint") {}

void Checkpoints::write(Session& session, const WindowLoop& loop, const Summary& summary) {
  const std::string name = fmt::format("{:06}", loop.number());
  const fs::path target = folder_ / name;
  if (damage(target).empty()) return name_latest(name);  // nothing has happened since
  std::error_code error;
  fs::remove_all(target, error);  // an unfinished one
  fs::create_directories(target, error);
  if (error) cannot_write(target, error);

  for (RemoteParticipant* participant : session.remotes()) participant->checkpoint(target);
  session.attachments().checkpoint(target);
  Archive archive;
  save_coupling(session, archive);
  loop.state().save(archive);
  summary.save(archive);
  write_archive(target / "coupler.h5", archive);
  complete(name);
  forget_old();
}

void Checkpoints::complete(const std::string& number) const {
  write_checksums(folder_ / number);
  sync_to_disk(folder_.parent_path());  // where the name of folder_ stands
  name_latest(number);
}

/// Before the link is there, all that it leads to is on the disk; then the link is.
void Checkpoints::name_latest(const std::string& number) const {
  const fs::path link = folder_ / "latest", fresh = folder_ / "latest.new";
  std::error_code error;
  if (latest() == folder_ / number) return;
  sync_to_disk(folder_);
  if (fs::is_directory(fs::symlink_status(link, error))) fs::remove_all(link, error);
  fs::remove(fresh, error);
  fs::create_directory_symlink(number, fresh, error);
  if (!error) fs::rename(fresh, link, error);
  if (error) cannot_write(link, error);
  sync_to_disk(folder_);
}

void Checkpoints::forget_old() const {
  std::vector<fs::path> found = checkpoints_in(folder_);
  std::error_code ignored;
  for (std::size_t i = 0; i + kept < found.size(); ++i) fs::remove_all(found[i], ignored);
}

void Checkpoints::forget(const fs::path& later_than) const {
  std::error_code ignored;
  for (const fs::path& found : checkpoints_in(folder_))
    if (earlier(later_than, found)) fs::remove_all(found, ignored);
}

long Checkpoints::window_of(const fs::path& checkpoint) {
  const std::string name = checkpoint.filename().string();
  if (!is_number(name))
    throw Error(ExitCode::case_file, checkpoint.string(), "does not bear the number of a window",
                "remove the folder, or run the case again with --force");
  return std::stol(name);
}

fs::path Checkpoints::latest() const {
  std::error_code none;
  const fs::path name = fs::read_symlink(folder_ / "latest", none);
  return none ? fs::path() : folder_ / name;
}

fs::path Checkpoints::choose(const std::function<void(const std::string&)>& say) const {
  const fs::path last = latest();
  std::vector<fs::path> found = checkpoints_in(folder_);
  // Folders after `latest` were never finished; without the link none can be judged.
  if (!last.empty()) std::erase_if(found, [&](const fs::path& path) { return earlier(last, path); });
  const auto named = [&](const fs::path& path) {
    return (folder_.parent_path().filename() / "checkpoint" / path.filename()).string();
  };
  if (found.empty())
    throw Error(ExitCode::command_line, folder_.parent_path().string(), "holds no checkpoint to go on from",
                "run it again with --force, or under another --tag");
  std::string problems;
  std::vector<std::string> skipped;
  for (auto path = found.rbegin(); path != found.rend(); ++path) {
    const std::string problem = damage(*path);
    if (problem.empty()) {
      for (const std::string& line : skipped) say(line);
      if (!skipped.empty()) say(fmt::format("going on from {}", named(*path)));
      return *path;
    }
    skipped.push_back(fmt::format("{} cannot be used: {}", named(*path), problem));
    problems += fmt::format("\n{}: {}", path->filename().string(), problem);
  }
  throw Error(ExitCode::case_file, folder_.string(), "holds no checkpoint that is whole" + problems,
              "run it again with --force, or under another --tag");
}

RunPlan Checkpoints::resume(const fs::path& source, Session& session, Summary& summary) {
  const fs::path file = source / "coupler.h5";
  const Archive archive = read_archive(file);
  RunPlan plan = session.plan();
  try {
    plan.start = LoopState::from(archive);
    summary.load(archive);
  } catch (const std::out_of_range&) {
    throw Error(ExitCode::case_file, file.string(), "is not a checkpoint of this version of Strake",
                "resume with the programs that wrote it, or run it again with --force");
  }
  for (RemoteParticipant* participant : session.remotes()) {
    participant->resume(source);
    participant->count_windows_from(static_cast<std::uint64_t>(plan.start.windows));
  }
  session.attachments().resume(source, static_cast<std::uint64_t>(plan.start.windows));
  load_coupling(session, archive);
  forget(source);
  return plan;
}

/// Compares the end of the case with the last row of history.csv, t_h, and with the checkpoint's number.
/// A resume cuts all files behind its checkpoint, so an end before t_h would lose rows.
void check_end_time(const CaseView& view, const fs::path& run_folder, const fs::path& checkpoint) {
  constexpr double slack = 1e-6;  // as in WindowLoop
  const fs::path path = run_folder / "history.csv";
  if (std::error_code none; !fs::exists(path, none)) return;  // whoever opens it says so
  const Table history = read_table(path);
  if (history.columns.size() < 2 || history.rows() == 0) return;
  const double window = history.value[0].back(), computed = history.value[1].back();
  const double past = view.common.end_time - computed, tolerance = slack * window_of(view);
  const std::string upto = fmt::format("is computed to t = {:.6g} s", computed);
  if (past < -tolerance)
    throw Error(
        ExitCode::command_line, run_folder.string(),
        fmt::format("{}; going on to end_time = {:.6g} s would lose what lies behind it", upto,
                    view.common.end_time),
        fmt::format("set end_time = {:.6g} or later, or run it to the earlier time under a --tag of its own",
                    computed));
  if (past < tolerance && window <= static_cast<double>(Checkpoints::window_of(checkpoint)))
    throw Error(ExitCode::command_line, run_folder.string(), upto + ", the end_time: nothing is left to do",
                "set a later end_time to go on");
}

std::vector<std::string> settled_sets(const fs::path& case_file, std::vector<std::string> sets,
                                      const fs::path& run_folder) {
  const fs::path path = run_folder / "case.toml";
  const auto text = read_text(path);
  if (!text) return sets;  // check_same_case says so
  const auto before = flatten_toml(*text, path.string());
  const std::string step = "fluid.scheme.time_step", window = "coupling.surface.window",
                    probes = "output.default_probes";
  const std::vector<std::string> given = given_among({step, window, probes}, case_file, sets);
  const auto is_given = [&](const std::string& key) {
    return std::find(given.begin(), given.end(), key) != given.end();
  };
  for (const std::string& key : {step, window})
    if (const auto found = before.find(key); found != before.end() && !is_given(key))
      sets.push_back(key + "=" + found->second);
  if (!before.contains(probes) && !is_given(probes)) sets.push_back(probes + "=false");
  return sets;
}

void check_can_resume(const std::string& who_cannot, const fs::path& run_folder) {
  if (who_cannot.empty()) return;
  throw Error(ExitCode::command_line, run_folder.string(),
              "cannot be resumed: " + who_cannot + ", so it has no checkpoints",
              "run it again with --force, or under another --tag");
}

void check_same_case(const CaseView& view, const fs::path& run_folder) {
  const fs::path path = run_folder / "case.toml";
  const auto text = read_text(path);
  if (!text)
    throw Error(ExitCode::command_line, run_folder.string(), "has no case.toml to go on from",
                "leave out --resume");
  const auto before = flatten_toml(*text, path.string());
  const auto now = flatten_toml(view.resolved, "case.toml");
  std::string changes;
  for (const auto& [key, value] : now) {
    const std::string was = at_or(before, key, "not there");
    const bool older = !before.contains(key) && key == "output.default_probes" && value == "false";
    if (was != value && !older && !may_change(key))
      changes += fmt::format("\n{} was {}, is {}", key, was, value);
  }
  if (!changes.empty())
    throw Error(ExitCode::command_line, run_folder.string(),
                "cannot be resumed: the case has changed" + changes,
                "run the new case under a --tag of its own");
}

}  // namespace strake
