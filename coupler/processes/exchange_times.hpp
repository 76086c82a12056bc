#pragma once

#include "proto/interface.hpp"

#include <cstdint>
#include <string>

namespace strake {

/// One question to a participant and its answer, as the coupler saw it. Times are nanoseconds of a steady
/// clock (CLOCK_MONOTONIC): the coupler's own, and that of the participant, which on one machine is the same.
struct Exchange {
  std::string participant;                  // "fluid"
  std::string asked;                        // "Advance"
  long window = 0;                          // from 1; 0: none has begun
  std::uint32_t iteration = 0;              // 0: between two windows
  std::int64_t sent = 0, heard = 0;         // [ns] coupler
  std::int64_t received = 0, answered = 0;  // [ns] participant; 0: not reported
};

/// How far a participant's clock is ahead of the coupler's. A question is received after it was sent, and an
/// answer is heard after it was given, so that each exchange shuts the offset in:
///   answered − heard  ≤  offset  ≤  received − sent.
/// Where 0 lies within those bounds the two clocks count as one, as they are on one machine.
class ClockOffset {
 public:
  void learn(const Exchange&);
  std::int64_t offset() const;  // [ns] participant − coupler
  /// Time in which the participant computed, on the coupler's clock; the whole exchange if it is not
  /// reported.
  struct Span {
    std::int64_t begin = 0, end = 0;  // [ns]
  };
  Span computing(const Exchange&) const;

 private:
  bool known_ = false;
  std::int64_t low_ = 0, high_ = 0;  // [ns]
};

}  // namespace strake
