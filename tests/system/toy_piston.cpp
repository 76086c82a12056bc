// One side of cases/VALIDATION.md, "Piston and column" as a process of its own: toy_piston --connect … --name
// fluid|structure --mu RATIO.

#include "coupler/participant/serve.hpp"
#include "tests/method/coupling/piston_models.hpp"

#include <cstdlib>
#include <memory>
#include <string>

int main(int argc, char** argv) {
  using namespace strake;
  ServeOptions options;
  options.solver = "piston";
  options.version = "1";
  double mu = 1;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i], value = argv[i + 1];
    if (key == "--connect") options.endpoint = value;
    if (key == "--name") options.name = value;
    if (key == "--mu") mu = std::stod(value);
  }
  const char* token = std::getenv("STRAKE_TOKEN");
  options.token = token ? token : "";
  return serve(options, [&](const Setup&) -> std::unique_ptr<Participant> {
    if (options.name == "fluid") return std::make_unique<models::AddedMass>(models::piston_column(mu));
    return std::make_unique<models::Oscillators>(models::piston_spring());
  });
}
