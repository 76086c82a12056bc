#include "fluid/diagnostics/energy_and_gauges.hpp"
#include "fluid/geometry/tank_shape.hpp"
#include "fluid/mps/interface_load.hpp"
#include "fluid/participant.hpp"
#include "proto/error.hpp"
#include "proto/peak_memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::fluid {
namespace {

/// Returns the height that water can fall through along gravity: from its highest place at the start to the
/// tank's floor, across the tank where gravity is inclined. It is infinite along a direction that repeats
/// itself. A tank that moves may throw its water to the top.
template <int dim>
double drop_of(const Parameters& p) {
  double drop = 0;
  const double g = p.gravity.norm();
  for (int d = 0; d < dim && g > 0; ++d) {
    if (p.gravity[d] == 0) continue;
    const bool falls = d == 1 && p.gravity[1] < 0 && !p.motion.moves();
    const double extent = (falls ? p.water.max[d] : p.tank.max[d]) - p.tank.min[d];
    drop += p.periodic[static_cast<std::size_t>(d)] ? std::numeric_limits<double>::infinity()
                                                    : std::abs(p.gravity[d]) / g * extent;
  }
  return drop;
}

/// Returns a², in space ab min(a, b), a and b being half the extents of a body along x and z. `size` has both
/// extents. The added mass of a disc is 4/3 ρa³, that of a strip ½πρb² per length: a slender body moves water
/// as its narrower width does. A body from side to side of the tank, to walls or seams, moves it as in the
/// plane: a² times that length.
template <int dim>
double moved_water(const Parameters& p, const Eigen::Vector2d& size) {
  const Eigen::Vector2d half = 0.5 * size;
  if (dim == 2) return half[0] * half[0];
  const Eigen::Vector3d room = p.tank.max - p.tank.min;
  const double slack = 0.5 * p.spacing;
  const bool along_x = size[0] > room.x() - slack, along_z = size[1] > room.z() - slack;
  if (along_x == along_z) return half.prod() * half.minCoeff();
  return along_z ? half[0] * half[0] * size[1] : half[1] * half[1] * size[0];
}

/// Returns the largest speed of the tank's walls over the run, from a thousand instants [m/s].
double tank_speed(const Parameters& p) {
  if (!p.motion.moves()) return 0;
  constexpr int instants = 1000;
  const double size = (p.tank.max - p.tank.min).norm();
  double largest = 0;
  for (int k = 0; k <= instants; ++k) {
    const RigidMotion motion = p.motion.at(p.end_time * k / instants);
    largest = std::max(largest, motion.velocity.norm() + std::abs(motion.angular_velocity) * size);
  }
  return largest;
}

/// Distance of a probe from the nearest point of the body [m]. nearest: its number.
double to_body(const InterfaceMesh& body, const ProbeKeys& probe, Eigen::Index* nearest = nullptr) {
  if (body.position.cols() == 0) return std::numeric_limits<double>::infinity();
  Eigen::Index point = 0;
  const double distance = (body.position.colwise() - probe.at).colwise().norm().minCoeff(&point);
  if (nearest != nullptr) *nearest = point;
  return distance;
}

std::string place_text(const Eigen::Vector3d& at, int dim) {
  return fmt::format("({:.6g}, {:.6g}{})", at[0], at[1], dim == 3 ? fmt::format(", {:.6g}", at[2]) : "");
}

}  // namespace

/// Returns for each probe whether it is a sensor that covers a point of the body at the start.
template <int dim>
std::vector<char> FluidParticipant<dim>::sensors_on_body() const {
  std::vector<char> on_body;
  for (const ProbeKeys& probe : parameters_.probes)
    on_body.push_back(is_sensor(probe) && to_body(mesh(), probe) <= 0.5 * probe.diameter);
  return on_body;
}

