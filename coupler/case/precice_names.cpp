#include "coupler/case/precice_names.hpp"

#include "coupler/precice/config/precice_config.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <vector>

namespace strake {

void check_precice_names(const std::string& side, const ForeignKeys& keys) {
  if (keys.precice_config.empty()) return;
  const PreciceConfig config = PreciceConfig::read(keys.precice_config);
  std::vector<std::string> known;
  for (const PreciceConfig::Data& data : config.data) known.push_back(data.name);
  for (const std::string& rule : keys.precice_names) {
    const std::string name = rule.substr(0, rule.find('='));
    if (config.find_data(name)) continue;
    const std::string nearest = did_you_mean(name, known);
    throw Error(ExitCode::case_file, fmt::format("{}.precice: \"{}\"", side, rule),
                fmt::format("{} is no data of {}", name, config.file.string()),
                nearest.empty() ? fmt::format("it has {}", fmt::join(known, ", "))
                                : fmt::format("did you mean \"{}\"?", nearest));
  }
}

}  // namespace strake
