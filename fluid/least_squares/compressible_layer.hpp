#pragma once

#include <algorithm>
#include <cmath>

namespace strake::fluid {

/// Water is compressible only above the depth D (`fluid.sound_depth`), and incompressible beneath.
///
/// Sound would be reflected at D as from a rigid wall. A sheet at D therefore absorbs it. In the sheet the
/// water yields to the excess p' over the pressure at rest,
///   ∇·u = −g p'/(ρc),   ∫ g dy = 1.
/// The sheet has the admittance 1/(ρc) of the water above. The water beneath, which no plane wave moves, adds
/// none. So there is no echo at any frequency. A slow flow passes through the sheet into the deep water. The
/// sheet absorbs the part u/c of its pressure.
///
/// g is a hat over −h … h. Spread like that the sheet acts as if it lay (7/30) h too high. This is
/// ∫ (1 − (∫_y^h g)²) dy up to its middle less ∫ (∫_y^h g)² dy beyond it. The sheet is shifted down by as
/// much. The echo is then of second order in h over the wave's length: 2 % of a wave of 25 l0, 7 % at half of
/// that.
class SoundLayer {
 public:
  SoundLayer(double depth, double spacing) : depth_(depth), half_(half_width * spacing) {}

  bool is_whole() const { return std::isinf(depth_); }  // all of the water
  /// Part of 1/(ρc²) that the water at that depth has, falling from 1 to 0 over D ± h.
  double compressible(double depth) const {
    return is_whole() ? 1.0 : std::clamp(0.5 * (1 - (depth - depth_) / half_), 0.0, 1.0);
  }
  /// g [1/m].
  double yields(double depth) const {
    return is_whole() ? 0.0 : std::max(0.0, 1 - std::abs(depth - depth_ - lag * half_) / half_) / half_;
  }
  /// D past which all of the sheet lies [m].
  static double thickness(double spacing) { return (1 + lag) * half_width * spacing; }

 private:
  static constexpr double half_width = 2;  // [l0]: the layers of a lattice sum to one at any offset
  static constexpr double lag = 7.0 / 30;
  double depth_, half_;
};

}  // namespace strake::fluid
