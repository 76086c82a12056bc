#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "proto/error.hpp"

namespace strake {

struct PictureOptions {
  std::filesystem::path run, out;  // out: .png or .svg; empty: RUN/<field>.png
  std::optional<double> at;        // [s]; none: the last frame
  std::string field = "pressure";
  std::string size, view, range;  // "1280x720", "x0,y0,x1,y1" [m], "lo,hi"; empty: as the run asks for
  double scale = 1;
};
/// Draws one frame of a run.
ExitCode draw_picture(const PictureOptions&);

}  // namespace strake
