#include "coupler/commands/commands.hpp"
#include "coupler/console/console.hpp"
#include "coupler/participant/stop_request.hpp"
#include "coupler/plot/drawing.hpp"
#include "coupler/plot/encoder.hpp"
#include "coupler/plot/ticks.hpp"
#include "proto/files/frame_file.hpp"
#include "proto/files/result_file.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace strake {
namespace {

/// "0,-0.5,1,0.5" → four numbers.
std::vector<double> numbers(const std::string& option, const std::string& text, std::size_t count,
                            char between, const std::string& example) {
  std::vector<double> values;
  const char* at = text.c_str();
  while (values.size() < count) {
    char* end = nullptr;
    values.push_back(std::strtod(at, &end));
    const bool last = values.size() == count;
    if (end == at || !std::isfinite(values.back()) || *end != (last ? '\0' : between))
      throw Error(ExitCode::command_line, option + " " + text, "is not of the form " + example,
                  option + " " + example);
    at = end + 1;
  }
  return values;
}

picture::DrawingOptions drawing_of(const PictureOptions& options) {
  picture::DrawingOptions drawing;
  drawing.field = options.field;
  if (!options.size.empty()) {
    const bool both = options.size.find('x') != std::string::npos;
    auto size = numbers("--size", options.size, both ? 2 : 1, 'x', "1280x720 or 1280");
    if (!both) size.push_back(240);  // as high as it takes
    if (size[0] < 320 || size[1] < 240 || size[0] > 16384 || size[1] > 16384)
      throw Error(ExitCode::command_line, "--size " + options.size,
                  "a picture has from 320x240 to 16384x16384 pixels", "--size 1280x720");
    drawing.width = static_cast<int>(size[0]);
    if (both) drawing.height = static_cast<int>(size[1]);
  }
  if (!options.view.empty()) {
    const auto v = numbers("--view", options.view, 4, ',', "-0.3,-0.2,0.3,0.1");
    if (!(v[0] < v[2] && v[1] < v[3]))
      throw Error(ExitCode::command_line, "--view " + options.view,
                  "the first corner is left of and below the second", "--view -0.3,-0.2,0.3,0.1");
    drawing.view = picture::View{v[0], v[1], v[2], v[3]};
  }
  if (!options.range.empty()) {
    const auto r = numbers("--range", options.range, 2, ',', "0,1e6");
    if (!(r[0] < r[1]))
      throw Error(ExitCode::command_line, "--range " + options.range, "the lower end comes first",
                  "--range 0,1e6");
    drawing.range = picture::Range{r[0], r[1]};
  }
  return drawing;
}

/// Sets colours and view of a whole film to the range of a few of its frames. The first and last are among
/// them.
void settle(const PictureOptions& options, const picture::RunFrames& run,
            const std::vector<FrameFile>& frames, picture::DrawingOptions& drawing, const StopRequest& stop) {
  constexpr std::size_t looked_at = 24;
  picture::Range water, solid, x, y;
  double spacing = 0;
  std::string water_name, solid_name;
  for (std::size_t k = 0; k < std::min(looked_at, frames.size()) && !stop.requested(); ++k) {
    const std::size_t of = frames.size() <= looked_at ? k : k * (frames.size() - 1) / (looked_at - 1);
    const picture::Scene scene =
        picture::read_scene(run, {.time = frames[of].time, .field = options.field, .scale = options.scale});
    water_name = scene.water_field.name;
    solid_name = scene.solid_field.name;
    water.add(scene.water_field.shown);
    solid.add(scene.solid_field.shown);
    x.add(scene.x);
    y.add(scene.y);
    spacing = std::max(scene.spacing, scene.solid_spacing);
  }
  // --range is of the named field; what the other side shows keeps its colours as well.
  if (!water.empty() && !(drawing.range && water_name == options.field)) drawing.water_range = water;
  if (!solid.empty() && !(drawing.range && solid_name == options.field)) drawing.solid_range = solid;
  if (drawing.view || x.empty()) return;
  const double room = std::max(0.02 * (x.hi - x.lo), 1.5 * spacing);
  drawing.view = picture::View{x.lo - room, y.lo - room, x.hi + room, y.hi + room};
}

}  // namespace

