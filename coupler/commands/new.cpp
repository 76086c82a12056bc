#include "coupler/commands/commands.hpp"
#include "coupler/console/console.hpp"
#include "coupler/new_case/case_lines.hpp"
#include "coupler/new_case/questions.hpp"
#include "coupler/new_case/scenes.hpp"
#include "coupler/participant/launch.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <unistd.h>

namespace strake {
namespace {

const NewKind& kind_named(const std::string& name) {
  for (const NewKind& kind : new_kinds())
    if (kind.name == name) return kind;
  std::vector<std::string> names;
  for (const NewKind& kind : new_kinds()) names.push_back(kind.name);
  throw Error(ExitCode::command_line, "strake new", fmt::format("expected a kind of case: {}", joined(names)),
              "strake new plate; strake new --help says what they are");
}

}  // namespace

void refuse_existing(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::symlink_status(file, ignored)))
    throw Error(ExitCode::command_line, file.string(), "exists already, and is not replaced",
                "-o another.toml, or remove it");
}

ExitCode new_case(NewOptions options) {
  const bool terminal = isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0;
  if (!options.out.empty()) refuse_existing(options.out);
  const NewKind& kind =
      options.kind.empty() && terminal ? ask_kind(std::cin, std::cout) : kind_named(options.kind);
  const std::filesystem::path out =
      options.out.empty() ? std::filesystem::path(kind.name + ".toml") : options.out;
  refuse_existing(out);
  const NewAnswers& given = options.answers;
  const bool asks = terminal && given.number.empty() && given.solver.empty() && given.mesh.empty();
  NewAnswers answers =
      complete(kind, asks ? ask_answers(kind, std::cin, std::cout) : given, "strake new " + kind.name);
  answers.mesh_text = answers.mesh.string();
  if (answers.mesh.is_relative() && kind.mesh)
    answers.mesh_text =
        std::filesystem::absolute(answers.mesh)
            .lexically_normal()
            .lexically_relative(std::filesystem::absolute(out).lexically_normal().parent_path())
            .string();
  NewScene scene = kind.scene(answers);
  if (scene.warning.empty()) scene.warning = long_lengths(kind, answers);
  write_whole(out, case_file_text(kind.name, scene));
  if (!scene.warning.empty()) put(stderr, fmt::format("  warning  {}\n", visible(scene.warning)));
  put(stdout, fmt::format("wrote {}\n  size  about {} particles; half the spacing, {:.3g} m: {}\n"
                          "  next  strake check {}\n        strake run {}\n",
                          out.string(), grouped(std::llround(particles_of(scene))), 0.5 * scene.spacing,
                          cost_of_half(scene), shell_word(out.string()), shell_word(out.string())));
  return ExitCode::done;
}

}  // namespace strake
