#include "structure/participant.hpp"

#include "proto/peak_memory.hpp"
#include "proto/visible.hpp"
#include "structure/body/mechanism.hpp"
#include "structure/body/surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace strake::structure {
namespace {

constexpr int n_frequencies = 3;  // reported by structure.analysis = modal

double total(const Energy& e) {
  return e.kinetic + e.strain;
}

/// Surface that a point's force comes from; in volume coupling a particle's width.
Eigen::VectorXd point_sizes_or_spacing(const InterfaceMesh& mesh, const Parameters& p) {
  if (mesh.faces.cols() > 0) return point_sizes(mesh);
  return Eigen::VectorXd::Constant(mesh.position.cols(), p.fluid_spacing);
}

/// ½ρV² of the fastest point [Pa].
double dynamic_pressure(double density, const Points& velocity) {
  return 0.5 * density * velocity.colwise().squaredNorm().maxCoeff();
}

/// What the loaded faces feel of a load.
std::vector<Sample> loaded_part(std::vector<Sample> samples, const Eigen::VectorXd& share) {
  if (share.size() == 0) return samples;
  for (Sample& sample : samples)
    for (Field& field : sample.fields)
      if (field.quantity == "force") field.value = field.value * share.asDiagonal();
  return samples;
}

/// What the deflection of a rigid or replayed body is counted from. One that is free, or replayed from a
/// table, has no supports at a constant speed: its deflection is its displacement.
Eigen::Vector3d support_velocity(const Parameters& p) {
  return p.free.any() || p.motion ? Eigen::Vector3d(0, 0, 0) : p.velocity;
}

bool is_of_stress(const ProbeKeys& probe) {
  return probe.quantity == "stress" || probe.quantity == "von_mises";
}

/// Whether a solver can measure a probe of the case. Stress is left out where there is none, so that the
/// solver can be swapped by one word.
bool can_measure(const Solver& solver, const ProbeKeys& probe) {
  return probe.of == "structure" && (!is_of_stress(probe) || solver.has_stress());
}

/// What the case's probes of stress show of a solver without stress; empty: it has none of them.
std::string unmeasured(const Solver& solver, const std::string& kind, const CommonKeys& common) {
  std::vector<std::string> names;
  for (const ProbeKeys& probe : common.probes)
    if (probe.of == "structure" && !can_measure(solver, probe)) names.push_back(probe.name);
  if (names.empty()) return {};
  return fmt::format("left out: output.probe {}: {} structures have no stress", joined(names), kind);
}

std::string unit_of(const ProbeKeys& probe) {
  if (is_of_stress(probe)) return "Pa";
  return probe.quantity == "velocity" ? "m/s" : "m";
}

/// A component of a probe's quantity: its suffix in a column, and its place in the vector or tensor. A plane
/// has no stress xz and yz.
struct Component {
  const char* name;
  Eigen::Index place;
};
std::vector<Component> components_of(const ProbeKeys& probe, int dimension) {
  if (probe.quantity == "von_mises") return {{"", 0}};
  const bool plane = dimension == 2;
  if (probe.quantity == "stress")
    return plane ? std::vector<Component>{{".xx", 0}, {".xy", 1}, {".yy", 3}, {".zz", 5}}
                 : std::vector<Component>{{".xx", 0}, {".xy", 1}, {".xz", 2},
                                          {".yy", 3}, {".yz", 4}, {".zz", 5}};
  return plane ? std::vector<Component>{{".x", 0}, {".y", 1}}
               : std::vector<Component>{{".x", 0}, {".y", 1}, {".z", 2}};
}

std::string frequency_name(std::size_t i) {
  return fmt::format("f{}", i + 1);
}

}  // namespace

namespace {

/// Sub-steps of a window; refuses a body whose step is no number, or so short that no window would end.
double steps_in_window(const Solver& solver, const CommonKeys& common) {
  constexpr double most = 1e7;
  const double steps = std::max(1.0, std::ceil(common.window / solver.stable_dt()));
  if (steps <= most) return steps;
  throw Error(
      ExitCode::case_file, "structure.material",
      fmt::format("sub-steps of {:.3g} s: at most {:g} of them in a window of {:.4g} s", solver.stable_dt(),
                  most, common.window),
      "look at structure.material.young and structure.material.density, or at the spacing of the body");
}

}  // namespace

