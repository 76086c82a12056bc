#include "fluid/diagnostics/measurements.hpp"

#include "fluid/particles/archive_member.hpp"

#include <algorithm>
#include <cmath>

namespace strake::fluid {
namespace {

std::string probe_name(std::size_t i) {
  return fmt::format("probe{}", i);
}

}  // namespace

void Measurements::add(const std::optional<Voids>& of_frame) {
  if (lacks_voids()) return;
  voids = of_frame ? std::max(voids, of_frame->all) : -1;
  internal_voids = of_frame ? std::max(internal_voids, of_frame->internal_voids) : -1;
}

double Measurements::of_record(std::int64_t count) const {
  return lacks_voids() ? std::nan("") : static_cast<double>(count);
}

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
