#include "coupler/coupling/scheme.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

namespace strake {
namespace {

using Eigen::MatrixXd;

[[noreturn]] void missing(const std::string& name) {
  throw Error(ExitCode::case_file, "checkpoint, coupler.h5", fmt::format("{} is missing", name),
              "resume from the other checkpoint");
}

const MatrixXd& get(const Archive& archive, const std::string& name) {
  const auto found = archive.real.find(name);
  if (found == archive.real.end() || found->second.size() == 0) missing(name);
  return found->second;
}

/// "coupling.structure.1.00.displacement": sample 1, field 0; the number keeps the fields' order.
std::string sample_name(const char* side, std::size_t k) {
  return fmt::format("coupling.{}.{}.", side, k);
}

const std::vector<Field>& fields_of(const Sample& sample) {
  return sample.fields;
}

std::vector<Field> fields_of(const StructureSample& sample) {
  return sample.fields();
}

template <class T>
void put(Archive& archive, const char* side, const std::vector<T>& samples) {
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const std::string name = sample_name(side, k);
    archive.real[name + "time"] = MatrixXd::Constant(1, 1, samples[k].time);
    int f = 0;
    const auto& fields = fields_of(samples[k]);
    for (const Field& field : fields)
      archive.real[fmt::format("{}{:02}.{}", name, f++, field.quantity)] = field.value;
  }
}

Samples get(const Archive& archive, const char* side, std::int64_t n_samples) {
  constexpr std::size_t digits = 3;  // of the field's number, with its dot
  Samples samples;
  for (std::int64_t k = 0; k < n_samples; ++k) {
    const std::string name = sample_name(side, static_cast<std::size_t>(k));
    Sample sample = {get(archive, name + "time").value(), {}};
    for (auto at = archive.real.lower_bound(name); at != archive.real.end() && at->first.starts_with(name);
         ++at)
      if (at->first != name + "time" && at->first.size() > name.size() + digits)
        sample.fields.push_back({at->first.substr(name.size() + digits), "", false, at->second});
    samples.push_back(std::move(sample));
  }
  return samples;
}

}  // namespace

void CouplingState::save(Archive& archive) const {
  archive.integer["coupling.counts"] = {
      windows, sends_velocity ? 1 : 0, static_cast<std::int64_t>(structure.size()),
      static_cast<std::int64_t>(fluid.size()), static_cast<std::int64_t>(history.size())};
  if (!structure_history.empty())
    archive.integer["coupling.structure_history"] = {static_cast<std::int64_t>(structure_history.size())};
  archive.real["coupling.velocity_scale"] = MatrixXd::Constant(1, 1, velocity_scale);
  put(archive, "structure", structure);
  put(archive, "fluid", fluid);
  put(archive, "history", history);
  put(archive, "structure_history", structure_history);
  accelerator.save(archive);
}

void CouplingState::load(const Archive& archive) {
  *this = {};
  const auto counts = archive.integer.find("coupling.counts");
  if (counts == archive.integer.end() || counts->second.size() != 5) missing("coupling.counts");
  windows = static_cast<int>(counts->second[0]);
  sends_velocity = counts->second[1] != 0;
  velocity_scale = get(archive, "coupling.velocity_scale").value();
  for (Sample& sample : get(archive, "structure", counts->second[2]))
    structure.push_back(StructureSample::of(std::move(sample)));
  fluid = get(archive, "fluid", counts->second[3]);
  history = get(archive, "history", counts->second[4]);
  const auto more = archive.integer.find("coupling.structure_history");  // none: the fluid takes no histories
  if (more != archive.integer.end() && more->second.size() == 1)
    for (Sample& sample : get(archive, "structure_history", more->second.front()))
      structure_history.push_back(StructureSample::of(std::move(sample)));
  accelerator.load(archive);
}

}  // namespace strake
