#include "fluid/participant.hpp"

#include "fluid/diagnostics/energy_and_gauges.hpp"
#include "fluid/level_face.hpp"
#include "proto/error.hpp"
#include "proto/geometry/face_direction.hpp"
#include "proto/peak_memory.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace strake::fluid {
namespace {

/// Ratio of the step of water at rest to the stable step, above which the flow has blown up.
constexpr double most_refinement = 1000;

/// Returns the largest speed of the body's points against the tank at t = 0:
/// |v_i − (v_T + ω_T × (x_i − pivot))|.
double largest_speed(const Setup& setup, const TankMotion& tank) {
  const Field* velocity = find(setup.partner_initial, "velocity");
  if (velocity == nullptr || velocity->value.cols() == 0) return 0;
  const RigidMotion frame = tank.at(0);
  const Eigen::Vector3d turn(0, 0, frame.angular_velocity);
  double largest = 0;
  for (Eigen::Index i = 0; i < velocity->value.cols(); ++i) {
    const Eigen::Vector3d arm = setup.partner_mesh.position.col(i) - tank.pivot;
    const Eigen::Vector3d walls = frame.velocity + turn.cross(arm), body = velocity->value.col(i);
    const double speed = (body - walls).norm();
    if (speed > 1e-9 * (body.norm() + walls.norm())) largest = std::max(largest, speed);  // else round-off
  }
  return largest;
}

/// Whether the body starts above the water.
bool is_above(const Parameters& p, const InterfaceMesh& body) {
  constexpr double slack = 1e-9;  // [l0]
  return body.position.cols() > 0 && body.position.row(1).minCoeff() > p.water.max.y() - slack * p.spacing;
}

/// Speed with which a body comes into the water [m/s]: that at t = 0, or a larger one that its table gives a
/// body above the water. Tables begin at rest, or nearly so.
double entry_speed(const Parameters& p, const CommonKeys& common, const Setup& setup) {
  if (p.submerged) return 0;
  const double by_table = is_above(p, setup.partner_mesh) ? common.chosen.by_table : 0;
  return std::max(largest_speed(setup, p.motion), by_table);
}

/// Extents of each body along x and z [m]. A body is what faces hang together; without faces all points are
/// one.
std::vector<Eigen::Vector2d> extents(const InterfaceMesh& mesh) {
  const auto points = static_cast<std::size_t>(mesh.position.cols());
  std::vector<int> body(points);  // the number of a point before it of the same body; of the first its own
  std::iota(body.begin(), body.end(), 0);
  const auto first_of = [&](int k) {
    const auto before = [&](int i) -> int& { return body[static_cast<std::size_t>(i)]; };
    while (before(k) != k) k = before(k) = before(before(k));
    return k;
  };
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f)
    for (Eigen::Index c = 1; c < mesh.faces.rows(); ++c) {
      const int one = first_of(mesh.faces(0, f)), other = first_of(mesh.faces(c, f));
      body[static_cast<std::size_t>(std::max(one, other))] = std::min(one, other);
    }
  std::map<int, Eigen::AlignedBox3d> boxes;
  for (std::size_t k = 0; k < points; ++k)
    boxes[mesh.faces.cols() > 0 ? first_of(static_cast<int>(k)) : 0].extend(
        mesh.position.col(static_cast<Eigen::Index>(k)));
  std::vector<Eigen::Vector2d> sizes;
  for (const auto& [number, box] : boxes) sizes.emplace_back(box.sizes().x(), box.sizes().z());
  return sizes;
}

Points initial_velocity(const Setup& setup) {
  const Field* velocity = find(setup.partner_initial, "velocity");
  return velocity ? Points(velocity->value) : Points::Zero(3, setup.partner_mesh.position.cols());
}

/// A level face of five spacings or more, met in steps longer than sound takes for a spacing: a line that
/// says so; else nothing.
std::vector<std::string> level_face_lines(const Parameters& p, double window, const InterfaceMesh& body,
                                          double speed) {
  const double width = level_face(body, p.water.max[1] - 0.5 * p.spacing);
  constexpr double spacings = 5, advised = 0.3;  // [l0]; the second is c Δt
  // Spacings on the half width from which such steps give the impulse of a panel in space within some 3 %
  // (cases/VALIDATION.md, "Plates in space, with sound").
  constexpr double on_half_width = 18;
  const bool resolved = p.sound_speed * std::min(p.scheme.time_step, window) <= p.spacing;
  if (!(speed > 0) || resolved || !std::isfinite(p.sound_speed) ||
      !(width >= std::pow(spacings * p.spacing, p.dimension - 1)))
    return {};
  std::string line = fmt::format(
      "a level face of {:.3g} {} over the water: its first pressure, rho c V, needs "
      "fluid.scheme.time_step = {:.1g}",
      width, p.dimension == 2 ? "m" : "m^2", advised * p.spacing / p.sound_speed);
  const double spacing = std::sqrt(width) / (2 * on_half_width);
  if (p.dimension == 3 && spacing < p.spacing)
    line += fmt::format(
        ", and a spacing of {:.2g} m or less: with this one the impulse would be up to a tenth too large",
        spacing);
  return {line};
}

