#include "coupler/run/run_folder.hpp"

#include "coupler/transport/system_calls.hpp"
#include "proto/files/json_file.hpp"
#include "proto/files/result_file.hpp"
#include "proto/text.hpp"
#include "proto/version.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <fcntl.h>
#include <optional>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace strake {

namespace fs = std::filesystem;

namespace {

Error cannot_create(const fs::path& path, const std::string& reason) {
  return Error(ExitCode::cannot_write, path.string(), "cannot be created: " + reason,
               "choose a folder that you may write to with --runs DIR");
}

/// Type of the entry at a path, of the link itself if it is one. Throws Error(command_line) if the system
/// cannot tell.
fs::file_type what_stands_at(const fs::path& path) {
  std::error_code error;
  const fs::file_type type = fs::symlink_status(path, error).type();
  if (type != fs::file_type::none) return type;
  throw Error(ExitCode::command_line, path.string(), "cannot be looked at: " + error.message(),
              "choose another name with --tag NAME, or another folder with --runs DIR");
}

bool is_empty_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_empty(path, error) && !error;
}

/// True if a folder contains what RunRecord writes. A case.toml is no sign: a user's own folder may contain
/// one.
bool is_a_run(const fs::path& path) {
  const Json record = read_json(path / "run.json");
  return record.is_object() && record.contains("strake") && record.contains("command");
}

/// Throws Error(command_line) unless --force may replace the existing entry.
void check_replaceable(const fs::path& path) {
  const fs::file_type type = what_stands_at(path);
  const bool folder = type == fs::file_type::directory;
  if (folder && (is_empty_folder(path) || is_a_run(path))) return;
  throw Error(ExitCode::command_line, path.string(),
              type == fs::file_type::symlink ? "is a link, which --force does not follow"
              : folder                       ? "holds no run.json of a run, so --force leaves it alone"
                                             : "is not the folder of a run, so --force leaves it alone",
              "name the new run with --tag NAME, or remove it yourself");
}

RunFolder named(const fs::path& case_file, const RunFolderOptions& options, const std::string& tag) {
  RunFolder folder;
  folder.case_name = case_file.stem().string();
  folder.tag = tag;
  folder.path = options.runs / (tag.empty() ? folder.case_name : folder.case_name + "-" + tag);
  return folder;
}

// plate_entry, plate_entry-2, …; with a tag plate_entry-fine, plate_entry-fine-2, …
std::string nth_tag(const std::string& tag, int n) {
  if (n == 1) return tag;
  return tag.empty() ? std::to_string(n) : fmt::format("{}-{}", tag, n);
}

void check_tag(const std::string& tag) {
  if (visible(tag, "") != tag)
    throw Error(ExitCode::command_line, "--tag " + tag, "expected a name of letters and digits",
                "--tag fine");
  if (tag.find('/') != std::string::npos || tag == "." || tag == "..")
    throw Error(ExitCode::command_line, "--tag " + tag, "expected a name without '/'", "--tag fine");
}

/// Files that are made meanwhile are this user's alone.
class OnlyMine {
 public:
  OnlyMine() : before_(::umask(077)) {}
  ~OnlyMine() { ::umask(before_); }
  OnlyMine(const OnlyMine&) = delete;
  OnlyMine& operator=(const OnlyMine&) = delete;

 private:
  mode_t before_;
};

}  // namespace

RunFolder find_run_folder(const fs::path& case_file, const RunFolderOptions& options) {
  check_tag(options.tag);
  RunFolder folder = named(case_file, options, options.tag);
  const auto taken = [&] { return what_stands_at(folder.path) != fs::file_type::not_found; };
  if (options.first_free_tag)
    for (int n = 2; taken(); ++n) folder = named(case_file, options, nth_tag(options.tag, n));
  if (!taken()) {
    if (options.resume)
      throw Error(ExitCode::command_line, folder.path.string(), "there is no run to resume",
                  "leave out --resume");
    return folder;
  }
  if (options.resume) return folder;
  if (!options.force)
    throw Error(ExitCode::command_line, folder.path.string(), "this run folder exists",
                "name the new run with --tag NAME, or replace the old one with --force");
  check_replaceable(folder.path);
  return folder;
}

RunFolder create_run_folder(const fs::path& case_file, const RunFolderOptions& options) {
  std::error_code error;
  fs::create_directories(options.runs, error);
  if (error) throw cannot_create(options.runs, error.message());
  while (true) {
    RunFolder folder = find_run_folder(case_file, options);
    if (options.resume) return folder;
    if (options.force && what_stands_at(folder.path) != fs::file_type::not_found) {
      const FolderLock nobody_else(folder.path);
      if (is_empty_folder(folder.path)) return folder;
      check_replaceable(folder.path);  // it may have changed since it was found
      fs::remove_all(folder.path, error);
    }
    if (error) throw cannot_create(folder.path, error.message());
    const bool created = fs::create_directory(folder.path, error);
    if (error) throw cannot_create(folder.path, error.message());
    if (created) return folder;  // else another run has just taken the name: test again
  }
}

void remove_unfinished(const fs::path& run_folder) {
  std::error_code ignored;
  std::vector<fs::path> parts;
  for (const auto& entry : fs::recursive_directory_iterator(run_folder, ignored))
    if (entry.path().extension() == ".part") parts.push_back(entry.path());
  for (const auto& part : parts) fs::remove(part, ignored);
}

FolderLock::FolderLock(const fs::path& path)
    : folder_(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  constexpr int tries = 5;  // a program that only tests whether a run is under way (strake watch) locks it
                            // for a moment
  for (int k = 0; k < tries; ++k) {
    if (!folder_ || ::flock(folder_.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK)
      return;  // some disks have no locks
    ::usleep(10'000);
  }
  throw Error(ExitCode::command_line, path.string(), "another run is under way in this folder",
              "wait until it has ended, or name the new run with --tag NAME");
}

TrialFolder::TrialFolder() {
  std::string name = (fs::temp_directory_path() / "strake-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw cannot_create(name, std::generic_category().message(errno));
  path_ = name;
}

TrialFolder::~TrialFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

RunRecord::RunRecord(fs::path folder, const std::vector<std::string>& command_line)
    : folder_(std::move(folder)) {
  data_["strake"] = strake_version();
  data_["commit"] = strake_commit();
  data_["command"] = command_line;
  data_["host"] = host_name();
  data_["compiler"] = compiler();
  data_["started"] = utc_now();
  data_["ended"] = nullptr;
  data_["exit_code"] = nullptr;
  data_["seeds"] = Json::array();  // nothing here is random
}

void RunRecord::set(const std::string& key, Json value) {
  data_[key] = std::move(value);
}

void RunRecord::ended(ExitCode code) {
  data_["ended"] = utc_now();
  data_["exit_code"] = static_cast<int>(code);
}

void RunRecord::failed(const Error& error) {
  ended(error.code());
  data_["error"] = {{"where", error.where()}, {"problem", error.problem()}, {"fix", error.fix()}};
}

void RunRecord::keep_private() {
  private_ = true;
}

void RunRecord::write() const {
  std::optional<OnlyMine> mask;
  if (private_) mask.emplace();
  write_text(folder_ / "run.json", json_text(data_, 2) + "\n");
}

std::string compiler() {
#ifdef __clang__
  return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return fmt::format("gcc {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  return time_text("%Y-%m-%dT%H:%M:%SZ", utc);
}

}  // namespace strake
