#pragma once

#include <algorithm>
#include <numbers>

// Where the surface of a body or a tank has a corner (in the plane) or an edge (in space).

namespace strake {

/// A turn sharper than this makes a corner; a surface of many smaller turns is smooth.
inline constexpr double corner_angle = 0.35;  // [rad], 20 degrees
/// So does a smaller turn that stands alone: a smooth surface turns about as much beside it.
inline constexpr double lone_angle = 0.03, lone_share = 0.25;  // [rad], of the lone turn

/// Largest angle inside a body at which water leaves its corner: that of plates and boxes, with room for
/// round-off.
inline constexpr double right_angle = 0.5 * std::numbers::pi + 1e-6;  // [rad]
/// A corner is a keel where the normals of both faces point down by more than this, the sine of 15 degrees.
inline constexpr double keel_lean = 0.2588;
/// Two triangles that turn by less lie in one plane.
inline constexpr double flat_angle = 1e-4;  // [rad]

/// Whether water leaves a body at a corner: one of at most a right angle that is no keel.
/// angle: inside the body [rad]; down, other_down: how far the unit normals of its two faces point down.
inline bool is_sharp_corner(double angle, double down, double other_down) {
  return angle < right_angle && std::min(down, other_down) <= keel_lean;
}

/// Whether a turn makes a corner; `beside` is the largest turn next to it [rad, both positive].
inline bool is_corner(double turn, double beside) {
  return turn > corner_angle || (turn > lone_angle && beside < lone_share * turn);
}

}  // namespace strake