/// Gauges of a tank that moves: a line that says that they do not move with it; else nothing.
std::vector<std::string> gauge_lines(const Parameters& p) {
  std::string names;
  for (const ProbeKeys& probe : p.probes)
    if (reads_water(probe)) names += (names.empty() ? "" : ", ") + probe.name;
  if (names.empty() || !p.motion.moves()) return {};
  return {fmt::format("output.probe {}: stays where it is while the tank moves", names)};
}

template <int dim>
Points in_space(const Vectors<dim>& value) {
  Points points = Points::Zero(3, value.cols());
  points.template topRows<dim>() = value;
  return points;
}

}  // namespace

template <int dim>
FluidParticipant<dim>::FluidParticipant(const Parameters& parameters, const CommonKeys& common,
                                        const Setup& setup, const Ranks& ranks)
    : parameters_(parameters),
      bodies_{extents(setup.partner_mesh),
              std::abs(enclosed_volume(setup.partner_mesh.faces, setup.partner_mesh.position))},
      simulation_(parameters, setup.partner_mesh, initial_velocity(setup), ranks),
      start_speeds_{.entry = entry_speed(parameters, common, setup),
                    .water = parameters.initial_velocity.is_zero() ? 0 : simulation_.fastest().value},
      on_body_(sensors_on_body()),
      output_every_(common.output_every),
      end_time_(common.end_time),
      initial_volume_(volume()),
      sends_history_(setup.history && has_body()) {
  choose_contact_search(common);
  // Sensors of a body that enters are measured from its contact, all others from the first step
  // (cases/VALIDATION.md, "Definitions").
  for (const char on_body : on_body_)
    measurements_.probes.push_back(
        on_body != 0 && start_speeds_.contact.waits ? ProbeRecord::waiting_for_contact() : ProbeRecord{});
  check_sensors();
  description_.lines =
      describe(parameters_, common, std::max(start_speeds_.entry, largest_speed(setup, parameters.motion)),
               body_width());
  for (std::string& line :
       level_face_lines(parameters_, common.window, setup.partner_mesh,
                        parameters_.submerged ? 0 : std::max(start_speeds_.entry, common.chosen.by_table)))
    description_.lines.push_back(std::move(line));
  for (std::string& line : gauge_lines(parameters_)) description_.lines.push_back(std::move(line));
  if (parameters_.air.layer) description_.lines.push_back(air_line());
  description_.columns = columns();
  Communicator* const several = simulation_.ranks().communicator();
  if (!setup.run_folder.empty() && several == nullptr) frames_.of_one.emplace(setup.run_folder, "fluid", dim);
  if (!setup.run_folder.empty() && several != nullptr)
    frames_.of_ranks.emplace(setup.run_folder, "fluid", dim, *several);
  force_ = Points::Zero(3, mesh().position.cols());
  guard_ = Guard(guard_scales());
  guard_.faces(measurements_.guard, simulation_.face_pieces());
  committed_.fluid = simulation_.snapshot();
  committed_.measurements = measurements_;
}

/// Returns the next step, rest / ⌈rest / limit⌉. So steps are equal as long as the limit stays, and the last
/// one ends with the window. The limit is computed anew before each step, since the flow accelerates inside a
/// long window. It is the smallest of the case's largest step, the stable step at the present state, and the
/// step that resolves sound where the case asks for it.
template <int dim>
double FluidParticipant<dim>::longest_step(double t, double rest) const {
  const Scheme& scheme = parameters_.scheme;
  const double stable = simulation_.stable_dt(),
               at_rest = std::min({scheme.time_step, rest, column_step(parameters_)});
  if (!(stable * most_refinement > at_rest)) {
    const auto& body = simulation_.state().interface_velocity;
    const double speed = body.cols() > 0 ? body.colwise().norm().maxCoeff() : 0;
    throw Error(
        ExitCode::solver_fault, fmt::format("fluid, t = {:.9g} s", t),
        fmt::format("the stable time step has fallen to {:.3g} s, from {:.3g} s: the flow has blown up{}",
                    stable, at_rest, speed > 0 ? fmt::format(" beside a body at {:.3g} m/s", speed) : ""),
        fmt::format(
            "{}lower fluid.scheme.time_step or fluid.scheme.cfl; look at the last frames for where it "
            "began",
            speed > 0 ? "if that speed is wrong, look at the structure first; " : ""));
  }
  const double limit = std::min({scheme.time_step, stable, acoustic_step(parameters_)});
  constexpr double round_off = 1e-9;
  return rest / std::max(1.0, std::ceil(rest / limit - round_off));
}

