#include "coupler/precice/solver_run.hpp"

#include "coupler/participant/launch.hpp"
#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <precice/Version.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <variant>

namespace strake {
namespace {

constexpr double round_off = 1e-9;  // of a window: by so much sums of time steps may miss its end

QuantityNames names_of_environment() {
  const char* rules = std::getenv("STRAKE_PRECICE_NAMES");
  return QuantityNames(rules ? rules : "");
}

/// True if the solver has to be able to compute a window again. Where the file holds no scheme, the case
/// decides.
bool is_implicit(const PreciceConfig& config, const std::string& participant) {
  for (const auto& scheme : config.schemes)
    for (const std::string& name : scheme.participants)
      if (name == participant) return scheme.implicit;
  return true;
}

bool is_exchanged(const PreciceConfig& config, const std::string& participant,
                  std::string PreciceConfig::Exchange::*end, bool PreciceConfig::Exchange::*how) {
  for (const auto& scheme : config.schemes)
    for (const auto& exchange : scheme.exchanges)
      if (exchange.*end == participant && exchange.*how) return true;
  return false;
}

std::vector<SolverMesh> meshes_of(const PreciceConfig& config,
                                  const PreciceConfig::Participant& participant) {
  std::vector<SolverMesh> meshes;
  for (const std::string& name : participant.provided)
    meshes.emplace_back(name, config.find_mesh(name)->dimension);
  return meshes;
}

/// The meshes of a participant: at least one, in one space.
void check_meshes(const PreciceConfig& config, const PreciceConfig::Participant& participant) {
  if (participant.provided.empty())
    throw Error(ExitCode::case_file, config.file.string(),
                fmt::format("participant \"{}\" provides 0 meshes", participant.name),
                "<provide-mesh name=\"…\" />");
  const PreciceConfig::Mesh& first = *config.find_mesh(participant.provided.front());
  for (const std::string& name : participant.provided) {
    if (std::count(participant.provided.begin(), participant.provided.end(), name) > 1)
      throw Error(ExitCode::case_file, config.file.string(),
                  fmt::format("participant \"{}\" provides \"{}\" twice", participant.name, name),
                  "one <provide-mesh> for each of its meshes");
    if (const PreciceConfig::Mesh& other = *config.find_mesh(name); other.dimension != first.dimension)
      throw Error(ExitCode::case_file, config.file.string(),
                  fmt::format("participant \"{}\" provides \"{}\" in {} dimensions and \"{}\" in {}",
                              participant.name, first.name, first.dimension, name, other.dimension),
                  "all meshes of a participant lie in one space");
  }
}

}  // namespace

const PreciceConfig::Participant& checked_participant(const PreciceConfig& config, const std::string& name,
                                                      int rank, int size) {
  if (size < 1 || rank < 0 || rank >= size)
    throw Error(ExitCode::command_line, name, fmt::format("is rank {} of {}", rank, size),
                "ranks are numbered from 0 to size - 1");
  if (size > 1)
    throw Error(ExitCode::command_line, name, fmt::format("runs as {} processes", size),
                "Strake takes one process for each participant: start it without mpirun");
  const PreciceConfig::Participant* found = config.find_participant(name);
  if (!found) {
    std::vector<std::string> names;
    for (const auto& participant : config.participants) names.push_back(participant.name);
    const std::string near = did_you_mean(name, names);
    throw Error(ExitCode::case_file, config.file.string(), fmt::format("has no participant \"{}\"", name),
                near.empty() ? "a name that <participant name=\"…\"> gives"
                             : fmt::format("did you mean \"{}\"?", near));
  }
  check_meshes(config, *found);
  if (found->writes.empty())
    throw Error(ExitCode::case_file, config.file.string(),
                fmt::format("participant \"{}\" writes no data", name),
                "<write-data name=\"…\" mesh=\"…\" />");
  for (const auto* list : {&found->writes, &found->reads})
    for (const auto& entry : *list)
      if (std::find(found->provided.begin(), found->provided.end(), entry.mesh) == found->provided.end())
        throw Error(ExitCode::case_file, config.file.string(),
                    fmt::format("participant \"{}\" uses data \"{}\" on mesh \"{}\", which it receives", name,
                                entry.data, entry.mesh),
                    "Strake gives data on the participant's own meshes alone");
  return *found;
}

SolverRun::SolverRun(const std::string& participant, const std::string& config, int rank, int size)
    : config_(PreciceConfig::read(config)),
      me_(&checked_participant(config_, participant, rank, size)),
      implicit_(is_implicit(config_, participant)),
      meshes_(meshes_of(config_, *me_)),
      data_(config_, *me_, names_of_environment()) {
  initial_data.required = is_exchanged(config_, participant, &PreciceConfig::Exchange::from,
                                       &PreciceConfig::Exchange::initialize);
  takes_history_ =
      is_exchanged(config_, participant, &PreciceConfig::Exchange::to, &PreciceConfig::Exchange::substeps);
  const ServeOptions connection = connection_of_environment();
  is_structure_ = connection.name == "structure";
  place_ = fmt::format("{}, preCICE participant \"{}\"", connection.name, participant);
  tune_malloc();
  prepare_last_moments(connection.name, connection.endpoint);
  conversation_ = std::make_unique<Conversation>(connection);
}

SolverRun::~SolverRun() {
  finish("ended without finalize()");
}

SolverMesh& SolverRun::mesh(const std::string& name) {
  for (SolverMesh& one : meshes_)
    if (one.name() == name) return one;
  const std::string own = fmt::format("\"{}\"", joined(me_->provided, "\", \""));
  const auto& received = me_->received;
  if (std::find(received.begin(), received.end(), name) != received.end())
    throw Error(ExitCode::solver_fault, fmt::format("mesh \"{}\"", name), "is the partner's",
                meshes_.size() == 1 ? "this participant's own mesh is " + own
                                    : "this participant's own meshes are " + own);
  throw Error(ExitCode::solver_fault, fmt::format("mesh \"{}\"", name), "is none of this participant",
              "it provides " + own);
}

bool SolverRun::uses_faces(const std::string& mesh) const {
  const auto& own = me_->provided;
  if (std::find(own.begin(), own.end(), mesh) == own.end()) return false;
  if (is_structure_) return true;
  for (const auto& participant : config_.participants)
    for (const auto& mapping : participant.mappings)
      for (const char* kind : {"nearest-projection", "linear-cell-interpolation"})
        if (mapping.kind == kind && (mapping.from == mesh || mapping.to == mesh)) return true;
  return false;
}

void SolverRun::fit_data() {
  if (initialized_) return;
  for (const std::string& name : data_.meshes()) data_.resize(name, mesh(name).size());
}

void SolverRun::check_time(double relative) const {
  if (std::isfinite(relative) && relative >= 0 && relative <= left() + round_off * window_.dt) return;
  throw Error(
      ExitCode::solver_fault, place_,
      fmt::format("reads at {:.9g} s after now, and {:.9g} s are left of the window", relative, left()),
      "a time from 0 to getMaxTimeStepSize()");
}

void SolverRun::prepare(const Setup& setup, const std::vector<InterfaceMesh>& own) {
  if (setup.interface == "volume")
    throw Error(ExitCode::case_file, place_, "cannot take part where coupling.interface = \"volume\"",
                "coupling.interface = \"surface\"");
  sends_history_ = setup.history;
  data_.begin(setup.partner_mesh, setup.partner_initial, own);
}

/// The meshes that have data; each must have vertices.
std::vector<InterfaceMesh> SolverRun::coupled_meshes() const {
  std::vector<InterfaceMesh> coupled;
  for (const std::string& name : data_.meshes()) {
    if (mesh(name).size() == 0)
      throw Error(ExitCode::solver_fault, fmt::format("mesh \"{}\"", name), "has no vertices",
                  "setMeshVertices() before initialize()");
    coupled.push_back(mesh(name).interface_mesh());
  }
  return coupled;
}

Description SolverRun::description_of(const InterfaceMesh& joined) {
  Description description;
  description.initial = data_.take_fields();
  description.history = takes_history_;
  description.partner_initial = is_structure_;
  description.cannot_resume = true;
  std::string meshes;
  for (const std::string& name : data_.meshes())
    meshes += fmt::format("   mesh \"{}\", {} points", name, mesh(name).size());
  description.lines = {fmt::format("preCICE participant \"{}\"{}", me_->name, meshes)};
  if (joined.meshes.empty()) return description;
  description.sent_on = data_.written_on();
  description.taken_on = data_.read_on();
  return description;
}

void SolverRun::initialize() {
  if (initial_data.missed())
    throw Error(ExitCode::solver_fault, "initial data", "the solver has not asked whether they are required",
                "call requiresInitialData() and then writeData() before initialize()");
  const std::vector<InterfaceMesh> own = coupled_meshes();
  fit_data();
  wire::Request request = conversation_->next();
  if (const auto* refused = std::get_if<wire::Refused>(&request.what)) {
    conversation_.reset();
    throw Error(ExitCode::participant_lost, place_, "was refused by the coupler: " + refused->problem,
                refused->fix);
  }
  const auto* setup = std::get_if<Setup>(&request.what);
  if (!setup)
    throw Error(ExitCode::participant_lost, place_,
                fmt::format("the coupler sent {} before Setup", wire::name_of(request)));
  prepare(*setup, own);
  wire::Ready ready{joined(own, me_->name), {}};
  ready.description = description_of(ready.mesh);
  conversation_->answer({0, std::move(ready)});
  initialized_ = true;
  await_window();
}

void SolverRun::settle(wire::Before before) {
  if (before == wire::Before::commit) {
    data_.commit();
    complete_ = true;
  }
  if (before != wire::Before::rewind) return;
  if (!implicit_)
    throw Error(
        ExitCode::case_file, config_.file.string(),
        fmt::format("describes an explicit scheme, and the coupler asks \"{}\" to compute a window again",
                    me_->name),
        "make the scheme implicit there, so that the solver saves its state,\n"
        "or set coupling.surface.converged.max_iterations = 1 in the case");
  read_checkpoint = {.required = true};
}

void SolverRun::begin_window(const wire::Advance& advance) {
  const bool again = advance.before == wire::Before::rewind;
  ongoing_ = true;  // what is thrown below is a fault of this window, and not the run's end
  settle(advance.before);
  write_checkpoint = {.required = implicit_ && !again};
  window_ = advance.window;
  done_ = 0;
  history_.clear();
  sends_history_ = sends_history_ || advance.input.wants_history;
  data_.receive(window_, advance.input);
  noted_.reset();  // the solver went on
}

void SolverRun::await_window() {
  for (;;) {
    wire::Request request = conversation_->next();
    if (const auto* advance = std::get_if<wire::Advance>(&request.what)) return begin_window(*advance);
    if (const auto* stop = std::get_if<wire::Stop>(&request.what)) {
      if (stop->commit) settle(wire::Before::commit);
      ongoing_ = false;
      return;
    }
    const auto* checkpoint = std::get_if<wire::Checkpoint>(&request.what);
    if (!checkpoint)
      throw Error(ExitCode::participant_lost, place_,
                  fmt::format("the coupler sent {} in a run", wire::name_of(request)));
    if (checkpoint->resume)
      throw Error(ExitCode::case_file, place_,
                  "cannot resume: preCICE has no function that saves a solver's state",
                  "run the case from its beginning");
    settle(checkpoint->before);
    conversation_->answer({0, wire::Done{}});
  }
}

void SolverRun::check_step(double dt) const {
  if (!std::isfinite(dt) || dt <= 0)
    throw Error(ExitCode::solver_fault, "time step", fmt::format("is {} s", dt),
                "a time step is finite and greater than 0");
  if (dt > left() + round_off * window_.dt)
    throw Error(ExitCode::solver_fault, "time step",
                fmt::format("is {:.9g} s, and {:.9g} s are left of the window", dt, left()),
                "at most getMaxTimeStepSize()");
  if (write_checkpoint.missed())
    throw Error(ExitCode::solver_fault, "checkpoint",
                "the solver has not asked whether it must save its state",
                "call requiresWritingCheckpoint() before advance()");
  if (read_checkpoint.missed())
    throw Error(ExitCode::solver_fault, "checkpoint",
                "the solver has not asked whether it must go back to its saved state",
                "call requiresReadingCheckpoint() after advance()");
}

void SolverRun::advance(double dt) {
  check_step(dt);
  const bool at_end = dt >= left() - round_off * window_.dt;
  if (at_end || sends_history_) data_.check_written();
  if (at_end && answered_ > 0) data_.check_read();
  if (at_end && !start_read_ && data_.read_start_alone(window_.t, round_off * window_.dt))
    start_read_ = window_.t;
  complete_ = false;
  write_checkpoint = read_checkpoint = {};
  done_ = at_end ? window_.dt : done_ + dt;
  std::vector<Field> fields = data_.take_fields();
  if (sends_history_) history_.push_back({now(), fields});
  if (at_end) return send_window(std::move(fields));
  conversation_->working(done_ / window_.dt, "time steps inside the window");
}

void SolverRun::send_window(std::vector<Field> fields) {
  Advanced advanced;
  advanced.output = std::move(fields);
  advanced.history = std::move(history_);
  advanced.monitor = sections_.seconds();
  if (const double window = config_.window_of(me_->name); window > 0)
    advanced.monitor["precice.window"] = window;
  if (start_read_) advanced.monitor["precice.start_read"] = *start_read_;
  ++answered_;
  conversation_->answer({0, std::move(advanced)});
  await_window();
}

/// Why the solver leaves, where it said so in STRAKE_PRECICE_REASON: C has no exception that could carry it.
Error SolverRun::reason_to_leave(const std::string& otherwise) const {
  const char* given = std::getenv("STRAKE_PRECICE_REASON");
  const std::string text = given ? given : "", mark = "\n  fix: ";
  if (text.empty()) return {ExitCode::solver_fault, place_, otherwise, "its log may say more"};
  const std::size_t fix = text.find(mark);
  return {ExitCode::solver_fault, place_, text.substr(0, fix),
          fix == std::string::npos ? "its log may say more" : text.substr(fix + mark.size())};
}

/// Tells the coupler why there will be no answer to its question. Before `initialize` that question may not
/// have been received yet.
void SolverRun::leave_with(const Error& error) {
  constexpr std::chrono::milliseconds to_receive{1000};
  if (!initialized_) conversation_->next_within(to_receive);
  conversation_->answer({0, wire::Fault{error.where(), error.problem(), error.fix(), error.code()}});
}

void SolverRun::finish(const std::string& why) {
  if (finished_) return;
  finished_ = true;
  if (!conversation_) return;
  try {
    if (initialized_ && !ongoing_)
      conversation_->answer({0, wire::Done{}});
    else if (noted_)
      leave_with(Error(noted_->code(), place_ + ", " + noted_->where(), noted_->problem(), noted_->fix()));
    else
      leave_with(reason_to_leave(why));
  } catch (const std::exception&) {  // the connection cannot carry it: the end of the process tells
  }
  ongoing_ = false;
  conversation_.reset();  // what was sent leaves first
}

void Sections::start(std::string name) {
  open_.emplace_back(std::move(name), Clock::now());
}

void Sections::stop() {
  if (open_.empty())
    throw Error(ExitCode::solver_fault, "sections", "none is open", "startProfilingSection() opens one");
  const auto& [name, since] = open_.back();
  seconds_["seconds." + name] += std::chrono::duration<double>(Clock::now() - since).count();
  open_.pop_back();
}

std::map<std::string, double> Sections::seconds() const {
  return seconds_;
}

namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  if (value && *value) return value;
  throw Error(ExitCode::command_line, name,
              "is not in the environment: this libprecice takes part in runs of Strake alone",
              "start the solver by strake run, or as run.json says under start_by_hand;\n"
              "for a run of preCICE use its own library: look at LD_LIBRARY_PATH");
}

}  // namespace

ServeOptions connection_of_environment() {
  ServeOptions options{.endpoint = variable("STRAKE_CONNECT"),
                       .name = variable("STRAKE_NAME"),
                       .token = variable("STRAKE_TOKEN"),
                       .solver = "precice",
                       .version = PRECICE_VERSION};
  const std::string hash = bytes_of(variable("STRAKE_CASE_HASH"));
  if (hash.size() != options.case_hash.size())
    throw Error(ExitCode::command_line, "STRAKE_CASE_HASH", "is no SHA-256: expected 64 hexadecimal digits");
  std::copy(hash.begin(), hash.end(), options.case_hash.begin());
  return options;
}

}  // namespace strake
