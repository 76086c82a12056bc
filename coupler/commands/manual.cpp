#include "coupler/commands/commands.hpp"
#include "coupler/console/console.hpp"
#include "coupler/participant/launch.hpp"

#include <fmt/format.h>

namespace strake {

ExitCode manual() {
  const std::filesystem::path programs = find_program("strake").parent_path(),
                              beside = programs.parent_path();
  for (const char* folder : {"manual", "share/doc/strake/html"})
    if (const auto page = beside / folder / "index.html"; std::filesystem::exists(page)) {
      put(stdout, page.string() + "\n");
      return ExitCode::done;
    }
  for (auto tree = beside; tree != tree.root_path(); tree = tree.parent_path())
    if (std::filesystem::exists(tree / "tests/run.sh") && std::filesystem::exists(tree / "fluid/THEORY.md")) {
      put(stdout, fmt::format("{}\nas one HTML manual: {} --manual\n", (tree / "README.md").string(),
                              (tree / "tests/run.sh").string()));
      return ExitCode::done;
    }
  throw Error(ExitCode::command_line, "strake manual",
              fmt::format("no manual beside {}, and no source tree above it", programs.string()),
              "tests/run.sh --manual in the source tree builds it; the package strake-doc holds it");
}

}  // namespace strake
