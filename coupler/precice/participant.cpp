// precice::Participant: the run, and what a solver may ask of it at any time.

#include "coupler/precice/guarded_call.hpp"
#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <precice/Participant.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace precice {

using strake::before_initialize;
using strake::guarded_call;
using strake::in_coupling;
using strake::initialized;
using strake::text_of;

Participant::Participant(string_view name, string_view config, int rank, int size)
    : impl_(guarded_call("Participant()", nullptr, [&] {
        return std::make_unique<impl::ParticipantImpl>(text_of(name), text_of(config), rank, size);
      })) {}

Participant::Participant(string_view name, string_view config, int rank, int size, void*)
    : Participant(name, config, rank, size) {}

Participant::~Participant() {
  const bool thrown = std::uncaught_exceptions() > impl_->exceptions;
  impl_->run.finish(thrown ? "was left by an exception" : "ended before the run did, without finalize()");
}

void Participant::initialize() {
  guarded_call("initialize()", &impl_->run, [&] {
    before_initialize(impl_->run);
    impl_->run.initialize();
  });
}

void Participant::advance(double dt) {
  guarded_call("advance()", &impl_->run, [&] {
    in_coupling(impl_->run);
    impl_->run.advance(dt);
  });
}

void Participant::finalize() {
  guarded_call("finalize()", &impl_->run, [&] {
    strake::not_finished(impl_->run);
    impl_->run.finish("called finalize() before the end of the run");
  });
}

bool Participant::isCouplingOngoing() const {
  return guarded_call("isCouplingOngoing()", &impl_->run, [&] {
    initialized(impl_->run);
    return impl_->run.ongoing();
  });
}

bool Participant::isTimeWindowComplete() const {
  return guarded_call("isTimeWindowComplete()", &impl_->run, [&] {
    initialized(impl_->run);
    return impl_->run.window_complete();
  });
}

double Participant::getMaxTimeStepSize() const {
  return guarded_call("getMaxTimeStepSize()", &impl_->run, [&] {
    initialized(impl_->run);
    return impl_->run.left();
  });
}

bool Participant::requiresInitialData() {
  return guarded_call("requiresInitialData()", &impl_->run, [&] {
    before_initialize(impl_->run);
    return impl_->run.initial_data.ask();
  });
}

bool Participant::requiresWritingCheckpoint() {
  return guarded_call("requiresWritingCheckpoint()", &impl_->run, [&] {
    initialized(impl_->run);
    return impl_->run.write_checkpoint.ask();
  });
}

bool Participant::requiresReadingCheckpoint() {
  return guarded_call("requiresReadingCheckpoint()", &impl_->run, [&] {
    initialized(impl_->run);
    return impl_->run.read_checkpoint.ask();
  });
}

int Participant::getMeshDimensions(string_view mesh) const {
  return guarded_call("getMeshDimensions()", &impl_->run,
                      [&] { return strake::used_mesh(impl_->run, text_of(mesh)).dimension; });
}

int Participant::getDataDimensions(string_view mesh, string_view data) const {
  return guarded_call("getDataDimensions()", &impl_->run, [&] {
    const auto& used = strake::used_mesh(impl_->run, text_of(mesh));
    return strake::data_of_mesh(impl_->run, used, text_of(data)).vector ? used.dimension : 1;
  });
}

bool Participant::requiresMeshConnectivityFor(string_view mesh) const {
  return guarded_call("requiresMeshConnectivityFor()", &impl_->run, [&] {
    return impl_->run.uses_faces(strake::used_mesh(impl_->run, text_of(mesh)).name);
  });
}

void Participant::startProfilingSection(string_view name) {
  guarded_call("startProfilingSection()", &impl_->run, [&] { impl_->run.sections().start(text_of(name)); });
}

void Participant::stopLastProfilingSection() {
  guarded_call("stopLastProfilingSection()", &impl_->run, [&] { impl_->run.sections().stop(); });
}

}  // namespace precice

namespace strake {
namespace {

[[noreturn]] void refuse(const char* problem, const char* fix) {
  throw Error(ExitCode::solver_fault, "order of calls", problem, fix);
}

std::string near(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = did_you_mean(name, known);
  return nearest.empty() ? fmt::format("it has {}", joined(known))
                         : fmt::format("did you mean \"{}\"?", nearest);
}

}  // namespace

void not_finished(const SolverRun& run) {
  if (run.finished()) refuse("finalize() was called before", "finalize() is the last call, once");
}

void before_initialize(const SolverRun& run) {
  not_finished(run);
  if (run.initialized()) refuse("initialize() was called before", "this call stands before initialize()");
}

void initialized(const SolverRun& run) {
  not_finished(run);
  if (!run.initialized()) refuse("initialize() was not called yet", "call initialize() first");
}

void in_coupling(const SolverRun& run) {
  initialized(run);
  if (!run.ongoing()) refuse("the run has ended", "leave the loop when isCouplingOngoing() is false");
}

const PreciceConfig::Mesh& used_mesh(const SolverRun& run, const std::string& name) {
  std::vector<std::string> used = run.participant().provided;
  used.insert(used.end(), run.participant().received.begin(), run.participant().received.end());
  if (std::find(used.begin(), used.end(), name) == used.end())
    throw Error(ExitCode::solver_fault, fmt::format("mesh \"{}\"", name),
                fmt::format("is none of participant \"{}\"", run.participant().name), near(name, used));
  return *run.config().find_mesh(name);
}

const PreciceConfig::Data& data_of_mesh(const SolverRun& run, const PreciceConfig::Mesh& mesh,
                                        const std::string& name) {
  if (std::find(mesh.data.begin(), mesh.data.end(), name) == mesh.data.end())
    throw Error(ExitCode::solver_fault, fmt::format("data \"{}\"", name),
                fmt::format("is none of mesh \"{}\"", mesh.name), near(name, mesh.data));
  return *run.config().find_data(name);
}

std::string text_of(::precice::span<const char> text) {
  std::size_t size = text.size();
  while (size > 0 && text[size - 1] == '\0') --size;
  return {text.data(), size};
}

}  // namespace strake
