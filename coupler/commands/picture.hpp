#pragma once

#include "proto/error.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace strake {

class StopRequest;

/// What `picture` and `film` have in common.
struct PictureOptions {
  std::filesystem::path run, out;  // out: .png or .svg; empty: RUN/<field>.png, of a film RUN/<field>.mp4
  std::optional<double> at;        // [s]; none: the last frame
  std::string field = "pressure";
  std::string size, view, range;  // "1280x720", "x0,y0,x1,y1" [m], "lo,hi"; empty: the run's own
  double scale = 1;
};
/// Draws one frame of a run.
ExitCode draw_picture(const PictureOptions&);

struct FilmOptions {
  PictureOptions picture;
  int frames_per_second = 25;
  std::optional<double> from, to;  // [s]
};
/// Draws all frames between two times in the same colours and view, and has ffmpeg make a film of them.
ExitCode make_film(const FilmOptions&, const StopRequest&);

}  // namespace strake
