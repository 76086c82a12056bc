#include "coupler/precice/call_order.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace strake {
namespace {

[[noreturn]] void refuse(const char* problem, const char* fix) {
  throw Error(ExitCode::solver_fault, "order of calls", problem, fix);
}

std::string near(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = did_you_mean(name, known);
  return nearest.empty() ? fmt::format("it has {}", fmt::join(known, ", "))
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
