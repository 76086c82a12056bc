#pragma once

#include "coupler/acceleration/accelerator.hpp"
#include "coupler/coupling/convergence.hpp"
#include "coupler/coupling/window_loop.hpp"
#include "coupler/mapping/mapping.hpp"
#include "proto/case/case_keys.hpp"

#include <filesystem>
#include <string>

namespace strake {

class CaseFile;

/// How long the coupler waits for its participants [s].
struct WaitingKeys {
  double frozen_after = 10;    // disconnected but alive
  double answer_within = 600;  // of silence while busy
  double start_within = 60;    // from launch to Hello
  double attach_within = 600;  // from the printed command line to Hello, of one started by hand
};

/// Where participants connect, and who may.
struct NetworkKeys {
  std::string endpoint = "ipc";      // ipc | ipc://PATH | tcp://ADDRESS:PORT
  std::filesystem::path curve_keys;  // folder that `strake keys` made; empty: no encryption
  bool unencrypted = false;          // an endpoint that other machines reach may go without keys
};

/// The keys of [coupling] and [run] that the coupler reads; what it shares with the solvers stands in
/// CommonKeys.
struct CouplingKeys {
  // [coupling.surface]
  bool parallel = false;  // both solvers at once; else the fluid first
  MappingParameters mapping;
  AcceleratorParameters accelerator;
  std::string predictor = "quadratic";        // constant | linear | quadratic
  Convergence convergence = {.absolute = 0};  // [m]; 0: 1e-6 of the fluid's spacing
  WindowControl control;
  // [coupling.volume]
  // waiting
  std::string solid_velocity = "replace";  // replace | add; read by the fluid
  WaitingKeys waiting;
  NetworkKeys network;
  // [run]
  double checkpoint = 60;      // [s] of wall clock
  int checkpoint_windows = 0;  // windows between checkpoints; 0: by the clock alone

  bool iterates() const { return convergence.max_iterations > 1; }
};

/// Declares and reads the coupler's own keys. Call after read_common.
CouplingKeys read_coupling(CaseFile&);

}  // namespace strake
