#pragma once

#include "coupler/plot/scene.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

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

enum class Align { left, centre, right, upwards };  // upwards: centred, read from below

/// How a line is drawn. A page takes the name, as the class of its style sheet; a file takes the rest.
struct Style {
  std::string name = {};
  Colour colour = {};
  double width = 1;                 // [px]
  std::vector<double> dashes = {};  // lengths drawn and left out in turn; empty: a whole line
  bool filled = false;              // the inside instead of the line
};

/// What curves are drawn on: a picture file, or a figure of a page. In pixels, y downwards.
class Sheet {
 public:
  Sheet() = default;
  virtual ~Sheet() = default;
  Sheet(const Sheet&) = delete;
  Sheet& operator=(const Sheet&) = delete;
  /// title: what a page shows of the line where the pointer rests on it.
  virtual void path(const std::vector<Place>&, const Style&, const std::string& title = {}) = 0;
  virtual void circle(const Place&, double radius, const Style&) = 0;
  /// y is the base line.
  virtual void text(double x, double y, const std::string&, double size, Align = Align::left,
                    bool bold = false) = 0;
  virtual double text_width(const std::string&, double size, bool bold = false) = 0;
  /// What follows shows inside this rectangle only, until `unclip`.
  virtual void clip(double x, double y, double width, double height) = 0;
  virtual void unclip() = 0;
};

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

/// The kind of a picture file by its ending. Throws Error(command_line) for `option` with the file; `what`:
/// "a picture", `fix`: what to type.
Canvas::Kind kind_of(const std::filesystem::path&, const std::string& option, const std::string& what,
                     const std::string& fix);

/// A figure of a page: inline SVG that the page's style sheet colours, so that it is dark on a dark page.
class PageCanvas final : public Sheet {
 public:
  PageCanvas(double width, double height) : width_(width), height_(height) {}
  void path(const std::vector<Place>&, const Style&, const std::string& title = {}) override;
  void circle(const Place&, double radius, const Style&) override;
  void text(double x, double y, const std::string&, double size, Align = Align::left,
            bool bold = false) override;
  double text_width(const std::string&, double size, bool bold = false) override;
  void clip(double x, double y, double width, double height) override;
  void unclip() override;

  /// Several lines as one shape, so that one inside another is a hole.
  void shape(const std::vector<std::vector<Place>>&, const std::string& style, bool closed);
  /// The element. kind: its class; label: its words for who does not see it; empty: it is an ornament.
  std::string svg(const std::string& kind, const std::string& label = {}) const;

 private:
  double width_, height_;
  std::string content_;
};

}  // namespace strake::picture