namespace {

/// What the case says of the mass of a rigid body that follows its supports in all directions; empty:
/// nothing. Then no load moves it, and its mass counts in its kinetic energy alone.
std::string unused_mass(const Parameters& p) {
  const bool given = p.body.mass > 0 || p.body.inertia > 0 || p.body.inertia_axes || p.body.lumped_mass > 0;
  if ((p.kind != "rigid" && p.kind != "replay") || p.free.any() || !given) return {};
  std::string keys;
  const auto name = [&](bool is_given, const char* key) {
    if (is_given) keys += (keys.empty() ? "structure." : ", structure.") + std::string(key);
  };
  name(p.body.mass > 0, "mass");
  name(p.body.inertia > 0, "inertia");
  name(p.body.inertia_axes.has_value(), "inertia_axes");
  name(p.body.lumped_mass > 0, "lumped.mass");
  return fmt::format("note: {} moves nothing, since no direction is free (structure.free)", keys);
}

/// What the supports of an elastic body leave free, beside structure.free; empty: nothing.
std::string mechanism(const Parameters& p) {
  if (p.kind == "rigid" || p.kind == "replay") return {};
  const std::string motions = motions_left(elastic_solid(p));
  if (motions.empty()) return {};
  return fmt::format("note: the supports leave {}, against inertia and loads alone", motions);
}

}  // namespace

std::vector<std::string> describe(const Solver& solver, const Parameters& p, const CommonKeys& common) {
  std::vector<std::string> lines = solver.lines();
  if (std::string note = mechanism(p); !note.empty()) lines.push_back(std::move(note));
  for (std::string& note : notes_on_unheld(p)) lines.push_back(std::move(note));
  if (p.analysis == Analysis::dynamic && !std::isinf(solver.stable_dt()))
    lines.push_back(fmt::format("{:.0f} sub-steps in a window of {:.4g} s", steps_in_window(solver, common),
                                common.window));
  if (common.fluid_solver != "none" && solver.interface().faces.cols() > 0)
    lines.push_back(loaded_faces(p, solver.interface()).line);
  if (p.shape.unseen > 0)
    lines.push_back(
        fmt::format("outline: {} of {} points; the water does not see the others, which stand "
                    "beside sides shorter than half a spacing",
                    p.shape.corner.size(), std::ssize(p.shape.corner) + p.shape.unseen));
  if (p.loaded_by_old_key) lines.push_back("structure.wet is called structure.loaded_faces now; both work");
  if (std::string note = unused_mass(p); !note.empty()) lines.push_back(std::move(note));
  if (p.stays_intact)
    lines.push_back(fmt::format("failure: stays intact, {} structures know no [structure.failure]", p.kind));
  if (std::string note = unmeasured(solver, p.kind, common); !note.empty()) lines.push_back(std::move(note));
  return lines;
}

std::string properties_line(const std::string& kind, const Properties& p) {
  if (p.mass == 0) return {};
  constexpr double nothing = 1e-12;  // [m] of a body of metres: round-off of its symmetry
  const Eigen::Vector3d centre = p.centre.unaryExpr([](double x) { return std::abs(x) < nothing ? 0.0 : x; });
  std::vector<std::string> frequencies;
  for (const double f : p.frequencies) frequencies.push_back(fmt::format("{:.5g}", f));
  return fmt::format("{:<10} {:>12.6g}   ({:.5g}, {:.5g}, {:.5g}) {:>14.6g}   {:<28} {}\n", kind, p.mass,
                     centre.x(), centre.y(), centre.z(), p.inertia,
                     frequencies.empty() ? "-" : joined(frequencies), p.step);
}

