#pragma once

#include <algorithm>
#include <cmath>
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
/// turns at once: water follows it. So are those of a chine under flared sides, but each counts with its
/// share there: water leaves it along the plane that halves it, or follows it.
enum class Bend : std::uint8_t { smooth, knuckle, chine, corner };

/// Whether the faces beside a turn are one face that turns at once.
inline bool is_turn_within_face(Bend bend) {
  return bend == Bend::knuckle || bend == Bend::chine;
}

/// Which turns that stand out are knuckles. Of a body that enters the water: those of at most 46 degrees
/// (chosen; as a knuckle, a chine of 60 degrees has a force 4 % lower behind it) that are no keels. Sharper
/// turns are chines below a right angle, where both faces look down by more than `keel_lean`.
struct Knuckles {
  double sharpest = 0.8;  // turn [rad]
  bool keels = false;     // keels are knuckles too
};
/// Those of a body that stands in the water: all turns below a right angle.
inline constexpr Knuckles knuckles_under_water{0.5 * std::numbers::pi - 1e-6, true};

/// Largest lean of a keel: half the difference of its two faces' angles against the level [rad], 2 degrees.
/// Chosen: no water crosses a keel that stands upright, and as a knuckle such a keel has a first force up to
/// 15 % higher. Where the body heels water crosses the turn.
inline constexpr double largest_lean = 0.035;

/// Whether a turn between faces with these unit normals, y up, is a keel: both look down, to opposite sides
/// by more than half a degree, at about the same angle.
template <class Normal>
bool is_keel(const Normal& before, const Normal& behind) {
  const double sides = before.dot(behind) - before.y() * behind.y();
  return sides < -1e-4 && before.y() < 0 && behind.y() < 0 &&
         std::abs(std::acos(std::min(1.0, -before.y())) - std::acos(std::min(1.0, -behind.y()))) <
             2 * largest_lean;
}

/// Returns what a turn is [rad], positive where the body is convex. before, behind: the unit normals of its
/// two faces, y up.
template <class Normal>
Bend bend_of(double turn, double beside, const Normal& before, const Normal& behind,
             const Knuckles& knuckles = {}) {
  const double size = std::abs(turn);
  if (!stands_out(size, beside)) return Bend::smooth;
  if (is_keel(before, behind) && !knuckles.keels) return Bend::corner;
  if (size <= knuckles.sharpest) return Bend::knuckle;
  const bool is_flared = std::min(-before.y(), -behind.y()) > keel_lean;
  return is_flared && turn > 0 && size < 0.5 * std::numbers::pi - 1e-6 ? Bend::chine : Bend::corner;
}

}  // namespace strake
