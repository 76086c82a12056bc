#include "fluid/particles/state_archive.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

namespace strake::fluid {
namespace {

/// Calls visit(name, member) for every real array of the state: one list for both directions.
template <class State, class Visit>
void for_each_real(State& s, Visit&& visit) {
  visit("position", s.position);
  visit("velocity", s.velocity);
  visit("pressure", s.pressure);
  visit("sps_k", s.sps_k);
  visit("residual_divergence", s.residual_divergence);
  visit("residual_approach", s.residual_approach);
  visit("interface_displacement", s.interface_displacement);
  visit("interface_velocity", s.interface_velocity);
  visit("impulse_on_bodies", s.impulse_on_bodies);
  visit("impulse_on_walls", s.impulse_on_walls);
  visit("impulse_of_gravity", s.impulse_of_gravity);
  visit("impulse_of_collisions", s.impulse_of_collisions);
  visit("initial_momentum", s.initial_momentum);
}

std::string probe_name(std::size_t i) {
  return fmt::format("probe{}", i);
}

template <class Map>
const auto& entry(const Map& map, const std::string& name) {
  const auto found = map.find(name);
  if (found == map.end())
    throw Error(ExitCode::case_file, "checkpoint of the fluid", fmt::format("holds no {}", name));
  return found->second;
}

}  // namespace

template <int dim>
void save(const State<dim>& state, Archive& archive) {
  for_each_real(state, [&](const char* name, const auto& value) { archive.real[name] = value; });
  archive.real["scalars"] =
      Eigen::Vector4d(state.time, state.contact_time, state.inner_fraction_min, state.residual_step);
  archive.integer["counts"] = {state.step,         state.lost,         state.voids,
                               state.penetrations, state.behind_walls, state.openings};
  archive.integer["id"] = state.id;
  auto& kind = archive.integer["kind"];
  for (const Kind k : state.kind) kind.push_back(static_cast<std::int64_t>(k));
  archive.integer["surface"].assign(state.surface.begin(), state.surface.end());
  archive.integer["aired"].assign(state.aired.begin(), state.aired.end());
  for (std::size_t i = 0; i < state.probes.size(); ++i) state.probes[i].save(probe_name(i), archive);
}

template <int dim>
State<dim> load(const Archive& archive, std::size_t n_probes) {
  State<dim> state;
  for_each_real(state, [&](const char* name, auto& value) {
    using Value = std::remove_reference_t<decltype(value)>;
    const auto& stored = entry(archive.real, name);
    if ((Value::RowsAtCompileTime != Eigen::Dynamic && stored.rows() != Value::RowsAtCompileTime) ||
        (Value::ColsAtCompileTime != Eigen::Dynamic && stored.cols() != Value::ColsAtCompileTime))
      throw Error(ExitCode::case_file, "checkpoint of the fluid",
                  fmt::format("{} is {}×{}, not of this case", name, stored.rows(), stored.cols()));
    value = stored;
  });
  const auto& scalars = entry(archive.real, "scalars");
  const auto& counts = entry(archive.integer, "counts");
  if (scalars.size() != 4 || counts.size() != 6)
    throw Error(ExitCode::case_file, "checkpoint of the fluid", "is of another version");
  state.time = scalars(0);
  state.contact_time = scalars(1);
  state.residual_step = scalars(3);
  state.inner_fraction_min = scalars(2);
  state.step = counts[0];
  state.lost = counts[1];
  state.voids = counts[2];
  state.penetrations = counts[3];
  state.behind_walls = counts[4];
  state.openings = counts[5];
  state.id = entry(archive.integer, "id");
  for (const auto k : entry(archive.integer, "kind")) state.kind.push_back(static_cast<Kind>(k));
  for (const auto s : entry(archive.integer, "surface"))
    state.surface.push_back(static_cast<std::uint8_t>(s));
  for (const auto a : entry(archive.integer, "aired")) state.aired.push_back(static_cast<std::uint8_t>(a));
  const auto n = static_cast<std::size_t>(state.position.cols());
  if (state.velocity.cols() != state.position.cols() || state.pressure.size() != state.position.cols() ||
      state.kind.size() != n || state.id.size() != n || state.surface.size() != n || state.aired.size() != n)
    throw Error(ExitCode::case_file, "checkpoint of the fluid", "has arrays of different lengths");
  state.probes.resize(n_probes);
  for (std::size_t i = 0; i < n_probes; ++i) state.probes[i].load(probe_name(i), archive);
  return state;
}

template void save<2>(const State<2>&, Archive&);
template void save<3>(const State<3>&, Archive&);
template State<2> load<2>(const Archive&, std::size_t);
template State<3> load<3>(const Archive&, std::size_t);

}  // namespace strake::fluid
