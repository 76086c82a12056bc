#pragma once

#include "coupler/plot/canvas.hpp"
#include "coupler/plot/scene.hpp"

#include <optional>
#include <string>

namespace strake::picture {

/// What part of the world is drawn.
struct View {
  double left = 0, low = 0, right = 1, high = 1;  // [m]
};

struct DrawingOptions {
  int width = 1120, height = 0;                   // [px]; height 0: as high as the view needs
  double ratio = 1;                               // pixels of a PNG per unit of width and height
  std::optional<View> view;                       // all of water and structure
  std::optional<Range> range;                     // of the named field; else the scene's own
  std::optional<Range> water_range, solid_range;  // of whatever they show
  std::string field;                              // whose colours `range` fixes
};

/// Draws a scene as the bytes of a PNG or SVG file. It shows particles and cells in the colours of their
/// fields, and walls. It adds axes in metres, colour bars with unit and range, title, time, section and scale
/// of deformation.
std::string draw(const Scene&, const DrawingOptions&, Canvas::Kind);

}  // namespace strake::picture