StructureParticipant::StructureParticipant(std::unique_ptr<Solver> solver, const Parameters& p,
                                           const CommonKeys& common, const Setup& setup, Communicator* ranks)
    : solver_(std::move(solver)),
      analysis_(p.analysis),
      support_velocity_(support_velocity(p)),
      contact_{.fluid_density = p.fluid_density,
               .pressure = dynamic_pressure(p.fluid_density, solver_->velocity())},
      point_size_(point_sizes_or_spacing(solver_->interface(), p)),
      dimension_(p.dimension),
      first_energy_(total(solver_->energy())) {
  for (const ProbeKeys& probe : common.probes) {
    if (!can_measure(*solver_, probe)) continue;
    probes_.push_back(probe);
    for (const Component& component : components_of(probe, dimension_))
      probe_columns_.push_back({probe.name + component.name, unit_of(probe)});
  }
  // A plate that enters water is measured from its contact, anything else from the first step.
  contact_.from_rest = common.chosen.from_rest;
  const bool enters = common.fluid_solver != "none" && (contact_.pressure > 0 || contact_.from_rest);
  state_.probes.assign(probe_columns_.size(), enters ? ProbeRecord::waiting_for_contact() : ProbeRecord{});
  state_.energy_scale = first_energy_;
  if (solver_->interface().faces.cols() > 0) loaded_share_ = loaded_faces(p, solver_->interface()).share;

  description_.initial = motion();
  const bool history = common.interpolation != "mean" && setup.interface == "surface";
  description_.history = history;
  description_.prescribed = analysis_ == Analysis::dynamic && solver_->prescribed();
  if (history) interpolation_ = interpolation_kind(common.interpolation);
  description_.lines = describe(*solver_, p, common);
  description_.columns = probe_columns_;
  for (const Column& column : solver_->columns()) description_.columns.push_back(column);
  for (const char* name : {"energy.kinetic", "energy.strain", "energy.external"})
    description_.columns.push_back({name, "J"});
  if (analysis_ == Analysis::modal)
    for (std::size_t i = 0; i < n_frequencies; ++i) description_.columns.push_back({frequency_name(i), "Hz"});

  files_.name = common.body.empty() ? "structure" : common.body;
  files_.ranks = ranks;
  if (!setup.run_folder.empty()) files_.frames.emplace(setup.run_folder, files_.name, dimension_);
  solver_->save();
  committed_ = state_;
}

