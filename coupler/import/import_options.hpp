#pragma once

#include <filesystem>

namespace CLI {
class App;
}

namespace strake {

/// What the user gave `strake import`.
struct ImportOptions {
  std::filesystem::path configuration;  // precice-config.xml
  std::filesystem::path out;            // the case file; empty: <stem of the configuration>.toml
};

/// Adds the options of `strake import` to `command`.
void add_import_options(CLI::App& command, ImportOptions&);

}  // namespace strake
