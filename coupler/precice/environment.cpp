#include "coupler/precice/environment.hpp"

#include "coupler/participant/launch.hpp"
#include "proto/error.hpp"

#include <precice/Version.h>

#include <algorithm>
#include <cstdlib>

namespace strake {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  if (value && *value) return value;
  throw Error(ExitCode::command_line, name,
              "is not in the environment: this libprecice takes part in runs of Strake alone",
              "start the solver by strake run, or as run.json says under start_by_hand;\n"
              "for a run of preCICE use its own library: look at LD_LIBRARY_PATH");
}

}  // namespace

ServeOptions connection_of_environment() {
  ServeOptions options{.endpoint = variable("STRAKE_CONNECT"),
                       .name = variable("STRAKE_NAME"),
                       .token = variable("STRAKE_TOKEN"),
                       .solver = "precice",
                       .version = PRECICE_VERSION};
  const std::string hash = bytes_of(variable("STRAKE_CASE_HASH"));
  if (hash.size() != options.case_hash.size())
    throw Error(ExitCode::command_line, "STRAKE_CASE_HASH", "is no SHA-256: expected 64 hexadecimal digits");
  std::copy(hash.begin(), hash.end(), options.case_hash.begin());
  return options;
}

}  // namespace strake
