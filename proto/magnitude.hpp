#pragma once
// Private to the case_*.cpp files: how large and how small a quantity can be.

#include <string>

namespace strake {

/// Magnitudes of a quantity that any ship, model or laboratory has; what lies beyond is a slip of the pen.
struct Magnitude {
  double smallest;  // of a quantity that must not be zero
  double largest;
};

/// Of the quantity that is given in this unit. A unit that is not known has wide limits.
Magnitude magnitude_of(const std::string& unit);

}  // namespace strake