/// Refuses a sensor that covers no point, since its value would always be zero.
template <int dim>
void FluidParticipant<dim>::check_sensors() const {
  for (std::size_t i = 0; i < on_body_.size(); ++i) {
    const ProbeKeys& probe = parameters_.probes[i];
    if (is_of_air(probe)) check_air_probe(probe);
    if (!is_sensor(probe) || on_body_[i] != 0) continue;
    // To the middle of the nearest wall particle's face, at worst.
    const double to_walls = std::abs(TankShape<dim>(parameters_).distance(probe.at.template head<dim>())) +
                            0.5 * parameters_.spacing;
    if (to_walls <= 0.5 * probe.diameter) continue;
    Eigen::Index nearest = 0;
    const double away = to_body(mesh(), probe, &nearest);
    throw Error(
        ExitCode::case_file, fmt::format("output.probe \"{}\"", probe.name),
        fmt::format("its sensor at {} m of diameter {:.6g} m covers no point of the {}tank's walls: the "
                    "nearest is {:.3g} m away{}",
                    place_text(probe.at, dim), probe.diameter, has_body() ? "body or the " : "",
                    std::min(to_walls, away),
                    away < to_walls ? ", at " + place_text(mesh().position.col(nearest), dim) +
                                          " m of the body where it starts, after structure.placed"
                                    : ""),
        fmt::format(
            "place it on {} of the tank, or enlarge its diameter; the pressure inside the water stands "
            "in the frames (output.every)",
            has_body() ? "the body's surface or a wall" : "a wall"));
  }
}

template <int dim>
std::vector<Column> FluidParticipant<dim>::columns() const {
  std::vector<Column> columns;
  for (const ProbeKeys& probe : parameters_.probes) {
    if (!is_sensor(probe)) {
      columns.push_back({probe.name, probe.quantity == "air_pressure" ? "Pa" : "m"});
      continue;
    }
    for (const char* suffix : {"", ".min", ".max", ".mean"}) columns.push_back({probe.name + suffix, "Pa"});
    columns.push_back({probe.name + ".impulse", "Pa s"});
  }
  if (!has_body()) columns.push_back({"floor.y", dim == 2 ? "N/m" : "N"});
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
  if (parameters_.air.layer) {
    columns.push_back({"air.mass", dim == 2 ? "kg/m" : "kg"});
    columns.push_back({"air.left", "m"});
    columns.push_back({"air.out", dim == 2 ? "kg/m" : "kg"});
    columns.push_back({"air.least_gap", "m"});
    columns.push_back({"air.largest_pressure", "Pa"});
  }
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
  const WaterAccount<dim> account = together(
      account_of<dim>(simulation_.state(), own_water(), mass, parameters_.gravity.template head<dim>(),
                      parameters_.tank.min.template head<dim>()),
      simulation_.ranks());
  monitor["water.kinetic_energy"] = account.kinetic;
  monitor["water.potential_energy"] = account.potential;
  monitor["water.largest_speed"] = account.largest_speed;
  for (int d = 0; d < dim; ++d) monitor[std::string("water.centre.") + "xyz"[d]] = account.centre[d];
  monitor["water.inner"] = static_cast<double>(account.inner);
  monitor["water.surface"] = static_cast<double>(account.surface);
  if (parameters_.air.layer) report_air(monitor);
  if (!measures_water_) return;
  const double now = volume();
  monitor["water.volume"] = now;
  monitor["check.volume_drift"] = now / initial_volume_ - 1;
}

template <int dim>
void FluidParticipant<dim>::report_accounts(std::map<std::string, double>& monitor) const {
  const State<dim>& state = simulation_.state();
  std::int64_t water = 0, wall = 0, body = 0, solid = 0;
  for (std::size_t i = 0; i < state.kind.size(); ++i) {
    const Kind kind = state.kind[i];
    water += kind == Kind::fluid && simulation_.ranks().owns(static_cast<std::int64_t>(i)) ? 1 : 0;
    wall += kind == Kind::wall || kind == Kind::dummy_wall ? 1 : 0;
    body += kind == Kind::interface || kind == Kind::dummy_interface ? 1 : 0;
    solid += kind == Kind::solid ? 1 : 0;
  }
  water = simulation_.ranks().sum(water);
  monitor["count.fluid"] = static_cast<double>(water);
  monitor["count.wall"] = static_cast<double>(wall);
  monitor["count.body"] = static_cast<double>(body);
  monitor["count.solid"] = static_cast<double>(solid);
  monitor["count.steps"] = static_cast<double>(progress_.steps);
  // The run waits for the contact of a body that enters, where something can detect it.
  const bool detects = start_speeds_.contact.whole_body ||
                       std::ranges::any_of(on_body_, [](char on_body) { return on_body != 0; });
  if (start_speeds_.contact.waits && detects && measurements_.contact_time < 0)
    monitor["count.awaiting_contact"] = 1;
  if (start_speeds_.contact.whole_body && measurements_.contact_time >= 0)
    monitor[contact_of_body] = measurements_.contact_time;
  monitor["count.steps_committed"] = static_cast<double>(state.step);
  for (const char* prefix : {"count.", "check."}) {
    monitor[prefix + std::string("lost")] = static_cast<double>(state.lost);
    monitor[prefix + std::string("voids")] = measurements_.of_record(measurements_.voids);
    monitor[prefix + std::string("openings")] = measurements_.of_record(measurements_.internal_voids);
    monitor[prefix + std::string("penetrations")] = static_cast<double>(state.penetrations);
  }
  monitor["count.behind_walls"] = static_cast<double>(state.behind_walls);
  monitor["check.inner_fraction_min"] = state.inner_fraction_min;
  monitor["check.momentum_gap"] = momentum_gap();
}

