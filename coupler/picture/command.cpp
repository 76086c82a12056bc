#include "coupler/picture/command.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "coupler/picture/drawing.hpp"
#include "proto/result_file.hpp"

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
    const auto size = numbers("--size", options.size, 2, 'x', "1280x720");
    if (size[0] < 320 || size[1] < 240 || size[0] > 16384 || size[1] > 16384)
      throw Error(ExitCode::command_line, "--size " + options.size,
                  "a picture has from 320x240 to 16384x16384 pixels", "--size 1280x720");
    drawing.width = static_cast<int>(size[0]);
    drawing.height = static_cast<int>(size[1]);
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

}  // namespace

ExitCode draw_picture(const PictureOptions& options) {
  const std::filesystem::path out =
      options.out.empty() ? options.run / (options.field + ".png") : options.out;
  const std::string kind = out.extension().string();
  if (kind != ".png" && kind != ".svg")
    throw Error(ExitCode::command_line, "-o " + out.string(), "a picture is a .png or an .svg",
                "-o picture.png");
  const picture::DrawingOptions drawing = drawing_of(options);
  picture::SceneOptions wanted = {.field = options.field, .scale = options.scale};
  if (options.at) wanted.time = *options.at;
  const picture::Scene scene = picture::read_scene(options.run, wanted);
  write_text(out, picture::draw(scene, drawing,
                                kind == ".png" ? picture::Canvas::Kind::png : picture::Canvas::Kind::svg));
  fmt::print("{}: the frame at {:.6g} s, {} particles of water{}\n", out.string(), scene.time,
             scene.water.size(), scene.cut.empty() ? "" : ", " + scene.cut);
  return ExitCode::done;
}

}  // namespace strake
