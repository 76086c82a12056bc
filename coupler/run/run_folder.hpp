#pragma once

#include "proto/descriptor.hpp"
#include "proto/error.hpp"
#include "proto/files/json_file.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

/// Where a run is written, and what stands in the way.
struct RunFolderOptions {
  std::filesystem::path runs = "runs";
  std::string tag;
  bool force = false;           // an earlier run there is removed; nothing else ever is
  bool resume = false;          // an earlier run there is continued
  bool first_free_tag = false;  // <case>, <case>-2, <case>-3, … : the first that does not exist
};

struct RunFolder {
  std::filesystem::path path;  // runs/<case>[-tag], as the user would type it
  std::string case_name, tag;
};

/// The folder these options mean; throws Error(command_line) where `create_run_folder` would. Creates
/// nothing.
RunFolder find_run_folder(const std::filesystem::path& case_file, const RunFolderOptions&);
/// Creates it (removing an earlier run under --force, or taking an empty folder as it is). Throws
/// Error(command_line | cannot_write).
RunFolder create_run_folder(const std::filesystem::path& case_file, const RunFolderOptions&);

/// What a killed run was writing.
void remove_unfinished(const std::filesystem::path& run_folder);

/// Marks a folder as in use by a run, until it is destroyed or the process ends in any way. It leaves no
/// file. Throws Error(command_line) when another process uses it.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path&);

 private:
  Descriptor folder_;
};

/// A private folder under the system's temporary one, gone with the object: `check` builds its participants
/// there.
class TrialFolder {
 public:
  TrialFolder();
  ~TrialFolder();
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// run.json: where a run comes from and how it ended. Rewritten whole at each call of `write`.
class RunRecord {
 public:
  RunRecord(std::filesystem::path folder, const std::vector<std::string>& command_line);
  /// One entry, e.g. set("participants", {...}).
  void set(const std::string& key, Json value);
  void ended(ExitCode);
  void failed(const Error&);
  void keep_private();  // from the next write on, only this user can read it
  void write() const;

 private:
  std::filesystem::path folder_;
  bool private_ = false;
  Json data_;
};

/// The compiler that built this program: "gcc 12.2.0".
std::string compiler();
/// "2025-11-21T02:04:42Z"
std::string utc_now();

}  // namespace strake
