#include "coupler/commands/commands.hpp"
#include "coupler/transport/curve_keys.hpp"

#include <fmt/format.h>

namespace strake {

ExitCode keys(const KeysOptions& options) {
  make_keys(options.folder, options.participants);
  fmt::print("keys of a run between machines; they are secret\n");
  fmt::print("  {}   stays here; in the case: coupling.keys = \"{}\"\n",
             key_file(options.folder, "coupler").string(),
             std::filesystem::absolute(options.folder).lexically_normal().string());
  for (const std::string& name : options.participants) {
    const std::string file = key_file(options.folder, name).string();
    fmt::print("  {}   goes to the machine of the {}, mode 0600: STRAKE_KEY={}.key\n", file, name, name);
  }
  return ExitCode::done;
}

}  // namespace strake