/// Reports the seconds, particles and memory of each rank, and the sum of all memory.
template <int dim>
void FluidParticipant<dim>::report_ranks(std::map<std::string, double>& monitor) const {
  if (!simulation_.ranks().several()) return;
  struct OfRank {
    double busy, halo, waiting, own, ghosts, memory, sent, cpu;
  };
  const Communicator& ranks = *simulation_.ranks().communicator();
  const Communicator::Account& account = ranks.account();
  const auto own = std::ranges::count(simulation_.ranks().subdomain()->division().owner, ranks.rank());
  const std::int64_t local = simulation_.ranks().subdomain()->local_water();
  OfRank of{0,
            account.seconds_apart,
            account.seconds_together,
            static_cast<double>(own),
            static_cast<double>(local - own),
            peak_memory(),
            static_cast<double>(account.bytes),
            processor_time(CLOCK_PROCESS_CPUTIME_ID) - account.cpu};
  for (const auto& [stage, seconds] : simulation_.seconds())
    if (stage != "halo" && stage != "waiting") of.busy += seconds;
  int rank = 0;
  double memory = 0;
  for (const OfRank& each : simulation_.ranks().communicator()->all(of)) {
    const std::string prefix = fmt::format("ranks.{}.", rank++);
    monitor[prefix + "busy"] = each.busy;
    monitor[prefix + "halo"] = each.halo;
    monitor[prefix + "waiting"] = each.waiting;
    monitor[prefix + "particles"] = each.own;
    monitor[prefix + "ghosts"] = each.ghosts;
    monitor[prefix + "memory"] = each.memory;
    monitor[prefix + "sent"] = each.sent;
    monitor[prefix + "cpu"] = each.cpu;
    memory += each.memory;
  }
  monitor["memory.peak"] = memory;
}

template <int dim>
double FluidParticipant<dim>::body_width() const {
  double widest = 0;
  for (const Eigen::Vector2d& size : bodies_.sizes) widest = std::max(widest, size[0]);
  return widest;
}

/// Returns 2ρV times the `moved_water` of all bodies. Where nothing enters it is the largest impulse so far,
/// or the mass of the water times the largest speed that the case gives it, where that is more. With a body
/// that stands in the water under gravity only the impulse on bodies counts, and at least that of the weight
/// of the water in their place: loads on the two sides of a wall cancel. Gravity and walls carry the weight
/// of the whole tank: beside that no gap shows, and the less the larger the tank. In a tank that moves they
/// count too, because its walls move the water.
template <int dim>
double FluidParticipant<dim>::momentum_scale() const {
  const State<dim>& state = simulation_.state();
  double moved = 0;
  for (const Eigen::Vector2d& size : bodies_.sizes) moved += moved_water<dim>(parameters_, size);
  const double scale = 2 * parameters_.density * start_speeds_.entry * moved;
  if (scale > 0) return scale;
  const double mass = parameters_.density * std::pow(parameters_.spacing, dim);
  const double own =
      start_speeds_.water > 0
          ? mass * static_cast<double>(simulation_.ranks().sum(std::ssize(own_water()))) * start_speeds_.water
          : 0;
  const double on_bodies = state.impulse_on_bodies.norm(), by_gravity = state.impulse_of_gravity.norm();
  if (parameters_.submerged && !parameters_.motion.moves() && on_bodies > 0 && initial_volume_ > 0 &&
      by_gravity > 0)
    return std::max({on_bodies, own, by_gravity * bodies_.volume / initial_volume_});
  return std::max({by_gravity, state.impulse_on_walls.norm(), on_bodies, own});
}

/// Returns |momentum not accounted for| over `momentum_scale`.
template <int dim>
double FluidParticipant<dim>::momentum_gap() const {
  const double mass = parameters_.density * std::pow(parameters_.spacing, dim), scale = momentum_scale();
  return scale > 0 ? fluid::momentum_gap<dim>(simulation_.state(), mass, simulation_.ranks()).norm() / scale
                   : 0.0;
}

