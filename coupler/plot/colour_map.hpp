#pragma once

namespace strake::picture {

/// sRGB, each in [0, 1].
struct Colour {
  double red = 0, green = 0, blue = 0;
};

/// Lightness, chroma and hue [degrees] of OKLab, whose distances are those that an eye sees.
Colour from_oklch(double lightness, double chroma, double hue);
/// Dark violet over blue and green to light yellow, lightness linear in s ∈ [0, 1]; values outside are
/// clamped.
Colour water_colour(double s);
/// Dark plum over red and orange to light yellow, lightness linear in s.
Colour solid_colour(double s);

}  // namespace strake::picture
