#pragma once

#include "coupler/plot/colour_map.hpp"
#include "coupler/plot/scene.hpp"

#include <memory>
#include <string>
#include <vector>

namespace strake::picture {

/// Draws in pixels, y downwards, and becomes a PNG or an SVG. Only canvas.cpp uses Cairo.
class Canvas {
 public:
  enum class Kind { png, svg };
  /// ratio: pixels of a PNG per unit of the drawing, so that the same drawing is sharp on fine screens.
  Canvas(Kind, int width, int height, double ratio = 1);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void fill_rectangle(double x, double y, double width, double height, const Colour&);
  void dot(double x, double y, double radius, const Colour&);
  void square(double x, double y, double half, const Colour&);
  /// Edges in the colour of the inside, so that neighbours leave no gap.
  void polygon(const std::vector<Place>& corner, const Colour&);
  void line(const std::vector<Place>&, double width, const Colour&);
  /// dashes: lengths drawn and left out in turn; empty: a whole line.
  void curve(const std::vector<Place>&, double width, const Colour&, const std::vector<double>& dashes = {});
  void ring(double x, double y, double radius, double width, const Colour&);
  enum class Align { left, centre, right };
  /// y is the base line.
  void text(double x, double y, const std::string&, double size, Align = Align::left, bool bold = false);
  /// Centred at (x, y), read from below.
  void text_upwards(double x, double y, const std::string&, double size);
  double text_width(const std::string&, double size, bool bold = false);
  /// What follows shows inside this rectangle only, until `unclip`.
  void clip(double x, double y, double width, double height);
  void unclip();
  /// Draws what follows as one image even in an SVG, until `end_image`. A hundred thousand dots are too many
  /// for elements of their own.
  void begin_image(double x, double y, double width, double height);
  void end_image();

  /// The bytes of the file; draw nothing after it.
  std::string finish();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace strake::picture
