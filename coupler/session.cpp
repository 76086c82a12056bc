#include "coupler/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/console.hpp"
#include "coupler/log_tail.hpp"
#include "coupler/stop_request.hpp"
#include "proto/error.hpp"

namespace strake {

namespace {

// A wet point farther than this from the structure's surface [fluid.spacing] belongs to another shape.
constexpr double farthest_wet_point = 2.0;
// A converged residual, where the case gives none [fluid.spacing].
constexpr double absolute_residual = 1e-6;

Deadlines deadlines_of(const CouplingKeys& keys, bool patient) {
  Deadlines deadlines;
  deadlines.hello = std::chrono::duration<double>(keys.start_within);
  deadlines.by_hand = std::chrono::duration<double>(keys.attach_within);
  deadlines.frozen_after = std::chrono::duration<double>(keys.frozen_after);
  deadlines.answer_within = std::chrono::duration<double>(keys.answer_within);
  deadlines.patient = patient;
  return deadlines;
}

SchemeParameters scheme_of(const CaseView& view, const Participant& structure) {
  const CouplingKeys& keys = view.coupling;
  SchemeParameters scheme;
  scheme.volume = view.common.interface == "volume";
  scheme.parallel = keys.parallel;
  scheme.predictor = predictor_kind(keys.predictor);
  scheme.accelerator = {.kind = keys.accelerator,
                        .initial_relaxation = keys.initial_relaxation,
                        .reused_windows = keys.reused_windows,
                        .filter = keys.filter,
                        .filter_kind = keys.filter_kind,
                        .max_columns = keys.max_columns};
  scheme.convergence.relative = keys.relative;
  // A length is no measure of a field that is none.
  scheme.convergence.absolute = keys.absolute;
  if (keys.absolute == 0 && is_motion(fields_of_structure(structure)))
    scheme.convergence.absolute = absolute_residual * view.number("fluid.spacing").value_or(0.01);
  scheme.convergence.min_iterations = keys.min_iterations;
  scheme.convergence.max_iterations = keys.max_iterations;
  scheme.convergence.then = keys.unconverged;
  scheme.convergence.measure = keys.measure;
  scheme.convergence.residual_relative = keys.residual_relative;
  scheme.convergence.load = keys.load;
  return scheme;
}

Mapping mapping_of(const CaseView& view, const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  if (view.common.interface == "volume") return identity(structure, fluid);
  const auto spacing = view.number("fluid.spacing");
  MappingParameters mapping = view.coupling.mapping;
  if (spacing) mapping.limit = farthest_wet_point * *spacing;
  return make_mapping(mapping, structure, fluid);
}

Transfer transfer_of(const CaseView& view, const Participant& structure, const Participant& fluid) {
  std::optional<Mapping> back;
  if (Transfer::needs_way_back(fields_of_structure(structure), fields_of_fluid(fluid)))
    back = mapping_of(view, fluid.mesh(), structure.mesh());
  return {mapping_of(view, structure.mesh(), fluid.mesh()), std::move(back)};
}

std::string accelerator_title(const std::string& kind) {
  if (kind == "iqn-ils") return "IQN-ILS";
  if (kind == "iqn-imvj") return "IQN-IMVJ";
  return kind == "aitken" ? "Aitken" : "constant relaxation";
}

}  // namespace

double window_of(const CaseView& view) {
  const auto analysis = view.value.find("structure.analysis");
  const bool timeless = !view.fluid && analysis != view.value.end() && analysis->second != "dynamic";
  return timeless ? view.common.end_time : view.common.window;
}

std::optional<double> added_mass_ratio(const CaseView& view) {
  const auto density = view.number("fluid.density"), length = view.number("structure.plate.length"),
             solid = view.number("structure.material.density"),
             thickness = view.number("structure.plate.thickness");
  if (!view.coupled() || !density || !length || !solid || !thickness || *solid <= 0 || *thickness <= 0)
    return std::nullopt;
  return *density * 0.5 * *length / (*solid * *thickness);
}

Session::Session(const CaseView& view, const Options& options) : case_(view), options_(options) {
  roster_ = std::make_unique<Roster>(Roster::Options{
      .endpoint = view.coupling.endpoint == "ipc" ? std::string() : view.coupling.endpoint,
      .keys =
          view.coupling.keys.empty() ? std::nullopt : std::optional(read_coupler_keys(view.coupling.keys)),
      .unencrypted = view.coupling.unencrypted,
      .case_hash = view.file.hash(),
      .deadlines = deadlines_of(view.coupling, options.patient),
      .say = options.say,
      .stop = options.stop,
      .on_exchange = options.on_exchange});
  if (view.structure) launch(*view.structure);
  if (view.fluid) launch(*view.fluid);

  Setup setup{.run_folder = options.run_folder,
              .interface = view.coupled() ? view.common.interface : "none",
              .partner_mesh = {},
              .partner_initial = {}};
  if (view.structure) structure_ = &set_up(*view.structure, setup);
  if (structure_ != nullptr) {
    setup.partner_mesh = structure_->mesh();
    setup.partner_initial = structure_->description().initial;
    setup.history = structure_->description().history && view.common.interface == "surface";
  }
  if (view.fluid) fluid_ = &set_up(*view.fluid, setup);

  if (view.coupled())
    scheme_ = std::make_unique<Scheme>(*fluid_, *structure_, transfer_of(view, *structure_, *fluid_),
                                       scheme_of(view, *structure_));
}

void Session::launch(const SideView& side) {
  Launch launch;
  launch.program = side.program;
  launch.arguments = {"--case", case_.file.path().string()};
  for (const std::string& set : case_.sets) {
    launch.arguments.push_back("--set");
    launch.arguments.push_back(set);
  }
  launch.log = options_.log_folder / (side.side + ".log");
  if (options_.resumed_at) {
    note_resume(launch.log, *options_.resumed_at);
    launch.keep_log = true;
  }
  launch.threads = case_.common.threads;
  const auto& by_hand = options_.by_hand;
  if (std::find(by_hand.begin(), by_hand.end(), side.side) == by_hand.end())
    return roster_->launch(side.side, std::move(launch));
  launch.arguments[1] = std::filesystem::absolute(case_.file.path()).string();  // it may start anywhere
  roster_->attach(side.side);
  if (options_.invite) options_.invite(side.side, roster_->command(side.side, launch));
}

RemoteParticipant& Session::set_up(const SideView& side, Setup setup) {
  RemoteParticipant& participant = roster_->connect(side.side, setup);
  for (Column column : participant.description().columns) {
    sources_.push_back({.fluid = side.side == "fluid", .name = column.name});
    const auto same = [&](const Column& other) { return other.name == column.name; };
    if (std::any_of(columns_.begin(), columns_.end(), same)) column.name = side.side + "." + column.name;
    columns_.push_back(column);
  }
  return participant;
}

std::vector<double> Session::values(const WindowReport& report) const {
  std::vector<double> values;
  for (const Source& source : sources_) {
    const auto& monitor = source.fluid ? report.fluid : report.structure;
    const auto found = monitor.find(source.name);
    values.push_back(found == monitor.end() ? std::nan("") : found->second);
  }
  return values;
}

RunPlan Session::plan() const {
  return {.end = case_.common.end_time,
          .window = window_of(case_),
          .output_every = case_.common.output_every,
          .start = {},
          .control = case_.coupling.control};
}

RunLoop Session::loop(const RunPlan& plan) {
  if (scheme_) return RunLoop(*scheme_, plan);
  if (fluid_ != nullptr) return RunLoop(*fluid_, RunLoop::Side::fluid, plan);
  return RunLoop(*structure_, RunLoop::Side::structure, plan);
}

int Session::dimension() const {
  return scheme_ ? structure_->mesh().dimension
                 : static_cast<int>(case_.number("fluid.dimension").value_or(2));
}

std::vector<std::string> Session::coupling_lines() const {
  const RunPlan times = plan();
  const std::string windows = fmt::format("window {:.6g} ms   {} window{}", 1e3 * times.window,
                                          grouped(times.n_windows()), times.n_windows() == 1 ? "" : "s");
  if (!scheme_) return {"none: one participant   " + windows};
  std::vector<std::string> lines;
  if (case_.common.interface == "volume")
    lines.push_back("volume, one iteration   " + windows);
  else
    lines.push_back(
        fmt::format("surface, {}, {}{}   {}", case_.coupling.mapping.kind,
                    case_.coupling.iterates() ? accelerator_title(case_.coupling.accelerator) : "explicit",
                    case_.coupling.parallel ? ", both at once" : "", windows));
  const MappingQuality& quality = scheme_->mapping().quality();
  std::string second = fmt::format("{} wet points on {} structure points, at most {:.1e} m apart",
                                   quality.n_fluid, quality.n_structure, quality.largest_distance);
  if (const auto ratio = added_mass_ratio(case_))
    second += fmt::format("   added-mass ratio rho a / rho_s h  {:.2f}", *ratio);
  lines.push_back(second);
  return lines;
}

std::vector<std::pair<std::string, std::vector<std::string>>> Session::understood() const {
  std::vector<std::pair<std::string, std::vector<std::string>>> blocks;
  if (fluid_ != nullptr) blocks.emplace_back("fluid", fluid_->description().lines);
  if (structure_ != nullptr) blocks.emplace_back("structure", structure_->description().lines);
  blocks.emplace_back("coupling", coupling_lines());
  return blocks;
}

std::vector<std::string> Session::mapping_lines() const {
  if (!scheme_ || case_.common.interface != "surface") return {};
  std::vector<std::string> lines = quality_lines(scheme_->mapping().quality(), fluid_->mesh().position);
  const auto& back = scheme_->transfer().to_structure();
  if (!back) return lines;
  for (std::string& line : quality_lines(back->quality(), structure_->mesh().position, true))
    lines.push_back(std::move(line));
  return lines;
}

std::vector<std::string> Session::warnings() const {
  std::vector<std::string> warnings;
  bool moved = case_.structure && case_.structure->solver != "rigid" && case_.structure->solver != "replay";
  for (const char* key : {"x", "y", "z", "angle", "rotation"}) {
    const auto free = case_.value.find(std::string("structure.free.") + key);
    moved = moved || (free != case_.value.end() && free->second == "true");
  }
  const bool live = case_.fluid && case_.fluid->solver != "replay";
  if (scheme_ && moved && live && case_.common.interface == "surface" && !case_.coupling.iterates()) {
    const auto ratio = added_mass_ratio(case_);
    warnings.push_back(
        fmt::format("one coupling iteration per window is unstable when the added mass is not small{}; "
                    "raise coupling.surface.converged.max_iterations",
                    ratio ? fmt::format(" (here {:.2f} of the structure's)", *ratio) : ""));
  }
  if (scheme_) {
    const MappingQuality& quality = scheme_->mapping().quality();
    if (quality.without_load > 0 && case_.common.interface == "surface")
      warnings.push_back(
          fmt::format("{} of {} structure points feel no load: the fluid's interface points are coarser; "
                      "coupling.surface.mapping.constraint = \"scaled-consistent\" loads them all{}",
                      quality.without_load, quality.n_structure,
                      fluid_->mesh().faces.cols() > 0 ? "" : ", with kind = \"radial-basis\""));
  }
  return warnings;
}

}  // namespace strake
