#pragma once

#include "proto/values.hpp"

#include <vector>

namespace strake {

/// One of the partner's fields over the window, components×n, to be read at any time in it.
class Waveform {
 public:
  /// degree: 0 constant, 1 linear, more: a polynomial of that degree through the nearest samples.
  explicit Waveform(int degree) : degree_(degree) {}

  struct Knot {
    double time;  // [s] absolute
    Values value;
  };
  /// The value that holds where the first window begins.
  void begin(double time, Values value);
  /// The partner's samples for the window that begins at `start`, ascending; the last one is the window's
  /// end. Replaces those that were set for the same window. The field keeps what it had at `start`.
  void set_window(double start, std::vector<Knot> samples);
  /// The window is over: its end is the next one's start.
  void commit();

  /// The value at a time of the window. With one sample and degree 1 it is linear between the window's ends.
  Values at(double time) const;
  bool empty() const { return knots_.empty(); }

 private:
  int degree_;
  Knot start_{0, {}};
  std::vector<Knot> knots_;  // of the window, ascending
};

}  // namespace strake
