#pragma once

#include <vector>

#include "coupler/clocks.hpp"
#include "coupler/run_loop.hpp"

namespace strake {

/// A committed window on its way from the process that ran it to the coupler, as an Advanced: the numbers
/// among its monitors, the rows of iterations.csv and the questions asked in it as matrices, and the fields
/// of the interface record, those without a place of their own as a history of two: structure and fluid.
struct WindowMessage {
  CommittedWindow window;
  LoopState state;  // after it
  std::vector<Exchange> exchanges;
};

Advanced to_message(WindowMessage);
/// measured: Scheme::measured, in that order in each row of the log. Throws Error(participant_lost) where
/// something is missing.
WindowMessage from_message(const Advanced&, const std::vector<Column>& measured);

}  // namespace strake
