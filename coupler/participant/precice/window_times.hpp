#pragma once

#include "proto/interface.hpp"

#include <cmath>

namespace strake {

/// The time of a preCICE run, which has no function that tells it. Windows end at multiples of the first
/// one's length, by multiplication, as in the coupler's own loop: sums of a length drift.
class WindowTimes {
 public:
  /// The window that begins now. dt: what the library leaves [s].
  Window begin(double dt) {
    if (length_ == 0) length_ = dt;
    return {.t = time_, .dt = dt};
  }
  /// The window is accepted.
  void end(const Window& window) {
    constexpr double slack = 1e-6;  // of a window: a decimal step is not exact in binary
    const double line = (std::floor(time_ / length_ + slack) + 1) * length_, end = window.t + window.dt;
    time_ = std::abs(end - line) < slack * window.dt ? line : end;
    ++windows_;
  }
  double time() const { return time_; }      // [s]
  double length() const { return length_; }  // [s] of the first window
  long windows() const { return windows_; }  // accepted

 private:
  double time_ = 0, length_ = 0;
  long windows_ = 0;
};

}  // namespace strake
