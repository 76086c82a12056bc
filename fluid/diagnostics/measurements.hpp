#pragma once

#include "fluid/diagnostics/guard.hpp"
#include "fluid/particles/member_list.hpp"
#include "proto/interface.hpp"
#include "proto/probe.hpp"

#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace strake::fluid {

/// What the participant has measured of the water since t = 0. The method does not read it. It is copied to
/// rewind and written to resume, as State is.
struct Measurements {
  GuardRecord guard;                // what the guard has seen (guard.hpp)
  std::vector<ProbeRecord> probes;  // in the order of the case; they accumulate at every step
  double contact_time = -1;         // [s] t_c (proto/probe.hpp); < 0: none yet
  std::int64_t voids = 0;  // largest count of surface particles deeper than 5 l0, of the frames (voids.hpp)
  std::int64_t internal_voids = 0;  // the same of those that are not air_connected

  /// Lists all members but the probes and the guard, by their names in a checkpoint; those are probe0, probe1
  /// …
  static constexpr auto values() {
    return std::tuple(std::pair("contact_time", &Measurements::contact_time),  //
                      std::pair("voids", &Measurements::voids),                //
                      std::pair("openings", &Measurements::internal_voids));
  }
};
static_assert(listed_bytes(Measurements::values()) + sizeof(Measurements::probes) + sizeof(GuardRecord) ==
                  sizeof(Measurements),
              "a member of Measurements is not listed in values()");

void save(const Measurements&, Archive&);
/// Reads them back. Throws Error(case_file) naming what is missing; n_probes: as many as the case has.
Measurements load_measurements(const Archive&, std::size_t n_probes);

}  // namespace strake::fluid
