#include "coupler/run/session.hpp"

#include "coupler/case/case_scheme.hpp"
#include "coupler/case/mesh_transfer.hpp"
#include "coupler/case/rank_threads.hpp"
#include "coupler/case/side_programs.hpp"
#include "coupler/console/console.hpp"
#include "coupler/processes/log_tail.hpp"
#include "coupler/run/surface_faces.hpp"
#include "coupler/summary/pace.hpp"
#include "coupler/summary/resolution.hpp"
#include "coupler/summary/start.hpp"
#include "proto/error.hpp"
#include "proto/lookup.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake {

namespace {

CouplingCase coupling_case(const CaseView& view) {
  return {view.common, view.coupling, view.number("fluid.spacing")};
}

/// Largest length of a mesh along an axis [m].
double extent_of(const InterfaceMesh& mesh) {
  if (mesh.position.cols() == 0) return 0;
  return (mesh.position.rowwise().maxCoeff() - mesh.position.rowwise().minCoeff()).maxCoeff();
}

/// What helped a soft wall whose windows failed, the best first (cases/VALIDATION.md, "A soft wall under
/// water").
constexpr const char* soft_body_remedy =
    "shorter windows do not help. Of a soft body, in this order: a motion that starts at rest "
    "(fluid.motion.ramp), a fluid.spacing of at most half its thickness, a longer coupling.surface.window; "
    "at the default window also structure.damping.stiffness of some 1e-4 s";

std::string accelerator_title(const std::string& kind) {
  if (kind == "iqn-ils") return "IQN-ILS";
  if (kind == "iqn-imvj") return "IQN-IMVJ";
  return kind == "aitken" ? "Aitken" : "constant relaxation";
}

}  // namespace

double window_of(const CaseView& view) {
  const bool timeless = !view.fluid && at_or(view.value, "structure.analysis", "dynamic") != "dynamic";
  return timeless ? view.common.end_time : view.common.window;
}

std::optional<double> added_mass_ratio(const CaseView& view) {
  const auto density = view.number("fluid.density"), length = view.number("structure.plate.length"),
             solid = view.number("structure.material.density"),
             thickness = view.number("structure.plate.thickness");
  if (!view.coupled() || !density || !length || !solid || !thickness || *solid <= 0 || *thickness <= 0)
    return std::nullopt;
  double per_area = *solid * *thickness;                       // [kg/m²] of the plate
  if (at_or(view.value, "structure.solver", "") == "rigid") {  // its mass may be another than its material's
    const bool plane = view.number("fluid.dimension").value_or(2) == 2;
    const double area = *length * (plane ? 1 : view.number("structure.depth").value_or(0));
    const double mass = view.number("structure.mass").value_or(0);
    if (area > 0 && mass > 0) per_area = mass / area;
    if (area > 0) per_area += view.number("structure.lumped.mass").value_or(0) / area;
  }
  return *density * 0.5 * *length / per_area;
}

Session::Session(const CaseView& view, const Options& options) : case_(view), options_(options) {
  participants_ = std::make_unique<Participants>(Participants::Options{
      .endpoint = view.coupling.network.endpoint == "ipc" ? std::string() : view.coupling.network.endpoint,
      .keys = view.coupling.network.curve_keys.empty()
                  ? std::nullopt
                  : std::optional(read_coupler_keys(view.coupling.network.curve_keys)),
      .unencrypted = view.coupling.network.unencrypted,
      .case_hash = view.hash,
      .deadlines = deadlines_of(view.coupling.waiting, options.patient),
      .say = options.say,
      .note = options.note,
      .stop = options.stop,
      .on_exchange = options.on_exchange,
      .on_wait = options.on_wait});
  for (const SideView& structure : view.structures) launch(structure);
  if (view.fluid) launch(*view.fluid);
  attachments_ = std::make_unique<SessionAttachments>(
      view, [this](const AttachmentKeys& keys) { launch_attachment(keys); });

  Setup setup;
  setup.run_folder = options.run_folder;
  setup.interface = view.coupled() ? view.common.interface : "none";
  if (!view.structures.empty()) {
    set_up_structures(setup);
    setup.partner_mesh = mesh_for_fluid(*structure_);
    setup.partner_initial = initial_for_fluid(*structure_);
    setup.history = structure_->description().history && view.common.interface == "surface";
  }
  if (view.fluid) {
    fluid_ = &participants_->connect("fluid", setup);
    add_columns("fluid", fluid_->description());
  }
  if (structure_ != nullptr) attachments_->connect(*participants_, setup, *structure_);
  for (const Column& column : attachments_->columns()) {
    sources_.push_back({.reporter = Reporter::attachments, .name = column.name});
    columns_.push_back(column);
  }

  if (!view.coupled()) return;
  const CouplingCase coupling = coupling_case(view);
  scheme_ = std::make_unique<Scheme>(*fluid_, *structure_, transfer_of(coupling, *structure_, *fluid_),
                                     scheme_of(coupling, *structure_), 0, attachments_->all());
}

