#pragma once

#include "coupler/plot/colour_map.hpp"
#include "coupler/plot/scene.hpp"

#include <string>
#include <vector>

namespace strake::picture {

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

}  // namespace strake::picture
