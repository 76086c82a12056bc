// Scenes of rigid bodies and of water alone. Elastic ones: elastic_scenes.cpp.

#include "coupler/new_case/scenes.hpp"

#include "coupler/new_case/case_lines.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake {

void put_wide_tank(NewScene& s, double width, double depth, double above) {
  s.right = s.water_right = s.whole(2 * width);
  s.left = -s.right;
  s.bottom = -s.whole(depth);
  s.top = s.whole(above);
}

CaseLines rigid_body(const NewAnswers& answers, int dimension) {
  CaseLines lines;
  lines.table("[structure]")
      .text("solver", "rigid", "rigid | replay | none, or the path of a program")
      .key("velocity", toml_vector(0, -answers.value("speed")), "m/s, at the start");
  if (const double mass = answers.value("mass"); mass > 0)
    lines.number("mass", mass, dimension == 2 ? "kg, per metre of depth" : "kg")
        .key("free", "{ y = true }", "true: the loads move the body along y, up and down");
  return lines;
}

std::string motion_words(const NewAnswers& answers) {
  const double mass = answers.value("mass"), speed = answers.value("speed");
  return mass > 0 ? fmt::format("of {:g} kg, free to heave, meets still water at {:g} m/s", mass, speed)
                  : fmt::format("driven into still water at {:g} m/s", speed);
}

double round_number(double x) {
  const double power = std::pow(10, std::floor(std::log10(x) + 1e-9));
  double best = power;
  for (const double digit : {2.0, 2.5, 4.0, 5.0})
    if (digit * power <= x * (1 + 1e-9)) best = digit * power;
  return best;
}

double two_digits(double x) {
  const double unit = std::pow(10, std::floor(std::log10(x)) - 1);
  return std::ceil(x / unit - 1e-9) * unit;
}

void check_height(double width, double height) {
  constexpr double most = 10;
  if (height <= most * width && height >= width / most) return;
  throw Error(
      ExitCode::command_line, fmt::format("--height {:g}", height),
      fmt::format("expected {:g} to {:g} m: a tenth of the width to ten widths", width / most, most * width),
      fmt::format("--height {:g}, or another --width", width));
}

double chosen_spacing(const NewAnswers& answers, const std::string& name, double length, double parts) {
  return chosen_spacing_or(round_number(length / parts), answers, name, length);
}

double chosen_spacing_or(double otherwise, const NewAnswers& answers, const std::string& name,
                         double length) {
  const double given = answers.value("spacing");
  if (given == 0) return otherwise;
  if (given > length / 10 || given < length / 1000)
    throw Error(ExitCode::command_line, fmt::format("--spacing {:g}", given),
                fmt::format("expected {:g} to {:g} m: a thousandth to a tenth of the {}, {:g} m",
                            length / 1000, length / 10, name, length),
                fmt::format("--spacing {:g}, or leave it out", otherwise));
  return given;
}

NewScene wedge_scene(const NewAnswers& answers) {
  const double width = answers.value("width"), angle = answers.value("angle"), speed = answers.value("speed");
  NewScene s;
  s.title = "wedge entry";
  s.physics = fmt::format("Rigid wedge of {:g} degrees deadrise, {}, 2-D.", angle, motion_words(answers));
  s.spacing = chosen_spacing(answers, "width", width, 100);
  const double gap = rigid_gap * s.spacing;
  const double chine = 0.5 * width * std::tan(angle * std::numbers::pi / 180);  // [m] above the apex
  put_wide_tank(s, width, 1.5 * width, chine + 0.75 * width);
  // Wagner's rise of the water: the chines are wet when the apex is 2/pi of their height deep.
  s.end_time = 1.1 * (gap + 2 / std::numbers::pi * chine) / speed;
  s.end_reason = "the water has reached the chines";
  CaseLines lines = rigid_body(answers, 2);
  lines.table("[structure.wedge]")
      .number("deadrise", angle, "deg, of the faces against the horizontal")
      .number("width", width, "m, between the chines")
      .key("apex", toml_vector(0, gap), "m, lowest point: a gap of 0.6 spacings above the water");
  s.body = lines.str();
  return s;
}

namespace {

NewScene round_scene(const NewAnswers& answers, const std::string& name, int dimension, double parts) {
  const double radius = answers.value("radius"), speed = answers.value("speed");
  NewScene s;
  s.dimension = dimension;
  s.title = name + " entry";
  s.physics =
      fmt::format("Rigid {} of {:g} m radius, {}, {}-D.", name, radius, motion_words(answers), dimension);
  s.spacing = chosen_spacing(answers, "radius", radius, parts);
  constexpr double resolved_3d = 17;  // spacings on a radius: twelve on the wetted radius at the run's end
  if (dimension == 3 && s.spacing > radius / resolved_3d)
    s.spacing_limit = fmt::format(": too few for forces, {:.2g} for some 15 %", radius / resolved_3d);
  const double gap = rigid_gap * s.spacing;
  if (dimension == 2)
    put_wide_tank(s, 3 * radius, 4 * radius, 3 * radius);
  else
    put_wide_tank(s, 1.25 * radius, 1.25 * radius, 2.5 * radius);
  s.back = s.left;
  s.front = s.right;
  s.end_time = (gap + (dimension == 2 ? 0.5 : 0.2) * radius) / speed;
  s.end_reason = dimension == 2 ? "the body is half a radius deep" : "the body is a fifth of its radius deep";
  CaseLines lines = rigid_body(answers, dimension);
  lines.table("[structure." + name + "]")
      .number("radius", radius, "m")
      .key("centre", toml_vector(0, radius + gap), "m: a gap of 0.6 spacings above the water");
  s.body = lines.str();
  return s;
}

}  // namespace

