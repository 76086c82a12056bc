#include "coupler/new_case/kinds.hpp"

#include "coupler/new_case/scenes.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace strake {
namespace {

const std::vector<std::string> elastic = {"fem", "particle", "rigid"};

NewNumber speed(double value) {
  return {"speed", "m/s", "downwards, at the start", value, 0.01, 100};
}
NewNumber mass() {
  return {"mass",
          "kg",
          "free to heave with this mass, in the plane per metre of depth",
          0,
          1e-3,
          1e9,
          "driven at constant speed"};
}
NewNumber spacing(const std::string& follows) {
  return {"spacing", "m", "between particles of water", 0, 1e-5, 10, follows};
}
NewNumber length(const std::string& name, const std::string& help, double value) {
  return {name, "m", help, value, 1e-3, 1000};
}

NewKind mesh_kind() {
  return {"mesh",
          "rigid body from a mesh file (Gmsh .msh, Abaqus .inp, in space STL .stl), driven or falling into "
          "still "
          "water",
          {"rigid"},
          {speed(5),
           mass(),
           {"scale", "1", "factor on the lengths of the file: 0.001 for one in mm", 1, 1e-6, 1e6},
           spacing("width/80, in space what gives 100 000 particles")},
          true,
          mesh_scene};
}
NewKind moored_kind() {
  return {"moored",
          "rigid box that floats between two springs, let go a little too high",
          {"rigid"},
          {length("width", "of the box, and its height", 0.4),
           {"stiffness", "N/m", "of each spring, in the plane per metre of depth", 500, 0, 1e9},
           spacing("width/20")},
          false,
          moored_scene};
}

}  // namespace

const std::vector<NewKind>& new_kinds() {
  static const std::vector<NewKind> kinds = {
      {"plate",
       "elastic flat plate with clamped ends, driven into still water",
       elastic,
       {speed(6), length("length", "of the plate", 0.4), length("thickness", "of the plate", 0.02),
        spacing("length/40")},
       false,
       plate_scene},
      {"wedge",
       "rigid wedge, apex down, driven or falling into still water",
       {"rigid"},
       {{"angle", "deg", "deadrise, of the faces against the horizontal", 30, 4, 80},
        speed(5),
        length("width", "between the chines", 0.5),
        mass(),
        spacing("width/100")},
       false,
       wedge_scene},
      {"box",
       "steel box with an elastic bottom between rigid sides, driven into still water",
       elastic,
       {speed(6), length("width", "of the box", 0.3), length("height", "of the box", 0.08),
        length("thickness", "of bottom and deck", 0.01), spacing("width/60")},
       false,
       box_scene},
      {"bodies",
       "two elastic flat plates side by side, driven into one water; each has a solver of its own",
       elastic,
       {speed(6), length("length", "of each plate", 0.4), length("thickness", "of each plate", 0.02),
        length("distance", "between the plates", 0.4), spacing("length/40")},
       false,
       bodies_scene},
      {"cylinder",
       "rigid cylinder, its axis level, driven or falling into still water",
       {"rigid"},
       {speed(5), length("radius", "of the cylinder", 0.1), mass(), spacing("radius/20")},
       false,
       cylinder_scene},
      {"sphere",
       "rigid sphere in space, driven or falling into still water",
       {"rigid"},
       {speed(5), length("radius", "of the sphere", 0.2), mass(), spacing("radius/10")},
       false,
       sphere_scene},
      mesh_kind(),
      moored_kind(),
      {"dam",
       "column of water that collapses over a dry floor; no body",
       {},
       {length("width", "of the column", 0.146), length("height", "of the column", 0.292),
        spacing("width/40")},
       false,
       dam_scene}};
  return kinds;
}

std::string out_of_bounds(const NewNumber& number, double value) {
  if (value >= number.min && value <= number.max) return {};
  if (!number.follows.empty() && value == 0) return {};
  return fmt::format("expected {:g} to {:g}{}", number.min, number.max,
                     number.unit == "1" ? "" : " " + number.unit);
}

// 80 m: no ship is as wide, and no specimen. See size_warning for a body from a file.
std::string long_lengths(const NewKind& kind, const NewAnswers& answers) {
  constexpr double widest = 80;  // [m]
  for (const NewNumber& number : kind.numbers)
    if (const double x = answers.value(number.name);
        number.unit == "m" && number.name != "spacing" && x > widest)
      return fmt::format(
          "{} is {:g} m, more than any ship is wide. Lengths are in m: --{} {:g} if it was meant in mm.",
          number.name, x, number.name, 0.001 * x);
  return {};
}

NewAnswers complete(const NewKind& kind, NewAnswers given, const std::string& command) {
  for (const NewNumber& number : kind.numbers) {
    const auto at = given.number.try_emplace(number.name, number.value).first;
    if (const std::string problem = out_of_bounds(number, at->second); !problem.empty())
      throw Error(ExitCode::command_line, fmt::format("{} --{} {:g}", command, number.name, at->second),
                  problem + ": " + number.help,
                  number.follows.empty() ? fmt::format("--{} {:g} is the default", number.name, number.value)
                                         : fmt::format("left out it is {}", number.follows));
  }
  if (given.solver.empty() && !kind.solvers.empty()) given.solver = kind.solvers.front();
  if (kind.mesh && given.mesh.empty())
    throw Error(ExitCode::command_line, command, "needs a mesh file", command + " --mesh hull.msh");
  return given;
}

}  // namespace strake
