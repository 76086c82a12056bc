// Scenes of bodies that deform: a plate, a box.
#include "coupler/new_case/case_lines.hpp"
#include "coupler/new_case/scenes.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake {
namespace {

constexpr double steel_density = 7800, steel_young = 2.1e11, steel_poisson = 0.3;  // [kg/m^3], [Pa], [1]
constexpr double level_gap = 1.2;  // air under the level face at the start [spacing]
// Particles through the thickness: at least four, and the largest number that is tried.
constexpr int fewest_layers = 4, most_layers = 40;

/// Distance of the structure's particles: a part of the thickness that divides the other lengths as well.
double lattice_spacing(double thickness, const std::vector<double>& lengths, bool needed) {
  for (int layers = fewest_layers; layers <= most_layers; ++layers) {
    const double d = thickness / layers;
    const bool fits = std::all_of(lengths.begin(), lengths.end(), [d](double length) {
      return std::abs(length / d - std::round(length / d)) < 1e-7 * length / d;
    });
    if (fits) return d;
  }
  if (needed)
    throw Error(
        ExitCode::command_line, "--solver particle",
        fmt::format("expected lengths that are multiples of thickness/4 to thickness/{}: a lattice of "
                    "particles fills the body",
                    most_layers),
        "change --thickness, or --solver fem");
  return thickness / fewest_layers;
}

/// First period in water of a strip with clamped ends [s]. It follows from the dry one and a flat plate's
/// added mass.
double wet_period(double span, double thickness) {
  const double clamped = 22.373;  // (k L)^2 of the first mode
  const double wave = std::sqrt(steel_young * thickness * thickness /
                                (12 * steel_density * (1 - steel_poisson * steel_poisson)));
  const double dry = 2 * std::numbers::pi * span * span / (clamped * wave);
  return dry * std::sqrt(1 + 0.35 * 1000 * span / (steel_density * thickness));
}

void put_plate_tank(NewScene& s, double width, double above) {
  put_wide_tank(s, 1.25 * width, 1.25 * width, 1.25 * width + above);
}

CaseLines driven_body(const NewAnswers& answers, const std::string& held) {
  CaseLines lines;
  lines.table("[structure]")
      .text("solver", answers.solver, "fem | particle | ccx | rigid, or the path of a program")
      .key("velocity", toml_vector(0, -answers.value("speed")), "m/s, of the " + held);
  return lines;
}

/// One body of a case: its table, its name in probes, what stands before the names of its probes, and where.
struct Named {
  std::string table = "structure", name = "structure", before;
  double x = 0;  // [m] of its middle
};

/// Material and lattice of a steel body.
void put_steel(CaseLines& lines, double lattice, const Named& body = {}) {
  lines.table("[" + body.table + ".material]")
      .text("model", "saint_venant_kirchhoff", "for large deflections; linear: for small ones")
      .number("density", steel_density, "kg/m^3")
      .number("young", steel_young, "Pa, Young's modulus")
      .number("poisson", steel_poisson, "1, Poisson's ratio");
  lines.table("[" + body.table + ".particle]")
      .number("spacing", lattice, "m, of its particles where solver = \"particle\"");
}

/// Probes at the middle of a lower face that lies `bottom` above the water.
void put_probes(CaseLines& lines, double bottom, double diameter, const Named& body = {}) {
  lines.table("[[output.probe]]")
      .text("name", body.before + "mid", "of the probe's columns in history.csv")
      .text("of", body.name, body.before.empty() ? "fluid | structure" : "fluid, or the name of a body")
      .key("at", toml_vector(body.x, bottom), "m, at the start")
      .text("quantity", "deflection", "m, displacement less that of the supports");
  lines.table("[[output.probe]]")
      .text("name", "p_" + body.before + "mid", "of the probe's column in history.csv")
      .text("of", "fluid", body.before.empty() ? "fluid | structure" : "fluid, or the name of a body")
      .key("at", toml_vector(body.x, bottom), "m, at the start; the sensor moves with the body")
      .text("quantity", "pressure", "Pa, mean over the sensor")
      .number("diameter", diameter, "m, of the sensor");
}

}  // namespace

NewScene plate_scene(const NewAnswers& answers) {
  const double length = answers.value("length"), thickness = answers.value("thickness");
  const double speed = answers.value("speed");
  if (thickness > 0.25 * length)
    throw Error(ExitCode::command_line, fmt::format("--thickness {:g}", thickness),
                fmt::format("expected at most a quarter of the length, {:g} m", 0.25 * length),
                fmt::format("--thickness {:g}", 0.05 * length));
  NewScene s;
  s.title = "plate entry";
  s.physics =
      fmt::format("Steel plate {:g} m long and {:g} m thick, driven flat into still water at {:g} m/s, 2-D.",
                  length, thickness, speed);
  s.spacing = chosen_spacing(answers, "length", length, 40);
  const double gap = level_gap * s.spacing;
  put_plate_tank(s, length, thickness);
  s.end_time = std::min(gap / speed + 2 * wet_period(length, thickness), (gap + 0.25 * length) / speed);
  s.end_reason = "two periods of the plate in water at most";
  CaseLines lines = driven_body(answers, "supports");
  lines.table("[structure.plate]")
      .number("length", length, "m")
      .number("thickness", thickness, "m")
      .key("bottom", toml_vector(0, gap), "m, middle of the lower face: a gap of 1.2 spacings")
      .key("supports", "{ left = \"clamped\", right = \"clamped\" }", "clamped | pinned | free");
  put_steel(lines, lattice_spacing(thickness, {length}, answers.solver == "particle"));
  put_probes(lines, gap, 2 * s.spacing);
  s.body = lines.str();
  return s;
}

