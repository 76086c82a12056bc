#pragma once

#include "coupler/plot/sheet.hpp"

#include <memory>
#include <string>
#include <vector>

namespace strake::picture {

/// Draws in pixels, y downwards, and becomes a PNG or an SVG. Only canvas.cpp uses Cairo.
class Canvas final : public Sheet {
 public:
  enum class Kind { png, svg };
  /// ratio: pixels of a PNG per unit of the drawing, so that the same drawing is sharp on fine screens.
  Canvas(Kind, int width, int height, double ratio = 1);
  ~Canvas() override;

  void fill_rectangle(double x, double y, double width, double height, const Colour&);
  void dot(double x, double y, double radius, const Colour&);
  void square(double x, double y, double half, const Colour&);
  void path(const std::vector<Place>&, const Style&, const std::string& title = {}) override;
  void circle(const Place&, double radius, const Style&) override;
  void text(double x, double y, const std::string&, double size, Align = Align::left,
            bool bold = false) override;
  double text_width(const std::string&, double size, bool bold = false) override;
  void clip(double x, double y, double width, double height) override;
  void unclip() override;
  /// What follows is drawn as one image even in an SVG, until `end_image`: a hundred thousand dots are a
  /// picture, not text.
  void begin_image(double x, double y, double width, double height);
  void end_image();

  /// The bytes of the file; draw nothing after it.
  std::string finish();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace strake::picture
