#pragma once

#include "coupler/case/case_view.hpp"

#include <optional>
#include <string>
#include <vector>

namespace strake {

/// What a case computes with the fluid of ours in surface coupling, as far as its keys tell.
struct Pace {
  double step = 0, window = 0;  // [s] the fluid's step while the flow is fast, the exchange window
  double chosen_step = 0, chosen_window = 0;  // [s] the same where the case gives neither
  double steps = 0, windows = 0;              // of the run
  double iterations = 1;                      // of a window, about
  double particles = 0;                       // of water and walls, about; 0: not known
  double seconds = 0;                         // of computing, within a factor of three
  double bytes = 0;                           // of memory, of both sides
  double frame_bytes = 0;                     // of a frame of the water, on disk
};
/// Estimates it; nothing without water of ours, or in volume coupling.
std::optional<Pace> pace_of(const CaseView&);

/// Says which step and window the case has and why, and what it costs: lines of `strake check`. Empty where
/// there is no Pace.
std::vector<std::string> pace_lines(const CaseView&);

/// One line for each key that makes the run twenty times finer or coarser than Strake would, or that has
/// another unit. Looked at are the step, the window, the spacing beside the body, the speed of sound,
/// materials. A line names the value that Strake would take, and the cost or the risk. extent: largest length
/// of the body [m]; 0: not known.
std::vector<std::string> far_off_lines(const CaseView&, double extent);

}  // namespace strake
