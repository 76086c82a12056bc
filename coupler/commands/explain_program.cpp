#include "coupler/commands/commands.hpp"
#include "coupler/console/console.hpp"
#include "coupler/editor/command_line.hpp"
#include "coupler/editor/declarations.hpp"
#include "coupler/participant/case/participant_options.hpp"
#include "proto/files/whole_file.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace strake {

void add_explain_options(CLI::App& command, ExplainOptions& options) {
  auto* key = command.add_option("KEY", options.key, "key or table, e.g. fluid.scheme.cfl");
  auto* markdown = command.add_flag("--markdown", options.markdown,
                                    "the reference of every key, as it stands in proto/CASE_FILE.md");
  auto* schema =
      command.add_flag("--schema", options.schema, "a JSON Schema of the case file, for text editors");
  auto* completion =
      command.add_option("--completion", options.completion, "completion of commands and keys for bash")
          ->check(CLI::IsMember({"bash"}))
          ->type_name("bash");
  auto* man =
      command.add_option("--man", options.man, "write the man pages of all programs there")->type_name("DIR");
  schema->excludes(markdown, key);
  completion->excludes(schema, markdown, key);
  man->excludes(completion, schema, markdown, key);
}

ExitCode explain_program(const ExplainOptions& options, const CLI::App& strake) {
  CLI::App participant;
  ParticipantOptions parsed;
  ParticipantFlags flags;
  add_participant_options(participant, parsed, flags);
  std::vector<ProgramText> programs = {{"strake", &strake}};
  for (const std::string& name : solver_programs()) programs.push_back({name, &participant});
  for (const char* name : {"strake-fluid-ranks", "strake-structure-ccx", "strake-structure-fem-ranks"})
    programs.push_back({name, &participant});
  if (!options.completion.empty()) {
    put(stdout, bash_completion(programs, collect_declarations().keys));
    return ExitCode::done;
  }
  std::error_code failed;
  std::filesystem::create_directories(options.man, failed);
  if (failed) throw cannot_write(options.man, failed.value());
  std::size_t count = 0;
  for (const ProgramText& program : programs)
    for (const auto& [name, text] : man_pages(program)) {
      write_whole(options.man / name, text);
      ++count;
    }
  put(stdout, fmt::format("{} man pages in {}\n", count, options.man.string()));
  return ExitCode::done;
}

}  // namespace strake
