#pragma once

#include "coupler/coupling/convergence.hpp"
#include "coupler/coupling/window_loop.hpp"
#include "coupler/mapping/mapping.hpp"
#include "proto/case/case_keys.hpp"

#include <filesystem>
#include <string>

namespace strake {

class CaseFile;

/// The keys of [coupling] and [run] that the coupler reads; what it shares with the solvers stands in
/// CommonKeys.
struct CouplingKeys {
  // [coupling.surface]
  bool parallel = false;  // both solvers at once; else the fluid first
  MappingParameters mapping;
  std::string accelerator = "iqn-ils";  // iqn-ils | iqn-imvj | aitken | constant
  double initial_relaxation = 0.1;      // ω of the first iterations, and of `constant`
  int reused_windows = 8;               // windows whose columns IQN-ILS keeps
  double filter = 1e-2;                 // QR filter of IQN-ILS, relative
  std::string filter_kind = "QR2";      // QR2 | QR1
  int max_columns = 50;                 // of quasi-Newton: what bounds its memory
  std::string predictor = "quadratic";  // constant | linear | quadratic
  double relative = 1e-4;  // converged when rms(H(x) − x) <= max(absolute, relative · rms(H(x) − x_n))
  double absolute = 0;     // [m]; 0: 1e-6 of the fluid's spacing
  double residual_relative = 0;  // of the window's first residual; 0: not tested
  Measure measure = Measure::increment;
  Limits load;  // of the fluid's force, or what else it sends
  int min_iterations = 1, max_iterations = 20;
  Unconverged unconverged = Unconverged::accept;
  WindowControl control;
  // [coupling.volume]
  // waiting
  double frozen_after = 10;      // [s] disconnected but alive
  double answer_within = 600;    // [s] of silence while busy
  double start_within = 60;      // [s] from launch to Hello
  double attach_within = 600;    // [s] from the printed command line to Hello, of one started by hand
  std::string endpoint = "ipc";  // ipc | ipc://PATH | tcp://ADDRESS:PORT
  std::filesystem::path keys;    // folder that `strake keys` made; empty: no encryption
  bool unencrypted = false;      // an endpoint that other machines reach may go without keys
  // [run]
  double checkpoint = 60;      // [s] of wall clock
  int checkpoint_windows = 0;  // windows between checkpoints; 0: by the clock alone

  bool iterates() const { return max_iterations > 1; }
};

/// Declares and reads the coupler's own keys. Call after read_common.
CouplingKeys read_coupling(CaseFile&);

}  // namespace strake
