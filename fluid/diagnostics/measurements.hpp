#pragma once

#include "fluid/diagnostics/guard.hpp"
#include "fluid/diagnostics/voids.hpp"
#include "fluid/particles/member_list.hpp"
#include "proto/interface.hpp"
#include "proto/probe.hpp"

#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace strake::fluid {

/// What is said once where voids are not computed.
inline constexpr const char* no_voids_line =
    "voids are not computed: the box around all particles has too many cells; the record has no number for "
    "voids and openings";

/// What the participant has measured of the water since t = 0. The method does not read it. It is copied to
/// rewind and written to resume, as State is.
struct Measurements {
  GuardRecord guard;                // what the guard has seen (guard.hpp)
  std::vector<ProbeRecord> probes;  // in the order of the case; they accumulate at every step
  double contact_time = -1;         // [s] t_c (proto/probe.hpp); < 0: none yet
  std::int64_t voids = 0;  // largest count of surface particles deeper than 5 l0, of the frames (voids.hpp)
  std::int64_t internal_voids = 0;  // the same of those that are not air_connected

  /// Takes the voids of a frame. Once they were not computed, the largest is unknown: both counts are −1.
  void add(const std::optional<Voids>& of_frame);
  bool lacks_voids() const { return voids < 0; }
  /// Returns a count for the record: not a number where it is unknown.
  double of_record(std::int64_t count) const;

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
