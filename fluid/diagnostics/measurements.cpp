#include "fluid/diagnostics/measurements.hpp"

#include "fluid/particles/archive_member.hpp"

namespace strake::fluid {
namespace {

std::string probe_name(std::size_t i) {
  return fmt::format("probe{}", i);
}

}  // namespace

void save(const Measurements& measurements, Archive& archive) {
  for_each_member(
      Measurements::values(), [&](const char* name, const auto& value) { put(archive, name, value); },
      measurements);
  save(measurements.guard, archive);
  for (std::size_t i = 0; i < measurements.probes.size(); ++i)
    measurements.probes[i].save(probe_name(i), archive);
}

Measurements load_measurements(const Archive& archive, std::size_t n_probes) {
  Measurements measurements;
  for_each_member(
      Measurements::values(), [&](const char* name, auto& value) { get(archive, name, value); },
      measurements);
  measurements.guard = load_guard(archive);
  measurements.probes.resize(n_probes);
  for (std::size_t i = 0; i < n_probes; ++i) measurements.probes[i].load(probe_name(i), archive);
  return measurements;
}

}  // namespace strake::fluid