template <int dim>
void FluidParticipant<dim>::start(const Window& window, const Input& input) {
  write_first_frame();
  const State<dim>& state = simulation_.state();
  const bool volume = parameters_.interface == "volume" && has_body();
  const Points displacement = in_space<dim>(state.interface_displacement),
               velocity = in_space<dim>(state.interface_velocity);
  // In volume coupling the structure's particles get place and velocity at the start of the window. The fluid
  // then moves them. In surface coupling the motion leads to the end of the window.
  std::optional<WindowMotion> motion;
  InterfaceMotion held;
  if (has_body()) {
    motion.emplace(window, input.samples, displacement, velocity);
    if (volume) {
      held = motion->step(window.t, window.t + window.dt);  // checked: the sample's own values
      const Field* given = find(input.samples.back().fields, "velocity");
      held.velocity = given ? Points(given->value) : velocity;
      held.acceleration.setZero();
    }
  }
  for (auto& probe : measurements_.probes) probe.new_window();
  history_.clear();
  force_.setZero();
  floor_.setZero();
  cfl_ = 0;
  pressure_iterations_ = 0;
  const double end = progress_.time = window.t + window.dt;
  WindowExtremes extremes;
  for (double t0 = window.t, t1 = t0; t0 < end; t0 = t1) {
    const double rest = end - t0;
    double dt = longest_step(t0, rest);
    t1 = t0 + dt;
    if (dt >= rest || !(t1 < end)) {  // the last one; a single step has the window's own length
      t1 = end;
      dt = t0 == window.t ? window.dt : rest;
    }
    InterfaceMotion moves;
    if (volume) {
      moves = held;
      moves.displacement += (t0 - window.t) * held.velocity;
    } else if (motion) {
      moves = motion->step(t0, t1);
    }
    const StepReport report = simulation_.step(dt, moves, t1 < end ? end - t1 : 0);
    ++progress_.steps;
    force_ += dt / window.dt * simulation_.interface_force();
    if (sends_history_) history_.push_back({t1, {{"force", "N", true, simulation_.interface_force()}}});
    floor_ += dt / window.dt * simulation_.floor_force();
    cfl_ = std::max(cfl_, report.cfl);
    pressure_iterations_ = std::max(pressure_iterations_, report.pressure_iterations);
    follow_probes(t0, t1);
    watch_step(t1, dt, report.cfl * parameters_.spacing / dt, extremes);
  }
  watch_window(window, extremes);
  measures_water_ = frame_due(window);
  if (measures_water_) count_voids_now();
}

template <int dim>
void FluidParticipant<dim>::choose_contact_search(const CommonKeys& common) {
  start_speeds_.contact.from_rest = common.chosen.from_rest && is_above(parameters_, mesh());
  start_speeds_.contact.waits = start_speeds_.entry > 0 || start_speeds_.contact.from_rest;
  const bool probed =
      std::ranges::any_of(common.probes, [](const ProbeKeys& probe) { return probe.of != "fluid"; }) ||
      std::ranges::any_of(on_body_, [](char on_body) { return on_body != 0; });
  start_speeds_.contact.whole_body =
      start_speeds_.contact.waits && !probed && parameters_.interface == "surface";
}

/// Returns ½ρV², the pressure that tells contact; infinite where none is looked for.
template <int dim>
double FluidParticipant<dim>::contact_pressure() const {
  double speed = start_speeds_.contact.waits ? start_speeds_.entry : 0;
  const Vectors<dim>& velocity = simulation_.state().interface_velocity;
  if (start_speeds_.contact.from_rest && velocity.cols() > 0) speed = velocity.colwise().norm().maxCoeff();
  return speed > 0 ? 0.5 * parameters_.density * speed * speed : std::numeric_limits<double>::infinity();
}

