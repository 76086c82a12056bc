#include "coupler/plot/colour_map.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake::picture {
namespace {

/// The transfer function of sRGB (IEC 61966-2-1).
double encoded(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

}  // namespace

// OKLab (B. Ottosson, 2020): cube roots of cone responses are linear in L, a, b.
Colour from_oklch(double lightness, double chroma, double hue) {
  const double angle = hue * std::numbers::pi / 180;
  const double a = chroma * std::cos(angle), b = chroma * std::sin(angle);
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

// The chroma stays inside what a screen shows: its bound is lowest, 0.098, at the blue-green of s = 0.4.
Colour water_colour(double s) {
  const double x = std::clamp(s, 0.0, 1.0), off = x < 0.4 ? (x - 0.4) / 0.4 : (x - 0.4) / 0.6;
  const double chroma = 0.095 + (x < 0.4 ? 0.045 : 0.085) * off * off;
  return from_oklch(0.28 + 0.62 * x, chroma, 300 - 195 * x);
}

Colour solid_colour(double s) {
  const double x = std::clamp(s, 0.0, 1.0);
  return from_oklch(0.30 + 0.62 * x, 0.10 + 0.32 * x * (1 - x), 330 + 120 * x);
}

}  // namespace strake::picture
