#pragma once

#include "proto/geometry/polygon.hpp"

namespace strake {

/// A side shorter than this is shorter than the pieces into which the water divides a face [spacings].
inline constexpr double short_side = 0.5;

/// Returns a closed outline, counter-clockwise, without details that water of that spacing does not see [m].
/// One without short sides stays as it is. Else
///   - points that turn the outline one way within half a spacing, a small rounding or chamfer, are the
///     corner in which the sides beside them meet;
///   - a zigzag of short sides, as of rounded numbers, is straightened, by a tenth of a spacing at most at a
///     time.
Polygon without_details(const Polygon&, double spacing);

/// The same, and points between short sides are left out where the outline stays within 1 % of a spacing (the
/// algorithm of Douglas and Peucker). An outline that mirrors itself from left to right goes on to do so.
Polygon thinned(const Polygon&, double spacing);

}  // namespace strake