NewScene cylinder_scene(const NewAnswers& answers) {
  return round_scene(answers, "cylinder", 2, 20);
}

NewScene sphere_scene(const NewAnswers& answers) {
  return round_scene(answers, "sphere", 3, 10);
}

// The box floats with half its height in the water: m = ρ w²/2. It begins w/20 higher. Its heave, with an
// added mass of about half its own and the springs' part left out, has the period 2π √(1.5 m/(ρ g w)).
NewScene moored_scene(const NewAnswers& answers) {
  const double width = answers.value("width"), density = 1000, gravity = 9.81;
  NewScene s;
  s.title = "moored box";
  s.physics =
      fmt::format("Rigid box of {:g} m between two springs of {:g} N/m, let go a little too high, 2-D.",
                  width, answers.value("stiffness"));
  s.spacing = chosen_spacing(answers, "box's width", width, 20);
  put_wide_tank(s, 2 * width, 1.5 * width, width);
  s.submerged = true;
  const double raised = s.spacing * std::round(width / 20 / s.spacing);
  const double bottom = raised - s.spacing * std::round(0.5 * width / s.spacing);
  s.end_time = 4 * std::numbers::pi * std::sqrt(0.75 * width / gravity);
  s.end_reason = "about two periods of its heave";
  CaseLines lines;
  lines.table("[structure]")
      .text("solver", "rigid", "rigid | replay | none, or the path of a program")
      .number("mass", 0.5 * density * width * width, "kg, per metre of depth: half of the box in the water")
      .key("free", "{ x = true, y = true }", "true: the loads move the body along x and y");
  lines.table("[structure.plate]")
      .number("length", width, "m, along x")
      .number("thickness", width, "m, along y")
      .key("bottom", toml_vector(0, bottom), "m, middle of the lower face at the start");
  lines.table("[[attachments]]")
      .text("name", "mooring", "of its columns in history.csv")
      .key("at", fmt::format("[{}, {}]", toml_vector(-0.5 * width, bottom), toml_vector(0.5 * width, bottom)),
           "m, on the surface at the start")
      .text("solver", "spring", "spring | catenary | fmu, or the path of a program");
  lines.table("[attachments.spring]")
      .key("anchor",
           fmt::format("[{}, {}]", toml_vector(-1.5 * width, bottom), toml_vector(1.5 * width, bottom)),
           "m, the fixed ends")
      .number("stiffness", answers.value("stiffness"), "N/m, per metre of depth")
      .number("damping", 0, "N s/m, along each line");
  s.body = lines.str();
  return s;
}

NewScene dam_scene(const NewAnswers& answers) {
  const double width = answers.value("width"), height = answers.value("height");
  check_height(width, height);
  NewScene s;
  s.title = "dam break";
  s.physics = fmt::format("Column of water {:g} m wide and {:g} m high that collapses over a dry floor, 2-D.",
                          width, height);
  s.spacing = chosen_spacing(answers, "column's width", std::min(width, height), 40);
  s.right = s.whole(4 * width);
  s.water_right = s.whole(width);
  s.surface = s.whole(height);
  s.top = s.surface + s.whole(std::max(width, height));
  // Time in which the front crosses the floor, from experiments: T = t sqrt(2 g/L) = 3.2.
  s.end_time = 3.2 * std::sqrt(width / (2 * 9.81));
  s.end_reason = "the front is at the far wall";
  CaseLines lines;
  lines.table("[structure]").text("solver", "none", "there is no body");
  lines.table("[[output.probe]]")
      .text("name", "front", "of the probe's column in history.csv")
      .text("of", "fluid", "fluid | structure")
      .key("at", toml_vector(0, 0), "m, on the floor under the column")
      .text("quantity", "front", "x in m where the water on the floor ends");
  s.body = lines.str();
  return s;
}

namespace {

constexpr double wall_rows = 4;  // of particles in walls and floor, as fluid.scheme has them by default
// Particles of a case in space, at most: some two minutes of two cores up to the time that is written.
constexpr double most_particles = 100'000;

}  // namespace

// Volumes over l0^d. The tank's walls and floor are boxes less what they enclose; above it is open.
double particles_of(const NewScene& s) {
  const double l0 = s.spacing, thick = 2 * wall_rows;
  const double nx = (s.right - s.left) / l0, ny = (s.top - s.bottom) / l0;
  const double wet = (s.water_right - s.left) / l0 * (s.surface - s.bottom) / l0;
  if (s.dimension == 2) return wet + (nx + thick) * (ny + wall_rows) - nx * ny;
  const double nz = (s.front - s.back) / l0;
  return wet * nz + (nx + thick) * (ny + wall_rows) * (nz + thick) - nx * ny * nz;
}

double spacing_in_space(const NewScene& scene) {
  NewScene s = scene;
  double coarse = std::max({s.right - s.left, s.front - s.back, s.top - s.bottom}), fine = 1e-4 * coarse;
  constexpr int halvings = 60;
  for (int k = 0; k < halvings; ++k) {
    s.spacing = 0.5 * (fine + coarse);
    (particles_of(s) > most_particles ? fine : coarse) = s.spacing;
  }
  return two_digits(coarse);
}

// The number of steps grows as the spacing shrinks, so half of it costs two times the particles' part.
std::string cost_of_half(const NewScene& s) {
  NewScene half = s;
  half.spacing = 0.5 * s.spacing;
  const double more = particles_of(half) / particles_of(s);
  return fmt::format("{:.2g} times the particles, {:.2g} times the time", more, 2 * more);
}

}  // namespace strake
