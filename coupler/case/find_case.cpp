#include "coupler/case/find_case.hpp"

#include "coupler/participant/launch.hpp"
#include "proto/case/case_file.hpp"
#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace strake {

namespace fs = std::filesystem;

namespace {

bool is_file(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(path, none);
}

/// NAME.toml or NAME/NAME.toml in a folder; empty if neither is there.
fs::path case_in(const fs::path& folder, const std::string& name) {
  for (const fs::path& file : {folder / (name + ".toml"), folder / name / (name + ".toml")})
    if (is_file(file)) return file;
  return {};
}

Error no_such_case(const std::string& name, const fs::path& folder) {
  const std::vector<std::string> known = folder.empty() ? std::vector<std::string>{} : case_names(folder);
  const std::string near = did_you_mean(name, known);
  std::string fix = "name the case file, with its path";
  if (!near.empty())
    fix = fmt::format("did you mean {}?", near);
  else if (!known.empty())
    fix = fmt::format("name a case file, or one of {}", joined(known));
  return {ExitCode::case_file, name,
          fmt::format("no file {}.toml here{}", name,
                      folder.empty() ? "" : fmt::format(", and no case of that name in {}", folder.string())),
          fix};
}

constexpr std::size_t most_listed = 8;

/// A folder where a case belongs: that of a run, of one case, or of several.
Error folder_for_case(const fs::path& named) {
  const fs::path folder = named.has_filename() ? named : named.parent_path();
  const fs::path of_run = folder / "case.toml", own = folder / (folder.filename().string() + ".toml");
  std::string fix = "name a case file, with its path";
  if (is_file(of_run) && is_file(folder / "run.json"))
    fix = fmt::format("it is the folder of a run; its case once more: {}; what came out: strake report {}",
                      of_run.string(), folder.string());
  else if (is_file(own))
    fix = fmt::format("its case is {}", own.string());
  else if (std::vector<std::string> names = case_names(folder); !names.empty()) {
    for (std::string& name : names) name = case_in(folder, name).lexically_relative(folder).string();
    const bool more = names.size() > most_listed;
    names.resize(std::min(names.size(), most_listed));
    fix = "name a case file of it: " + joined(names) + (more ? ", ..." : "");
  }
  return {ExitCode::case_file, named.string(), "is a folder, not a file", fix};
}

/// Refuses a file that is not there where one beside it has nearly its name.
void check_near(const fs::path& named) {
  std::error_code none;
  if (named.extension() != ".toml" || fs::exists(named, none)) return;
  const fs::path folder = named.has_parent_path() ? named.parent_path() : ".";
  const std::string near = did_you_mean(named.stem().string(), case_names(folder));
  const fs::path file = named.parent_path() / (near + ".toml");
  if (!near.empty() && is_file(file))
    throw Error(ExitCode::case_file, named.string(), "no such file",
                fmt::format("did you mean {}?", file.string()));
}

}  // namespace

fs::path cases_folder() {
  const fs::path prefix = find_program("strake").parent_path().parent_path();
  std::error_code none;
  if (const fs::path installed = prefix / "share/strake/cases"; fs::is_directory(installed, none))
    return installed;
  for (fs::path tree = prefix; tree != tree.root_path(); tree = tree.parent_path())
    if (is_file(tree / "fluid/THEORY.md") && fs::is_directory(tree / "cases", none)) return tree / "cases";
  return {};
}

std::vector<std::string> case_names(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() == ".toml" || is_file(entry.path() / (name + ".toml")))
      names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

fs::path find_case(const fs::path& named) {
  const std::string name = named.string();
  std::error_code none;
  const bool alone = !name.empty() && !named.has_extension() && !named.has_parent_path() && name != "..";
  if (!alone && fs::is_directory(named, none)) throw folder_for_case(named);
  if (!alone) check_near(named);
  if (!alone || (fs::exists(named, none) && !fs::is_directory(named, none))) return named;
  if (is_file(name + ".toml")) return name + ".toml";
  const fs::path folder = cases_folder();
  if (!folder.empty())
    if (const fs::path found = case_in(folder, name); !found.empty()) return found;
  if (fs::exists(named, none)) throw folder_for_case(named);
  throw no_such_case(name, folder);
}

namespace {

void refuse_study(const CaseFile& file) {
  if (!file.has("case") || !file.has("axis")) return;
  const std::string path = file.path().string();
  throw Error(ExitCode::case_file, path, "is a study, not a case", "strake study " + path);
}

}  // namespace

void refuse_study(const fs::path& path) {
  if (is_file(path)) refuse_study(CaseFile::load(path));
}

CaseFile load_no_study(const fs::path& path, const std::vector<std::string>& sets) {
  CaseFile file = CaseFile::load(path, sets);
  refuse_study(file);
  return file;
}

}  // namespace strake
