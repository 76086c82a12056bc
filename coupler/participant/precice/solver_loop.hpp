#pragma once

#include "coupler/participant/precice/interface_exchange.hpp"
#include "coupler/participant/precice/own_results.hpp"
#include "coupler/participant/precice/window_times.hpp"
#include "proto/participant.hpp"

#include <string>
#include <vector>

namespace strake {

/// A solver in a preCICE run: in each window it reads the partner's fields, advances, writes its own, and
/// commits or rewinds as the library says.
class SolverLoop {
 public:
  /// side: "fluid" or "structure", for errors.
  SolverLoop(const PreciceLibrary&, const OwnPart&, Participant&, OwnResults&, std::string side);

  /// From `initialize` to the end of the run, without `finalize`. Error(solver_fault) if the solver asks for
  /// a shorter window, which preCICE cannot give, or fails.
  void run();

  const WindowTimes& times() const { return times_; }
  long iterations() const { return iterations_; }  // of all windows

 private:
  Input input_of(const Window&) const;
  std::vector<Field> mean_load(const Window&) const;
  void write_window(const Window&, const Advanced&) const;
  void check_length(const Window&, double limit, const std::string& why, const std::string& fix) const;
  std::string place(const Window&) const;

  const PreciceLibrary& library_;
  const OwnPart& part_;
  Participant& solver_;
  OwnResults& results_;
  std::string side_;
  InterfaceExchange exchange_;
  WindowTimes times_;
  long iterations_ = 0;
};

}  // namespace strake