template <int dim>
GuardScales FluidParticipant<dim>::guard_scales() const {
  const Parameters& p = parameters_;
  return {.density = p.density,
          .sound_speed = p.sound_speed,
          .spacing = p.spacing,
          .cfl = p.scheme.cfl,
          .gravity = p.gravity.norm(),
          .gravity_ramp = p.gravity_ramp,
          .top = p.water.max.y(),
          .drop = drop_of<dim>(p),
          .half_width = 0.5 * body_width(),
          .tank_speed = tank_speed(p),
          .water_speed = start_speeds_.water,
          .enters = start_speeds_.entry > 0,
          .submerged = p.submerged,
          .has_faces = p.interface != "volume"};
}

template <int dim>
void FluidParticipant<dim>::watch_step(double t1, double dt, double speed, WindowExtremes& of) const {
  const auto take = [&](Extreme found, Extreme& largest) {
    if (found.value <= largest.value) return;
    largest = found;
    largest.time = t1;
    largest.step = dt;
  };
  if (speed > of.speed.value) take(simulation_.fastest(), of.speed);
  take(simulation_.highest_pressure(), of.pressure);
}

template <int dim>
void FluidParticipant<dim>::watch_window(const Window& window, const WindowExtremes& extremes) {
  const std::vector<FacePiece> pieces = simulation_.face_pieces();
  guard_.faces(measurements_.guard, pieces);
  const Vectors<dim>& velocity = simulation_.state().interface_velocity;
  if (pieces.empty() && velocity.cols() > 0)
    guard_.body(measurements_.guard, velocity.colwise().norm().maxCoeff());
  guard_.water_on_faces(measurements_.guard, window.t + window.dt, window.dt, pieces);
  guard_.extremes(measurements_.guard, extremes);
}

/// Passes the accounts of a window to the guard, and its alarms to the coupler. The gap of a body that enters
/// is compared with `momentum_scale`, V at least √(g a), or the impulse on it, where that is more: a load is
/// known as well as its impulse. Else it is compared with a hundredth of the water's own M√(gH) while little
/// has happened: a share of nothing says nothing.
template <int dim>
void FluidParticipant<dim>::watch_accounts(std::map<std::string, double>& monitor) {
  const State<dim>& state = simulation_.state();
  GuardRecord& record = measurements_.guard;
  const double mass = parameters_.density * std::pow(parameters_.spacing, dim) * monitor.at("count.fluid");
  const double depth = parameters_.water.max.y() - parameters_.tank.min.y();
  const double g = parameters_.gravity.norm(), entry = start_speeds_.entry;
  constexpr double little = 0.01;
  const double scale = momentum_scale();
  double other = little * mass * std::sqrt(g * depth);
  if (entry > 0)
    other = std::max(state.impulse_on_bodies.norm(), scale * std::sqrt(g * 0.5 * body_width()) / entry);
  const double least = std::max(scale, other);
  if (least > 0) guard_.momentum(record, state.time, monitor.at("check.momentum_gap") * scale / least);
  if (measures_water_) {
    guard_.volume(record, state.time, monitor.at("check.volume_drift"));
    guard_.hollow(record, state.time, monitor.at("check.openings") / monitor.at("count.fluid"));
  }
  guard_.report(record, monitor);
}

#define STRAKE_INSTANTIATE(dim)                                                                   \
  template std::vector<char> FluidParticipant<dim>::sensors_on_body() const;                      \
  template void FluidParticipant<dim>::check_sensors() const;                                     \
  template std::vector<Column> FluidParticipant<dim>::columns() const;                            \
  template void FluidParticipant<dim>::report_sensors(std::map<std::string, double>&) const;      \
  template void FluidParticipant<dim>::report_water(std::map<std::string, double>&) const;        \
  template void FluidParticipant<dim>::report_accounts(std::map<std::string, double>&) const;     \
  template double FluidParticipant<dim>::body_width() const;                                      \
  template double FluidParticipant<dim>::momentum_gap() const;                                    \
  template void FluidParticipant<dim>::report_ranks(std::map<std::string, double>&) const;        \
  template GuardScales FluidParticipant<dim>::guard_scales() const;                               \
  template void FluidParticipant<dim>::watch_step(double, double, double, WindowExtremes&) const; \
  template void FluidParticipant<dim>::watch_window(const Window&, const WindowExtremes&);        \
  template void FluidParticipant<dim>::watch_accounts(std::map<std::string, double>&);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
