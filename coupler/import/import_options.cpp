#include "coupler/import/import_options.hpp"

#include <CLI/CLI.hpp>

namespace strake {

void add_import_options(CLI::App& command, ImportOptions& options) {
  command.add_option("FILE", options.configuration, "precice-config.xml of two participants")->required();
  command.add_option("-o", options.out, "the case file, default the configuration's name with .toml")
      ->type_name("FILE");
}

}  // namespace strake
