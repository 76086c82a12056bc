#include "coupler/participant/precice/own_part.hpp"

#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace strake {
namespace {

[[noreturn]] void refuse(const PreciceConfig& config, const std::string& problem, const std::string& fix) {
  throw Error(ExitCode::case_file, config.file.string(), problem, fix);
}

const PreciceConfig::Participant& participant_of(const PreciceConfig& config, const std::string& name) {
  if (const auto* found = config.find_participant(name)) return *found;
  std::vector<std::string> names;
  for (const auto& participant : config.participants) names.push_back(participant.name);
  refuse(config, fmt::format("has no participant \"{}\"", name),
         names.empty() ? "it has none: <participant name=\"…\">"
                       : fmt::format("--participant, one of: {}", joined(names)));
}

OwnPart::Data data_of(const PreciceConfig& config, const PreciceConfig::MeshData& id, const OwnPart& part,
                      const QuantityNames& names) {
  if (id.mesh != part.mesh)
    refuse(config,
           fmt::format("participant \"{}\" uses data \"{}\" on mesh \"{}\", which it receives",
                       part.participant, id.data, id.mesh),
           fmt::format("Strake's solvers exchange data on their own mesh alone: mesh=\"{}\"", part.mesh));
  const PreciceConfig::Data& data = *config.find_data(id.data);
  const Quantity quantity = names.of(id.data, config.conservative(id));
  if (quantity.components != 0 && (quantity.components > 1) != data.vector)
    refuse(
        config,
        fmt::format("data \"{}\" is a {}, and Strake's {} is a {}", id.data,
                    data.vector ? "vector" : "scalar", quantity.name, data.vector ? "scalar" : "vector"),
        "<data:vector … /> for force, traction, displacement and velocity, <data:scalar … /> for pressure");
  return {id.data, quantity.name, data.vector ? part.dimension : 1};
}

/// True if an exchange with samples inside a window has the participant at that end.
bool has_samples(const PreciceConfig& config, const std::string& participant,
                 std::string PreciceConfig::Exchange::*end) {
  for (const auto& scheme : config.schemes)
    for (const auto& exchange : scheme.exchanges)
      if (exchange.*end == participant && exchange.substeps) return true;
  return false;
}

bool is_among(const std::string& word, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

OwnPart OwnPart::of(const PreciceConfig& config, const std::string& name, const QuantityNames& names) {
  const PreciceConfig::Participant& own = participant_of(config, name);
  if (own.provided.size() != 1)
    refuse(config, fmt::format("participant \"{}\" provides {} meshes", name, own.provided.size()),
           "Strake's solvers have one mesh each: one <provide-mesh name=\"…\" />");
  OwnPart part;
  part.participant = name;
  part.mesh = own.provided.front();
  part.dimension = config.find_mesh(part.mesh)->dimension;
  for (const auto& id : own.reads) part.reads.push_back(data_of(config, id, part, names));
  for (const auto& id : own.writes) part.writes.push_back(data_of(config, id, part, names));
  part.reads_samples = has_samples(config, name, &PreciceConfig::Exchange::to);
  part.writes_samples = has_samples(config, name, &PreciceConfig::Exchange::from);
  return part;
}

void OwnPart::check_data(const std::string& side, const std::string& config) const {
  const std::vector<std::string> motion = {"displacement", "velocity"}, load = {"force"};
  const bool is_fluid = side == "fluid";
  const auto check = [&](const std::vector<Data>& all, const char* verb,
                         const std::vector<std::string>& able) {
    for (const Data& data : all)
      if (!is_among(data.quantity, able))
        throw Error(ExitCode::case_file, config,
                    fmt::format("participant \"{0}\" {1}s data \"{2}\", which stands for {3}\n"
                                "a {4} of Strake {1}s {5}",
                                participant, verb, data.name, data.quantity, side, joined(able)),
                    fmt::format("where it means the same, say so in the case: {}.precice_names = [\"{}={}\"]",
                                side, data.name, able.front()));
  };
  check(reads, "read", is_fluid ? motion : load);
  check(writes, "write", is_fluid ? load : motion);
  if (writes.empty())
    throw Error(ExitCode::case_file, config, fmt::format("participant \"{}\" writes no data", participant),
                fmt::format("<write-data name=\"…\" mesh=\"{}\" />", mesh));
  const auto is_displacement = [](const Data& data) { return data.quantity == "displacement"; };
  if (is_fluid && std::none_of(reads.begin(), reads.end(), is_displacement))
    throw Error(ExitCode::case_file, config,
                fmt::format("participant \"{}\" reads no displacement, which a fluid follows", participant),
                fmt::format("<read-data name=\"Displacement\" mesh=\"{}\" />", mesh));
}

void OwnPart::check_dimension(int of_case, const std::string& config) const {
  if (of_case == dimension) return;
  throw Error(
      ExitCode::case_file, config,
      fmt::format("mesh \"{}\" has {} dimensions, the case has {}", mesh, dimension, of_case),
      fmt::format("dimensions=\"{}\" there, or fluid.dimension = {} in the case", of_case, dimension));
}

}  // namespace strake
