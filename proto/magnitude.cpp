#include "proto/magnitude.hpp"

#include <algorithm>
#include <array>

namespace strake {

// The limits keep squares, products and quotients of such numbers within the range of a double. They lie many
// orders of magnitude beyond what has been built or measured, so that they exclude no real case.
Magnitude magnitude_of(const std::string& unit) {
  struct Known {
    const char* unit;
    Magnitude magnitude;
  };
  static constexpr std::array<Known, 18> known = {{{"m", {1e-9, 1e6}},
                                                   {"s", {1e-15, 1e9}},
                                                   {"kg", {1e-12, 1e15}},
                                                   {"kg/m^3", {1e-6, 1e6}},
                                                   {"kg m^2", {1e-18, 1e24}},
                                                   {"m/s", {1e-9, 1e5}},
                                                   {"m/s^2", {1e-9, 1e6}},
                                                   {"m^2/s", {1e-15, 1e6}},
                                                   {"Pa", {1e-3, 1e15}},
                                                   {"Pa | N/m", {1e-3, 1e15}},
                                                   {"N", {1e-12, 1e15}},
                                                   {"J/m^2", {1e-12, 1e15}},
                                                   {"Hz", {1e-9, 1e9}},
                                                   {"1/s", {1e-9, 1e12}},
                                                   {"rad/s", {1e-9, 1e6}},
                                                   {"deg", {1e-9, 1e6}},
                                                   {"SI", {1e-30, 1e30}},
                                                   {"1", {1e-16, 1e30}}}};
  constexpr Magnitude unknown{1e-16, 1e15};
  const auto* found =
      std::find_if(known.begin(), known.end(), [&](const Known& one) { return unit == one.unit; });
  return found == known.end() ? unknown : found->magnitude;
}

}  // namespace strake