void StructureParticipant::start(const Window& window, const Input& input) {
  const auto begin = std::chrono::steady_clock::now();
  if (!std::exchange(has_first_frame_, true)) write_frame();
  try {
    step(window, input);
  } catch (const StepFailed& failed) {
    rewind();
    failed_.emplace();
    failed_->retry_smaller_dt = true;
    failed_->dt_limit = 0.5 * window.dt;
    failed_->why = failed.problem();
    failed_->fix = failed.fix();
  }
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void StructureParticipant::step(const Window& window, const Input& input) {
  const int before = solver_->steps();
  if (analysis_ == Analysis::dynamic) {
    const Load load(loaded_part(input.samples, loaded_share_), interpolation_);
    look_for_contact(window, load);
    solver_->advance(window.t, window.dt, load);
  } else {
    solve_once();
  }
  steps_ += solver_->steps() - before;
  follow(window);
}

/// Finds contact (cases/VALIDATION.md, "Definitions") from the structure's side. It is the first window in
/// which the fluid's pressure anywhere exceeds ½ρV².
void StructureParticipant::look_for_contact(const Window& window, const Load& load) {
  if (state_.probes.empty() || state_.probes.front().in_contact()) return;
  const double pressure =
      contact_.from_rest ? dynamic_pressure(contact_.fluid_density, solver_->velocity()) : contact_.pressure;
  if (pressure == 0) return;
  const Points force = load.at(window.t + 0.5 * window.dt, point_size_.size());
  if ((force.colwise().norm().transpose().array() <= pressure * point_size_.array()).all()) return;
  for (ProbeRecord& record : state_.probes) record.contact(window.t);
}

void StructureParticipant::solve_once() {
  if (state_.solved) return;
  if (analysis_ == Analysis::statics) solver_->solve_static();
  if (analysis_ == Analysis::modal) state_.frequencies = solver_->frequencies(n_frequencies);
  state_.solved = true;
}

/// Probes and the energy balance at the end of a window.
void StructureParticipant::follow(const Window& window) {
  state_.time = window.t + window.dt;
  std::size_t column = 0;
  for (const ProbeKeys& probe : probes_) {
    const Eigen::VectorXd value = measure(probe);
    for (const Component& component : components_of(probe, dimension_)) {
      ProbeRecord& record = state_.probes[column++];
      record.new_window();
      record.add(window.t, state_.time, value[component.place]);
    }
  }
  if (analysis_ != Analysis::dynamic || !solver_->follows_work()) return;
  const Energy energy = solver_->energy();
  state_.energy_scale = std::max({state_.energy_scale, total(energy), std::abs(energy.external)});
  state_.energy_gap = std::max(state_.energy_gap,
                               std::abs(total(energy) + energy.released - first_energy_ - energy.external));
}

Eigen::VectorXd StructureParticipant::measure(const ProbeKeys& probe) const {
  if (probe.quantity == "von_mises")
    return Eigen::VectorXd::Constant(1, von_mises(solver_->stress_at(probe.at)));
  if (probe.quantity == "stress") return solver_->stress_at(probe.at);
  if (probe.quantity == "velocity") return solver_->velocity_at(probe.at);
  Eigen::Vector3d value = solver_->displacement_at(probe.at);
  if (probe.quantity == "deflection")
    value -= solver_->support_displacement(probe.at).value_or(support_velocity_ * state_.time);
  return value;
}

std::vector<Field> StructureParticipant::motion() const {
  std::vector<Field> fields = {{"displacement", "m", false, solver_->displacement()}};
  if (solver_->sends_velocity() || state_.time == 0)
    fields.push_back({"velocity", "m/s", false, solver_->velocity()});
  return fields;
}

Advanced StructureParticipant::finish() {
  if (failed_) return *std::exchange(failed_, std::nullopt);
  Advanced result;
  result.output = motion();
  auto& monitor = result.monitor;
  monitor = solver_->monitor();
  for (std::size_t i = 0; i < probe_columns_.size(); ++i) {
    monitor[probe_columns_[i].name] = state_.probes[i].last();
    state_.probes[i].report(probe_columns_[i].name, monitor);
  }
  const Energy energy = solver_->energy();
  monitor["energy.kinetic"] = energy.kinetic;
  monitor["energy.strain"] = energy.strain;
  monitor["energy.external"] = energy.external;
  for (std::size_t i = 0; i < state_.frequencies.size(); ++i) {
    monitor[frequency_name(i)] = state_.frequencies[i];
    monitor[frequency_name(i) + ":final"] = state_.frequencies[i];
  }
  if (analysis_ == Analysis::dynamic && solver_->follows_work())
    monitor["check.structure_energy_drift"] =
        state_.energy_scale > 0 ? state_.energy_gap / state_.energy_scale : 0.0;
  monitor["count.steps"] = static_cast<double>(steps_);
  monitor["count.steps_committed"] = solver_->steps();
  monitor["seconds.step"] = seconds_;
  monitor["memory.peak"] = peak_memory();
  return result;
}

void StructureParticipant::rewind() {
  solver_->restore();
  state_ = committed_;
}

void StructureParticipant::commit(bool write_output) {
  solver_->save();
  committed_ = state_;
  committed_steps_ = steps_;
  if (write_output) write_frame();
}

/// Writes the body at the end of the last window; at t = 0 before the first one. All ranks make the frame.
void StructureParticipant::write_frame() {
  if (!files_.frames && files_.ranks == nullptr) return;
  Frame frame = solver_->frame();
  if (!files_.frames) return;
  frame.time = state_.time;
  files_.frames->write(frame);
}

void StructureParticipant::checkpoint(const std::filesystem::path& folder) {
  Archive archive;
  solver_->write(archive);
  if (files_.ranks != nullptr && files_.ranks->rank() > 0) return;
  archive.real["participant"] =
      Eigen::Vector4d(committed_.time, committed_.energy_scale, committed_.energy_gap, first_energy_);
  archive.real["frequencies"] = Eigen::Map<const Eigen::VectorXd>(
      committed_.frequencies.data(), static_cast<Eigen::Index>(committed_.frequencies.size()));
  archive.integer["participant.solved"] = {committed_.solved ? 1 : 0};
  archive.integer["participant.steps"] = {committed_steps_};
  for (std::size_t i = 0; i < committed_.probes.size(); ++i)
    committed_.probes[i].save(fmt::format("probe{}", i), archive);
  write_archive(folder / (files_.name + ".h5"), archive);
}

void StructureParticipant::resume(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / (files_.name + ".h5");
  const Archive archive = read_archive(file);
  if (!archive.real.contains("participant"))
    throw Error(ExitCode::case_file, file.string(), "is not a checkpoint of a structure");
  solver_->read(archive);
  const auto& own = archive.real.at("participant");
  state_.time = own(0);
  state_.energy_scale = own(1);
  state_.energy_gap = own(2);
  first_energy_ = own(3);
  const auto& frequencies = archive.real.at("frequencies");
  state_.frequencies.assign(frequencies.data(), frequencies.data() + frequencies.size());
  state_.solved = archive.integer.at("participant.solved").at(0) != 0;
  for (std::size_t i = 0; i < state_.probes.size(); ++i)
    state_.probes[i].load(fmt::format("probe{}", i), archive);
  committed_ = state_;
  const auto steps = archive.integer.find("participant.steps");
  const bool counted = steps != archive.integer.end() && !steps->second.empty();
  steps_ = committed_steps_ = counted ? static_cast<long>(steps->second.front()) : solver_->steps();
  has_first_frame_ = true;
  if (files_.frames) files_.frames->truncate(state_.time);
}

}  // namespace strake::structure
