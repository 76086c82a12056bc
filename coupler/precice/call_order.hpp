#pragma once

#include "coupler/precice/solver_run.hpp"

#include <precice/span.hpp>

#include <string>

/// What preCICE's functions demand of the moment when they are called, and of the names they are called with.
/// Each throws Error(solver_fault) where that is not so.
namespace strake {

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

}  // namespace strake