/// The structure, or several bodies as one.
void Session::set_up_structures(const Setup& setup) {
  std::vector<Body> bodies;
  for (const SideView& side : case_.structures) {
    RemoteParticipant& one = participants_->connect(side.side, setup);
    check_motion(case_, side.side, one);
    check_within_tank(case_, side.side, one);
    take_surface(side, one);
    bodies_.push_back(&one);
    bodies.push_back({side.side, &one});
  }
  structure_ = bodies_.front();
  if (case_.structures.front().is_body) {
    std::set<std::string> probes;
    for (const ProbeKeys& probe : case_.common.probes) probes.insert(probe.name);
    assembly_ = std::make_unique<Assembly>(std::move(bodies), std::move(probes),
                                           case_.number("fluid.spacing").value_or(0));
    structure_ = assembly_.get();
  }
  add_columns("structure", structure_->description());
  if (assembly_) add_forces();
}

/// The force on each of several bodies, "left.force.y".
void Session::add_forces() {
  const int dimension = structure_->mesh().dimension;
  for (std::size_t body = 0; body < bodies_.size(); ++body)
    for (int k = 0; k < dimension; ++k) {
      sources_.push_back({.name = {}, .body = body, .component = k});
      columns_.push_back(
          {fmt::format("{}.force.{}", case_.structures[body].side, "xyz"[k]), dimension == 2 ? "N/m" : "N"});
    }
}

namespace {

/// The line of the case that starts the ranks of a side: `fluid.launcher = "mpirun -n {ranks}"`. Empty where
/// it is one process.
std::string launcher_of(const SideView& side, const CaseView& view) {
  if (ranks_of(view, side) == 1) return {};
  const std::string key = table_of(side) + ".launcher";
  return fmt::format("{} = \"{}\"", key, at_or(view.value, key));
}

}  // namespace

void Session::launch(const SideView& side) {
  Launch launch;
  launch.program = side.program;
  const ForeignKeys& own = case_.common.program_of(side.side);
  const bool started_here = !starts_by_hand(options_.by_hand, side);
  launch.launcher = launcher_of(side, case_);
  launch.threads = threads_of(case_, side);
  launch.folder = own.folder;
  launch.own_command_line = own.own_command_line;
  if (own.own_command_line) {
    launch.arguments = own.arguments;
  } else {
    // Relative where it is started where strake was called.
    const bool elsewhere = !started_here || !own.folder.empty();
    launch.arguments = {"--case", (elsewhere ? std::filesystem::absolute(case_.path) : case_.path).string()};
    if (side.is_body) launch.arguments.insert(launch.arguments.end(), {"--body", side.side});
    for (const std::string& set : case_.sets) launch.arguments.insert(launch.arguments.end(), {"--set", set});
  }
  if (!own.folder.empty()) launch.program = std::filesystem::absolute(launch.program);
  if (const std::string path = library_path(); own.own_command_line && !path.empty())
    launch.environment["LD_LIBRARY_PATH"] = path;
  if (!own.precice_names.empty()) launch.environment["STRAKE_PRECICE_NAMES"] = joined(own.precice_names, ";");
  start(side.side, std::move(launch), started_here);
}

