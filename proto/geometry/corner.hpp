#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>

// Where the surface of a body or a tank has a corner (in the plane) or an edge (in space).

namespace strake {

/// A turn sharper than this stands out; a surface of many smaller turns is smooth.
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

/// Whether a turn stands out of the surface; `beside` is the largest turn next to it that is no corner
/// [rad, both positive].
inline bool stands_out(double turn, double beside) {
  return turn > corner_angle || (turn > lone_angle && beside < lone_share * turn);
}

/// What a turn of a surface is. The two faces of a corner end there. Those of a knuckle are one face that
/// turns at once: water follows it.
enum class Bend : std::uint8_t { smooth, knuckle, corner };

/// Which turns that stand out are knuckles. Of a body that enters the water: those of at most 46 degrees
/// (chosen; as a knuckle, a chine of 60 degrees has a force 4 % lower behind it) that are no keels.
struct Knuckles {
  double sharpest = 0.8;  // turn [rad]
  bool keels = false;     // keels are knuckles too
};
/// Those of a body that stands in the water: all turns below a right angle.
inline constexpr Knuckles knuckles_under_water{0.5 * std::numbers::pi - 1e-6, true};

/// Returns what a turn is [rad, positive]. before, behind: the unit normals of its two faces, y up. It is a
/// keel where both faces look down, and to opposite sides by more than half a degree.
template <class Normal>
Bend bend_of(double turn, double beside, const Normal& before, const Normal& behind,
             const Knuckles& knuckles = {}) {
  if (!stands_out(turn, beside)) return Bend::smooth;
  const double sides = before.dot(behind) - before.y() * behind.y();
  const bool is_keel = sides < -1e-4 && before.y() < 0 && behind.y() < 0;
  return turn > knuckles.sharpest || (is_keel && !knuckles.keels) ? Bend::corner : Bend::knuckle;
}

}  // namespace strake