NewScene bodies_scene(const NewAnswers& answers) {
  NewScene s = plate_scene(answers);  // its spacing, depth and times are those of one plate
  const double length = answers.value("length"), thickness = answers.value("thickness"),
               distance = answers.value("distance"), gap = level_gap * s.spacing;
  if (distance < 4 * s.spacing)
    throw Error(ExitCode::command_line, fmt::format("--distance {:g}", distance),
                fmt::format("expected at least four spacings of the water, {:g} m", 4 * s.spacing),
                fmt::format("--distance {:g}, or a smaller --spacing", 4 * s.spacing));
  s.title = "entry of two plates";
  s.physics = fmt::format(
      "Two steel plates {:g} m long and {:g} m thick, {:g} m apart, driven flat into still water at {:g} "
      "m/s, "
      "2-D.",
      length, thickness, distance, answers.value("speed"));
  const double middle = 0.5 * (length + distance), wall = s.whole(middle + 2.5 * length);
  s.right = s.water_right = wall;
  s.left = -wall;
  CaseLines lines;
  const double lattice = lattice_spacing(thickness, {length}, answers.solver == "particle");
  const std::vector<Named> bodies = {{"structures", "left", "left_", -middle},
                                     {"structures", "right", "right_", middle}};
  for (const Named& body : bodies) {
    lines.table("[[structures]]")
        .text("name", body.name,
              "of this body, in probes, columns and --set structures." + body.name + ".KEY")
        .text("solver", answers.solver, "fem | particle | ccx | rigid, or the path of a program")
        .key("velocity", toml_vector(0, -answers.value("speed")), "m/s, of the supports");
    lines.table("[structures.plate]")
        .number("length", length, "m")
        .number("thickness", thickness, "m")
        .key("bottom", toml_vector(body.x, gap), "m, middle of the lower face: a gap of 1.2 spacings")
        .key("supports", "{ left = \"clamped\", right = \"clamped\" }", "clamped | pinned | free");
    put_steel(lines, lattice, body);
  }
  for (const Named& body : bodies) put_probes(lines, gap, 2 * s.spacing, body);
  s.body = lines.str();
  return s;
}

NewScene box_scene(const NewAnswers& answers) {
  const double width = answers.value("width"), height = answers.value("height");
  const double thickness = answers.value("thickness"), speed = answers.value("speed");
  const double side = 0.1 * width, half = 0.5 * width;
  check_height(width, height);
  if (thickness > 0.25 * std::min(height, width))
    throw Error(
        ExitCode::command_line, fmt::format("--thickness {:g}", thickness),
        fmt::format("expected at most a quarter of width and height, {:g} m", 0.25 * std::min(height, width)),
        fmt::format("--thickness {:g}", 0.125 * std::min(height, width)));
  NewScene s;
  s.title = "box entry";
  s.physics = fmt::format(
      "Steel box {:g} m wide and {:g} m high, its bottom {:g} m thick, driven flat into still water at {:g} "
      "m/s, 2-D.",
      width, height, thickness, speed);
  s.spacing = chosen_spacing(answers, "width", width, 60);
  const double gap = level_gap * s.spacing;
  put_plate_tank(s, width, height);
  s.end_time =
      std::min(gap / speed + 2 * wet_period(width - 2 * side, thickness), (gap + 0.75 * height) / speed);
  s.end_reason = "two periods of the bottom in water at most";
  CaseLines lines = driven_body(answers, "sides, which are rigid");
  const auto part = [&](const char* name, double x0, double y0, double x1, double y1, bool held) {
    lines.table("[[structure.box]]")
        .text("name", name, "of this part")
        .key("min", toml_vector(x0, y0), "m, lower left corner")
        .key("max", toml_vector(x1, y1), "m, upper right corner");
    if (held) lines.key("supports", "{ all = true }", "true: all of it moves with structure.velocity");
  };
  part("left", -half, gap, side - half, gap + height, true);
  part("right", half - side, gap, half, gap + height, true);
  part("bottom", side - half, gap, half - side, gap + thickness, false);
  part("deck", side - half, gap + height - thickness, half - side, gap + height, false);
  put_steel(lines,
            lattice_spacing(thickness, {side, width - 2 * side, height}, answers.solver == "particle"));
  put_probes(lines, gap, 2 * s.spacing);
  s.body = lines.str();
  return s;
}

}  // namespace strake