/// Its command line is that of a solver.
void Session::launch_attachment(const AttachmentKeys& keys) {
  const auto& by_hand = options_.by_hand;
  const bool started_here = std::find(by_hand.begin(), by_hand.end(), keys.name) == by_hand.end();
  Launch launch;
  launch.program = started_here ? program_of(keys, case_) : std::filesystem::path(keys.solver);
  launch.threads = case_.common.threads;
  launch.arguments = {"--case", (started_here ? case_.path : std::filesystem::absolute(case_.path)).string()};
  for (const std::string& set : case_.sets) launch.arguments.insert(launch.arguments.end(), {"--set", set});
  start(keys.name, std::move(launch), started_here);
}

/// Starts a program with a log of its own, or invites the user to.
void Session::start(const std::string& name, Launch launch, bool started_here) {
  launch.log = options_.log_folder / (name + ".log");
  if (options_.resumed_at) {
    note_resume(launch.log, *options_.resumed_at);
    launch.keep_log = true;
  }
  if (started_here) return participants_->launch(name, std::move(launch));
  participants_->attach(name);
  if (options_.invite) options_.invite(name, participants_->command(name, launch));
}

std::vector<RemoteParticipant*> Session::remotes() const {
  std::vector<RemoteParticipant*> asked;
  if (fluid_ != nullptr) asked.push_back(fluid_);
  asked.insert(asked.end(), bodies_.begin(), bodies_.end());
  return asked;
}

/// Faces of a structure that sends its points alone, from its key `surface`.
void Session::take_surface(const SideView& side, RemoteParticipant& structure) const {
  const std::filesystem::path& file = case_.common.program_of(side.side).surface;
  if (file.empty()) return;
  const InterfaceMesh wetted = mesh_for_fluid(structure);
  if (wetted.faces.cols() > 0)
    throw Error(ExitCode::case_file,
                (side.is_body ? "structures." + side.side : side.side) + ".surface = " + file.string(),
                fmt::format("the structure sends {} faces itself", wetted.faces.cols()),
                "leave that key out");
  structure.give_faces(faces_from_file(file, wetted), wetted.name);
}

void Session::add_columns(const std::string& side, const Description& description) {
  for (Column column : description.columns) {
    sources_.push_back(
        {.reporter = side == "fluid" ? Reporter::fluid : Reporter::structure, .name = column.name});
    const auto same = [&](const Column& other) { return other.name == column.name; };
    while (std::any_of(columns_.begin(), columns_.end(), same)) column.name = side + "." + column.name;
    columns_.push_back(column);
  }
}

std::vector<double> Session::values(const WindowReport& report) const {
  std::vector<double> values;
  std::vector<Eigen::Vector3d> force;  // on each of several bodies [N]
  for (std::size_t k = 0; assembly_ && k < bodies_.size(); ++k)
    force.emplace_back(
        report.force.middleCols(assembly_->mesh().parts[k].first_point, bodies_[k]->mesh().position.cols())
            .rowwise()
            .sum());
  for (const Source& source : sources_)
    if (source.component >= 0)
      values.push_back(force[source.body][source.component]);
    else
      values.push_back(at_or(source.reporter == Reporter::fluid       ? report.fluid
                             : source.reporter == Reporter::structure ? report.structure
                                                                      : report.attachments,
                             source.name, std::nan("")));
  return values;
}

RunPlan Session::plan() const {
  LoopState start;
  std::vector<const Participant*> all = {fluid_, structure_};
  for (const Attachment& one : attachments_->all()) all.push_back(one.solver);
  for (const Participant* one : all)
    if (one != nullptr) start.limit = std::min(start.limit, one->description().dt_limit);
  return {.end = case_.common.end_time,
          .window = window_of(case_),
          .output_every = case_.common.output_every,
          .start = start,
          .control = case_.coupling.control,
          .remedy = case_.coupled() ? remedy_of(coupling_case(case_)) : std::string(),
          .if_halving_failed = case_.coupled() && case_.any_deforms() ? soft_body_remedy : ""};
}

