#include "fluid/participant.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

// What the participant says of the air under a body: before the run, in its columns, of its probes.

namespace strake::fluid {

/// What the air under the body is like before the impact. V a/c0 is the gap from which on the air is
/// compressed; wider ones let it flow out. The water yields to the flow of air by the depression of deep
/// water (fluid/THEORY.md, section 17a).
template <int dim>
std::string FluidParticipant<dim>::air_line() const {
  const Parameters& p = parameters_;
  const double speed = start_speeds_.entry;
  const auto extent = simulation_.air_extent();
  const double a = extent.half_width, c0 = std::sqrt(p.air.gamma * p.air.pressure / p.air.density);
  const double gap = simulation_.state().air_gap.minCoeff();
  constexpr double start_gap = 0.2;  // [a] over which the flow of air is too slow to move the water
  std::string line = fmt::format("air under the body: {} columns over {:.3g} {}   gap {:.3g} m",
                                 extent.columns, extent.area, dim == 2 ? "m" : "m^2", gap);
  if (!(speed > 0)) return line;
  const double compressed = speed * a / c0;
  line += fmt::format("   compressed below V a/c0 = {:.3g} m", compressed);
  if (dim == 2 && gap > compressed)
    line += fmt::format("   the water sinks by {:.2g} m before",
                        4 / std::numbers::pi * p.air.density / p.density * a *
                            (std::log(gap / compressed) - 1 + compressed / gap));
  if (gap < start_gap * a)
    line += fmt::format("   a plate that falls from far sinks it more: start with a gap of {:.2g} m",
                        start_gap * a);
  return line;
}

/// Refuses a probe of the air where none is computed.
template <int dim>
void FluidParticipant<dim>::check_air_probe(const ProbeKeys& probe) const {
  const std::string where = fmt::format("output.probe \"{}\"", probe.name);
  if (!parameters_.air.layer)
    throw Error(ExitCode::case_file, where,
                fmt::format("quantity \"{}\" needs the air under a body, which this case does not compute",
                            probe.quantity),
                "fluid.air.layer = true, or another quantity");
  const double away = simulation_.air_at(probe.at).distance;
  if (away <= 2 * parameters_.spacing) return;
  throw Error(
      ExitCode::case_file, where,
      fmt::format("no lower face of the body is near ({:.6g}, {:.6g}) m: the nearest is {:.3g} m away",
                  probe.at[0], probe.at[1], away),
      "place it on a face that looks down");
}

/// Reports the air under the body: what is left (as mass, and as a thickness at the open air's pressure) and
/// what has gone, the narrowest gap that holds air, and the largest pressure less that of the open air. The
/// checks: mass that is neither left nor gone, and energy, as a share of what was given (fluid/THEORY.md,
/// (F83)).
template <int dim>
void FluidParticipant<dim>::report_air(std::map<std::string, double>& monitor) const {
  const State<dim>& state = simulation_.state();
  const double mass = simulation_.air_mass();
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index c = 0; c < state.air_mass.size(); ++c)
    if (state.air_mass[c] > 0) least = std::min(least, state.air_gap[c]);
  monitor["air.mass"] = mass;
  monitor["air.left"] = mass / (parameters_.air.density * simulation_.air_extent().area);
  monitor["air.out"] = state.air_out;
  monitor["air.least_gap"] = std::isfinite(least) ? least : 0;
  monitor["air.largest_pressure"] = state.air_pressure.size() > 0 ? state.air_pressure.maxCoeff() : 0;
  monitor["check.air_mass"] = (mass + state.air_out) / state.air_at_start - 1;
  monitor["check.air_energy"] =
      (simulation_.air_energy() - state.air_energy_due) / std::max(state.air_energy_given, 1e-300);
}

#define STRAKE_INSTANTIATE(dim)                                                 \
  template std::string FluidParticipant<dim>::air_line() const;                 \
  template void FluidParticipant<dim>::check_air_probe(const ProbeKeys&) const; \
  template void FluidParticipant<dim>::report_air(std::map<std::string, double>&) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
