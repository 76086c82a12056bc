#include "coupler/commands/commands.hpp"
#include "coupler/console/console.hpp"
#include "coupler/import/imported_run.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

namespace strake {
namespace {

/// A path from the folder of a file, in the words of a case file.
std::string seen_from(const std::filesystem::path& file, const std::filesystem::path& path) {
  const auto whole = [](const std::filesystem::path& p) {
    return std::filesystem::absolute(p).lexically_normal();
  };
  const std::filesystem::path relative = whole(path).lexically_relative(whole(file).parent_path());
  return relative.empty() ? whole(path).string() : relative.string();
}

}  // namespace

ExitCode import_case(const ImportOptions& options) {
  const std::filesystem::path& configuration = options.configuration;
  const std::filesystem::path out =
      options.out.empty() ? std::filesystem::path(configuration.stem().string() + ".toml") : options.out;
  refuse_existing(out);
  const ImportedRun run = import_precice(configuration);
  const std::filesystem::path home =
      std::filesystem::absolute(configuration).lexically_normal().parent_path();
  write_whole(out, case_text(run, seen_from(out, home)));
  std::string text = fmt::format("wrote {}\n", out.string());
  for (const std::string& note : run.notes) text += fmt::format("  {}\n", visible(note, ""));
  text += fmt::format(
      "  next  write the programs into {0}: fluid.solver for {1}, structure.solver for {2}\n"
      "        strake check {0}\n        strake run {0}\n",
      out.string(), run.fluid.participant.value, run.structure.participant.value);
  put(stdout, text);
  return ExitCode::done;
}

}  // namespace strake