WindowLoop Session::loop(const RunPlan& plan) {
  if (scheme_) return WindowLoop(*scheme_, plan);
  if (fluid_ != nullptr) return WindowLoop(*fluid_, WindowLoop::Side::fluid, plan);
  return WindowLoop(*structure_, WindowLoop::Side::structure, plan);
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
    lines.push_back(fmt::format(
        "surface, {}, {}{}   {}", case_.coupling.mapping.kind,
        case_.coupling.iterates() ? accelerator_title(case_.coupling.accelerator.kind) : "explicit",
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
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const std::string& name = case_.structures[k].side;
    blocks.emplace_back(name, bodies_[k]->description().lines);
    if (const auto& file = case_.common.program_of(name).surface; !file.empty())
      blocks.back().second.push_back(
          fmt::format("{} faces from {}", bodies_[k]->mesh().faces.cols(), file.filename().string()));
  }
  for (const auto& block : attachments_->understood()) blocks.push_back(block);
  blocks.emplace_back("coupling", coupling_lines());
  return blocks;
}

std::vector<std::string> Session::mapping_lines() const {
  if (!scheme_ || case_.common.interface != "surface") return {};
  if (!scheme_->transfer().crossings().empty())
    return lines_of_crossings(scheme_->transfer(), case_.coupling.mapping, *structure_, *fluid_);
  std::vector<std::string> lines = quality_lines(scheme_->mapping().quality(), fluid_->mesh().position);
  const auto& back = scheme_->transfer().to_structure();
  if (!back) return lines;
  for (std::string& line : quality_lines(back->quality(), structure_->mesh().position, true))
    lines.push_back(std::move(line));
  return lines;
}

std::vector<std::string> Session::resolution() const {
  if (structure_ == nullptr) return resolution_lines(case_, {});
  const auto moving = [](const std::string& name, const Participant& body) {
    const std::vector<Field> initial = initial_for_fluid(body);
    const Field* velocity = find(initial, "velocity");
    return MovingBody{.name = name,
                      .mesh = mesh_for_fluid(body),
                      .velocity = velocity == nullptr ? Points() : Points(velocity->value)};
  };
  std::vector<MovingBody> bodies;
  for (std::size_t k = 0; assembly_ && k < bodies_.size(); ++k)
    bodies.push_back(moving(case_.structures[k].side, *bodies_[k]));
  if (bodies.empty()) bodies.push_back(moving("", *structure_));
  return resolution_lines(case_, bodies);
}

std::string Session::cannot_resume() const {
  std::vector<std::string> names;
  if (fluid_ != nullptr && fluid_->description().cannot_resume) names.emplace_back("fluid");
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    if (bodies_[k]->description().cannot_resume) names.push_back(case_.structures[k].side);
  for (const std::string& name : attachments_->cannot_resume()) names.push_back(name);
  if (names.empty()) return {};
  return fmt::format("{} cannot save {} state", joined(names, " and "), names.size() > 1 ? "their" : "its");
}

std::vector<std::string> Session::warnings() const {
  std::vector<std::string> warnings;
  if (const std::string who = cannot_resume(); !who.empty())
    warnings.push_back(who + ": a run writes no checkpoints, and --resume cannot go on with it");
  const bool moved = case_.any_deforms() || case_.moves_freely();
  const bool live = case_.fluid && case_.fluid->solver != "replay";
  if (scheme_ && moved && live && case_.common.interface == "surface" && !case_.coupling.iterates()) {
    const auto ratio = added_mass_ratio(case_);
    warnings.push_back(
        fmt::format("one coupling iteration per window is unstable when the added mass is not small{}; "
                    "raise coupling.surface.converged.max_iterations",
                    ratio ? fmt::format(" (here {:.2f} of the structure's)", *ratio) : ""));
  }
  if (scheme_) {
    const MappingQuality& quality = quality_of_load(scheme_->transfer());
    if (quality.without_load > 0 && case_.common.interface == "surface")
      warnings.push_back(
          fmt::format("{} of {} structure points feel no load: the fluid's interface points are coarser; "
                      "coupling.surface.mapping.constraint = \"scaled-consistent\" loads them all{}",
                      quality.without_load, quality.n_structure,
                      fluid_->mesh().faces.cols() > 0 ? "" : ", with kind = \"radial-basis\""));
  }
  for (std::string& line : crowd_lines(case_)) warnings.push_back(std::move(line));
  for (std::string& line : far_off_lines(case_, structure_ == nullptr ? 0 : extent_of(structure_->mesh())))
    warnings.push_back(std::move(line));
  std::vector<BodyAtStart> bodies;
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    bodies.emplace_back(case_.structures[k].side, &bodies_[k]->mesh());
  for (std::string& line : start_lines(case_, bodies)) warnings.push_back(std::move(line));
  return warnings;
}

}  // namespace strake