ExitCode draw_picture(const PictureOptions& options) {
  const std::filesystem::path out =
      options.out.empty() ? options.run / (options.field + ".png") : options.out;
  const picture::Canvas::Kind kind = picture::kind_of(out, "-o", "a picture", "picture.png");
  const picture::DrawingOptions drawing = drawing_of(options);
  picture::SceneOptions wanted = {.field = options.field, .scale = options.scale};
  if (options.at) wanted.time = *options.at;
  const picture::Scene scene = picture::read_scene(picture::find_frames(options.run), wanted);
  write_text(out, picture::draw(scene, drawing, kind));
  fmt::print("{}: the frame at {:.6g} s, {} particles of water{}\n", out.string(), scene.time,
             scene.water.size(), scene.cut.empty() ? "" : ", " + scene.cut);
  for (const std::string& note : scene.notes) fmt::print("  {}\n", visible(note));
  for (const picture::Quantity* of : {&scene.water_field, &scene.solid_field})
    if (!of->all.empty()) {
      const Prefix prefix = prefix_for(std::max(std::abs(of->all.lo), std::abs(of->all.hi)), of->unit);
      fmt::print("  {} of the {}: {:.4g} to {:.4g} {}\n", of->name,
                 of != &scene.water_field ? "structure"
                 : of->name == "gap"      ? "air"
                                          : "water",
                 prefix.factor * of->all.lo, prefix.factor * of->all.hi, with_prefix(prefix, of->unit));
      if (of == &scene.solid_field && scene.cells.empty())
        fmt::print("    at particles, half a spacing inside a face; a probe at the face extrapolates\n");
    }
  return ExitCode::done;
}

ExitCode make_film(const FilmOptions& options, const StopRequest& stop) {
  PictureOptions wanted = options.picture;
  if (wanted.out.empty()) wanted.out = wanted.run / (wanted.field + ".mp4");
  picture::DrawingOptions drawing = drawing_of(wanted);
  if (options.frames_per_second < 1 || options.frames_per_second > 120)
    throw Error(ExitCode::command_line, "--fps", "a film has from 1 to 120 frames in a second", "--fps 25");
  const picture::RunFrames run = picture::find_frames(wanted.run);
  std::vector<FrameFile> frames = run.fluid.empty() ? run.structure : run.fluid;
  std::erase_if(frames, [&](const FrameFile& frame) {
    return frame.time < options.from.value_or(-1) || frame.time > options.to.value_or(frame.time);
  });
  if (frames.empty())
    throw Error(ExitCode::command_line, "--from, --to", "there is no frame between them",
                fmt::format("the frames go from {:.6g} to {:.6g} s",
                            (run.fluid.empty() ? run.structure : run.fluid).front().time,
                            (run.fluid.empty() ? run.structure : run.fluid).back().time));
  picture::Encoder encoder(wanted.out, options.frames_per_second);
  settle(wanted, run, frames, drawing, stop);

  if (stop.requested()) return stop.code();

  const bool live = style_of(stdout).terminal;
  std::vector<std::string> notes;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (stop.requested()) {
      fmt::print(stderr, "{}{}: {}, no film is left\n", live ? "\r" : "", wanted.out.string(),
                 stop.in_words());
      return stop.code();
    }
    const picture::Scene scene =
        picture::read_scene(run, {.time = frames[k].time, .field = wanted.field, .scale = wanted.scale});
    encoder.add(picture::draw(scene, drawing, picture::Canvas::Kind::png));
    notes = scene.notes;
    if (live) fmt::print("\rframe {} of {}", k + 1, frames.size());
    if (live) std::fflush(stdout);
  }
  encoder.finish();
  fmt::print("{}{}: {} frames from {:.6g} to {:.6g} s, {} a second\n", live ? "\r" : "", wanted.out.string(),
             frames.size(), frames.front().time, frames.back().time, options.frames_per_second);
  for (const std::string& note : notes) fmt::print("  {}\n", visible(note));
  return ExitCode::done;
}

}  // namespace strake
