#include "fluid/diagnostics/energy_and_gauges.hpp"
#include "fluid/mps/interface_load.hpp"
#include "fluid/participant.hpp"

#include <algorithm>
#include <cmath>

namespace strake::fluid {

template <int dim>
std::vector<Column> FluidParticipant<dim>::columns() const {
  std::vector<Column> columns;
  for (const ProbeKeys& probe : parameters_.probes) {
    if (!is_sensor(probe)) {
      columns.push_back({probe.name, "m"});
      continue;
    }
    for (const char* suffix : {"", ".min", ".max", ".mean"}) columns.push_back({probe.name + suffix, "Pa"});
    columns.push_back({probe.name + ".impulse", "Pa s"});
  }
  if (!has_body_) columns.push_back({"floor.y", "N"});
  columns.push_back({"cfl", "1"});
  columns.push_back({"pressure_iterations", "1"});
  const std::string energy = dim == 2 ? "J/m" : "J";
  columns.push_back({"water.kinetic_energy", energy});
  columns.push_back({"water.potential_energy", energy});
  columns.push_back({"water.largest_speed", "m/s"});
  for (int d = 0; d < dim; ++d) columns.push_back({std::string("water.centre.") + "xyz"[d], "m"});
  columns.push_back({"water.inner", "1"});
  columns.push_back({"water.surface", "1"});
  columns.push_back({"water.volume", dim == 2 ? "m^2" : "m^3"});
  return columns;
}

template <int dim>
void FluidParticipant<dim>::report_sensors(std::map<std::string, double>& monitor) const {
  const auto& records = measurements_.probes;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::string& name = parameters_.probes[i].name;
    monitor[name] = records[i].last();
    records[i].report(name, monitor);
    if (!is_sensor(parameters_.probes[i])) continue;
    monitor[name + ".min"] = records[i].window_min();
    monitor[name + ".max"] = records[i].window_max();
    monitor[name + ".mean"] = records[i].window_mean();
    monitor[name + ".impulse"] = records[i].running_impulse();
  }
}

/// Reports energies, speed and centre of mass. Where a frame is due it also reports the volume and its change
/// since t = 0.
template <int dim>
void FluidParticipant<dim>::report_water(std::map<std::string, double>& monitor) const {
  const double mass = parameters_.density * std::pow(parameters_.spacing, dim);
  const WaterAccount<dim> account =
      account_of<dim>(simulation_.state(), water(), mass, parameters_.gravity.template head<dim>(),
                      parameters_.tank.min.template head<dim>());
  monitor["water.kinetic_energy"] = account.kinetic;
  monitor["water.potential_energy"] = account.potential;
  monitor["water.largest_speed"] = account.largest_speed;
  for (int d = 0; d < dim; ++d) monitor[std::string("water.centre.") + "xyz"[d]] = account.centre[d];
  monitor["water.inner"] = static_cast<double>(account.inner);
  monitor["water.surface"] = static_cast<double>(account.surface);
  if (!measures_water_) return;
  const double now = volume();
  monitor["water.volume"] = now;
  monitor["check.volume_drift"] = now / initial_volume_ - 1;
}

template <int dim>
void FluidParticipant<dim>::report_accounts(std::map<std::string, double>& monitor) const {
  const State<dim>& state = simulation_.state();
  std::int64_t water = 0, wall = 0, body = 0, solid = 0;
  for (const Kind kind : state.kind) {
    water += kind == Kind::fluid ? 1 : 0;
    wall += kind == Kind::wall || kind == Kind::dummy_wall ? 1 : 0;
    body += kind == Kind::interface || kind == Kind::dummy_interface ? 1 : 0;
    solid += kind == Kind::solid ? 1 : 0;
  }
  monitor["count.fluid"] = static_cast<double>(water);
  monitor["count.wall"] = static_cast<double>(wall);
  monitor["count.body"] = static_cast<double>(body);
  monitor["count.solid"] = static_cast<double>(solid);
  monitor["count.steps"] = static_cast<double>(progress_.steps);
  // The run waits for the contact of a body that enters, where a sensor of pressure can detect it.
  const std::vector<ProbeKeys>& probes = parameters_.probes;
  const bool detects = std::any_of(probes.begin(), probes.end(), is_sensor);
  if (entry_speed_ > 0 && detects && measurements_.contact_time < 0) monitor["count.awaiting_contact"] = 1;
  monitor["count.steps_committed"] = static_cast<double>(state.step);
  for (const char* prefix : {"count.", "check."}) {
    monitor[prefix + std::string("lost")] = static_cast<double>(state.lost);
    monitor[prefix + std::string("voids")] = static_cast<double>(measurements_.voids);
    monitor[prefix + std::string("openings")] = static_cast<double>(measurements_.internal_voids);
    monitor[prefix + std::string("penetrations")] = static_cast<double>(state.penetrations);
  }
  monitor["count.behind_walls"] = static_cast<double>(state.behind_walls);
  monitor["check.inner_fraction_min"] = state.inner_fraction_min;
  monitor["check.momentum_gap"] = momentum_gap();
}

/// Returns |momentum not accounted for| over 2ρVa², in space over 2ρVa³. Where nothing enters the scale is
/// the largest impulse so far.
template <int dim>
double FluidParticipant<dim>::momentum_gap() const {
  const State<dim>& state = simulation_.state();
  const double mass = parameters_.density * std::pow(parameters_.spacing, dim), half = 0.5 * body_length_;
  double scale = 2 * parameters_.density * entry_speed_ * std::pow(half, dim);
  if (scale == 0)
    scale = std::max(
        {state.impulse_of_gravity.norm(), state.impulse_on_walls.norm(), state.impulse_on_bodies.norm()});
  return scale > 0 ? fluid::momentum_gap<dim>(state, mass).norm() / scale : 0.0;
}

#define STRAKE_INSTANTIATE(dim)                                                               \
  template std::vector<Column> FluidParticipant<dim>::columns() const;                        \
  template void FluidParticipant<dim>::report_sensors(std::map<std::string, double>&) const;  \
  template void FluidParticipant<dim>::report_water(std::map<std::string, double>&) const;    \
  template void FluidParticipant<dim>::report_accounts(std::map<std::string, double>&) const; \
  template double FluidParticipant<dim>::momentum_gap() const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
