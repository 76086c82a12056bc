#pragma once

#include "coupler/precice/solver_run.hpp"
#include "proto/error.hpp"

#include <precice/Exceptions.hpp>
#include <precice/Version.h>
#include <precice/span.hpp>

#include <exception>
#include <string>
#include <utility>

namespace precice::impl {

/// What stands behind a precice::Participant.
class ParticipantImpl {
 public:
  ParticipantImpl(const std::string& name, const std::string& config, int rank, int size)
      : run(name, config, rank, size), exceptions(std::uncaught_exceptions()) {}

  strake::SolverRun run;
  int exceptions;  // under way when it was made
};

}  // namespace precice::impl

namespace strake {

/// The text of an error that a solver is told: function, place, reason, remedy.
inline std::string solver_text(const char* function, const Error& error) {
  std::string text = to_text(Error(error.code(), std::string("precice::") + function + ": " + error.where(),
                                   error.problem(), error.fix()));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

/// Calls a function of Strake's for one of preCICE's. What it throws becomes a precice::Error with the name
/// of that function; where there is a run, it ends with this error if the solver leaves early.
template <class Call>
auto guarded_call(const char* function, SolverRun* run, Call&& call) -> decltype(call()) {
  try {
    return std::forward<Call>(call)();
  } catch (const Error& error) {
    if (run)
      run->note(
          Error(error.code(), std::string(function) + ", " + error.where(), error.problem(), error.fix()));
    throw precice::Error(solver_text(function, error));
  } catch (const std::exception& error) {
    throw precice::Error(std::string("precice::") + function + ": " + error.what());
  }
}

/// Throws: a function that Strake does not have, and why.
[[noreturn]] inline void refuse_function(const std::string& reason, const std::string& fix) {
  throw Error(ExitCode::solver_fault, "not supported", reason, fix);
}

// What preCICE's functions demand of the moment when they are called, and of the names they are called with.
// Each throws Error(solver_fault) where that is not so.

void not_finished(const SolverRun&);
void before_initialize(const SolverRun&);
void initialized(const SolverRun&);  // and not finished
void in_coupling(const SolverRun&);  // initialized, and the run goes on

/// A mesh that the participant provides or receives.
const PreciceConfig::Mesh& used_mesh(const SolverRun&, const std::string& name);
/// Data that the mesh may hold.
const PreciceConfig::Data& data_of_mesh(const SolverRun&, const PreciceConfig::Mesh&,
                                        const std::string& name);

/// A text without the zeros at its end that a literal may bring along.
std::string text_of(::precice::span<const char>);

/// What getVersionInformation() says: "version;revision;features".
inline constexpr char precice_version[] =
    PRECICE_VERSION "-strake;revision=strake " STRAKE_VERSION ";MPI:OFF;PETSC:OFF;PYTHON:OFF";

}  // namespace strake