/// Adds the step to the probes and finds the contact. Contact is the first step in which a sensor on the body
/// exceeds ½ρV² (cases/VALIDATION.md, "Definitions"), or any point of a body without probes.
template <int dim>
void FluidParticipant<dim>::follow_probes(double t0, double t1) {
  std::vector<ProbeRecord>& records = measurements_.probes;
  std::vector<std::int64_t> particles;
  Vectors<dim> at_gauges;  // of several ranks
  const bool several = simulation_.ranks().several();
  if (std::any_of(parameters_.probes.begin(), parameters_.probes.end(), reads_water)) {
    if (several) {
      at_gauges = water_at_gauges();
      particles.resize(static_cast<std::size_t>(at_gauges.cols()));
      std::iota(particles.begin(), particles.end(), 0);
    } else {
      particles = water_of(simulation_.state());
    }
  }
  const Vectors<dim>& position = several ? at_gauges : simulation_.state().position;
  const bool looks = start_speeds_.contact.waits && measurements_.contact_time < 0;
  const double threshold = looks ? contact_pressure() : 0;
  bool contact =
      start_speeds_.contact.whole_body && looks && simulation_.highest_pressure().value > threshold;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const ProbeKeys& probe = parameters_.probes[i];
    const double value = pressure_or_place(probe, position, particles);
    contact = contact || (looks && value > threshold && on_body_[i] != 0);
    records[i].add(t0, t1, value);
  }
  if (!contact) return;
  measurements_.contact_time = t0;
  for (std::size_t i = 0; i < records.size(); ++i)
    if (on_body_[i] != 0) records[i].contact(t0);
}

template <int dim>
double FluidParticipant<dim>::pressure_or_place(const ProbeKeys& probe, const Vectors<dim>& position,
                                                std::span<const std::int64_t> particles) const {
  if (is_sensor(probe)) return simulation_.sensor_pressure(probe.at, probe.diameter);
  if (is_of_air(probe)) {
    const auto air = simulation_.air_at(probe.at);
    return probe.quantity == "gap" ? air.gap : air.pressure;
  }
  const Vector<dim> at = probe.at.template head<dim>();
  const double l0 = parameters_.spacing;
  if (probe.quantity == "front") return front<dim>(position, particles, at, l0);
  if (probe.quantity == "level") return level<dim>(position, particles, at, l0);
  return wetted_height<dim>(position, particles, at, parameters_.tank.min.template head<dim>(),
                            parameters_.tank.max.template head<dim>(), l0);
}

/// Whether a frame is due at the end of this window; volume and voids are measured then. The rule is the
/// coupler's: the first window's end at or past each multiple of output.every, and the end of the run.
template <int dim>
bool FluidParticipant<dim>::frame_due(const Window& window) const {
  const double end = window.t + window.dt, slack = 1e-6 * window.dt;
  const double every = std::max(output_every_, slack);
  return end >= end_time_ - slack ||
         std::floor((end + slack) / every) > std::floor((window.t + slack) / every);
}

template <int dim>
Advanced FluidParticipant<dim>::finish() {
  Advanced result;
  if (has_body()) result.output.push_back({"force", "N", true, force_});
  result.history = history_;
  auto& monitor = result.monitor;
  report_sensors(monitor);
  report_accounts(monitor);
  report_water(monitor);
  watch_accounts(monitor);
  if (!has_body()) monitor["floor.y"] = floor_[1];
  monitor["cfl"] = cfl_;
  monitor["pressure_iterations"] = pressure_iterations_;
  for (const auto& [stage, seconds] : simulation_.seconds()) monitor["seconds." + stage] = seconds;
  monitor["memory.peak"] = peak_memory();
  report_ranks(monitor);
  return result;
}

template <int dim>
void FluidParticipant<dim>::rewind() {
  simulation_.restore(committed_.fluid);
  measurements_ = committed_.measurements;
}

template <int dim>
void FluidParticipant<dim>::commit(bool write_output) {
  if (measurements_.lacks_voids() && !committed_.measurements.lacks_voids())
    fmt::print(stderr, "t = {:.6g} s: {}\n", progress_.time, no_voids_line);
  committed_.fluid = simulation_.snapshot();
  committed_.measurements = measurements_;
  committed_.progress = progress_;
  if (frames_.of_one) frames_.of_one->check();
  if (frames_.of_ranks) frames_.of_ranks->look();
  if (write_output) write_frame();
}

template <int dim>
void FluidParticipant<dim>::flush() {
  if (frames_.of_one) frames_.of_one->flush();
  if (frames_.of_ranks) frames_.of_ranks->flush();
}

template class FluidParticipant<2>;
template class FluidParticipant<3>;

}  // namespace strake::fluid
