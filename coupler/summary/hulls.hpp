#pragma once

#include "proto/interface.hpp"

#include <array>
#include <optional>
#include <vector>

namespace strake {

/// Left and right end of each hull of a body in the plane at the height y, from left to right; empty where
/// the outline is not closed there. Hulls are parts that a level surface cuts apart. Where the body lies
/// below the gap between two parts they are one, as the sides of a hollow V.
std::vector<std::array<double, 2>> hulls_at(const InterfaceMesh& body, double y);

/// Room between two hulls under a roof: its ends at its mouth, and the heights of mouth and roof [m].
struct Hollow {
  double left = 0, right = 0, mouth = 0, roof = 0;
};
/// The widest hollow of a body in the plane whose roof is at most at the height `level` [m]. Water that
/// stands at this height has closed it, with the air that is in it.
std::optional<Hollow> hollow_below(const InterfaceMesh& body, double level);

}  // namespace strake
