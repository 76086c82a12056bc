#include "fluid/case/tank_keys.hpp"

#include "fluid/boundary/fill.hpp"
#include "proto/files/motion_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <numbers>

namespace strake::fluid {
namespace {

using Shape = std::vector<Eigen::Vector3d>;
constexpr double degree = std::numbers::pi / 180;  // [rad]

void read_shape(CaseTable& t, Parameters& p) {
  t.points("tank_polygon", p.tank_polygon,
           {.unit = "m",
            .help = "2-D, in place of tank: corners of the inner faces, counter-clockwise; where "
                    "open_top is true the first and the last are the rim"});
  t.box("tank", p.tank,
        {.unit = "m",
         .required = p.tank_polygon.empty(),
         .unless = {"tank_polygon"},
         .help = "inner faces of the tank, a box"});
  t.flag("open_top", p.open_top,
         {.help = "a box without lid; a polygon without wall from its last corner to its first"});
  if (p.tank_polygon.empty()) return;
  if (p.dimension != 2)
    throw t.error("tank_polygon", "a box in three dimensions", "fluid.tank = [[...], [...]]");
  if (t.has("tank")) throw t.error("tank_polygon", "tank or tank_polygon, not both", "leave one of them out");
  p.tank = bounds(p.tank_polygon);
}

/// Reads fluid.water, fluid.water_polygon, and any number of [[fluid.more_water]].
void read_water_shapes(CaseTable& t, Parameters& p) {
  const bool has_more = t.has("more_water");
  Shape polygon;
  t.points("water_polygon", polygon, {.unit = "m", .help = "2-D, in place of water: its corners"});
  t.box("water", p.water,
        {.unit = "m",
         .required = polygon.empty() && !has_more,
         .unless = {"water_polygon", "more_water"},
         .help = "the water at the start, a box inside the tank"});
  if (t.has("water")) p.water_shapes.push_back({p.water.min, p.water.max});
  if (!polygon.empty()) p.water_shapes.push_back(polygon);
  for (CaseTable more : t.tables("more_water", "more water at the start, beside fluid.water")) {
    Box box;
    Shape corners;
    more.box("box", box, {.unit = "m", .help = "as fluid.water"});
    more.points("polygon", corners, {.unit = "m", .help = "as fluid.water_polygon"});
    if (more.has("box")) p.water_shapes.push_back({box.min, box.max});
    if (!corners.empty()) p.water_shapes.push_back(corners);
  }
  t.flag("submerged", p.submerged,
         {.help = "the water gives way to a body that stands in it at the start; false: that is an error"});
  if (p.water_shapes.empty()) return;
  p.water = bounds(p.water_shapes.front());
  for (const Shape& shape : p.water_shapes) {
    if (shape.size() > 2 && p.dimension != 2)
      throw t.error("water_polygon", "boxes in three dimensions", "fluid.water = [[...], [...]]");
    const Box part = bounds(shape);
    p.water.min = p.water.min.cwiseMin(part.min);
    p.water.max = p.water.max.cwiseMax(part.max);
  }
}

/// Reads the linear field of velocity at t = 0. Water does not expand: its divergence, the trace, is 0.
void read_initial_velocity(CaseTable t, Parameters& p) {
  constexpr double round_off = 1e-9;  // of the trace, over the largest entry
  InitialVelocity& initial = p.initial_velocity;
  Shape rows;
  t.vector("value", initial.value, {.unit = "m/s", .help = "in the origin of the case"});
  t.points("gradient", rows,
           {.unit = "1/s",
            .at_least = 2,
            .help = "grows by this per metre, [[du/dx, du/dy], [dv/dx, dv/dy]]; drop that is drawn out: "
                    "[[A, 0], [0, -A]], solid rotation: [[0, -w], [w, 0]]"});
  if (!rows.empty() && std::ssize(rows) != p.dimension)
    throw t.error("gradient", p.dimension == 2 ? "two rows of two numbers" : "three rows of three numbers",
                  p.dimension == 2 ? "gradient = [[1.0, 0.0], [0.0, -1.0]]"
                                   : "gradient = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.0]]");
  for (std::size_t i = 0; i < rows.size(); ++i)
    initial.gradient.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  if (p.dimension == 2 && (initial.value.z() != 0 || !initial.gradient.col(2).isZero(0)))
    throw t.error(initial.value.z() != 0 ? "value" : "gradient", "nothing along z in two dimensions",
                  "leave the third number out");
  const double trace = initial.gradient.trace(), largest = initial.gradient.cwiseAbs().maxCoeff();
  if (std::abs(trace) > round_off * largest)
    throw t.error("gradient",
                  fmt::format("du/dx + dv/dy{} = 0, not {:.6g} 1/s: water does not expand",
                              p.dimension == 3 ? " + dw/dz" : "", trace),
                  "change one of the diagonal");
  for (int d = 0; d < p.dimension; ++d)
    if (p.periodic[static_cast<std::size_t>(d)] && !initial.gradient.col(d).isZero(0))
      throw t.error("gradient", "nothing that grows along a periodic axis: both ends are one place",
                    "leave that axis out of fluid.periodic");
}

void read_periodic(CaseTable& t, Parameters& p) {
  std::vector<std::string> axes;
  t.texts("periodic", axes,
          {.help = "axes along which the tank repeats itself without walls: \"x\", \"y\", \"z\"; no body "
                   "goes over their ends"});
  for (const std::string& axis : axes) {
    const bool known = axis.size() == 1 && axis[0] >= 'x' && axis[0] < 'x' + p.dimension;
    if (!known)
      throw t.error("periodic",
                    p.dimension == 2 ? "a list of \"x\" and \"y\"" : "a list of \"x\", \"y\" and \"z\"",
                    "periodic = [\"x\"]");
    p.periodic[static_cast<std::size_t>(axis[0] - 'x')] = true;
  }
  if (!axes.empty() && !p.tank_polygon.empty())
    throw t.error("periodic", "a box as the tank: a polygon has no two sides that fit",
                  "fluid.tank = [[...], [...]]");
}

void read_absorbing(CaseTable& t, Parameters& p) {
  std::vector<std::string> walls;
  t.texts(
      "absorbing", walls,
      {.help =
           "walls that send no echo back, \"bottom\", \"sides\": they yield by (p - rho g depth)/(rho c); "
           "with least-squares and a finite sound_speed"});
  for (const std::string& wall : walls) {
    if (wall != "bottom" && wall != "sides")
      throw t.error("absorbing", "a list of \"bottom\" and \"sides\"", "absorbing = [\"bottom\", \"sides\"]");
    (wall == "bottom" ? p.absorbing_bottom : p.absorbing_sides) = true;
  }
  if (!walls.empty() && !std::isfinite(p.sound_speed))
    throw t.error("absorbing",
                  "nothing: incompressible water has no echo, and a wall that yields would let it out",
                  "leave absorbing out, or sound_speed = 1500");
}

void read_motion_keys(CaseTable t, const CommonKeys& common, Parameters& p) {
  TankMotion& m = p.motion;
  std::filesystem::path file;
  t.file("file", file,
         {.help = "table with columns t [s], x [m], y [m], angle [deg] (or vx [m/s], rate [deg/s])"});
  double amplitude = 0, roll = 0;
  Eigen::Vector3d direction{1, 0, 0};
  t.number("amplitude", amplitude, {.unit = "m", .min = 0, .help = "of a sine along direction; 0: none"});
  t.vector("direction", direction, {.help = "of the amplitude"});
  t.number("roll", roll,
           {.unit = "deg", .help = "amplitude of a sine of the angle about the pivot; 0: none"});
  t.number("frequency", m.frequency, {.unit = "Hz", .min = 0, .help = "of both sines"});
  t.number("ramp", m.ramp,
           {.unit = "s", .min = 0, .help = "the sines grow to their amplitude over this time"});
  t.vector("pivot", m.pivot, {.unit = "m", .help = "the tank turns about it; it moves along with the tank"});
  m.roll = roll * degree;
  if (amplitude > 0) {
    if (!(direction.norm() > 0))
      throw t.error("direction", "a direction that is not zero", "direction = [1, 0, 0]");
    m.amplitude = amplitude * direction.normalized();
  }
  if ((amplitude > 0 || roll != 0) && m.frequency == 0)
    throw t.error("frequency", "greater than 0 where there is an amplitude or roll", "frequency = 1.0");
  if (!file.empty()) {
    if (amplitude > 0 || roll != 0)
      throw t.error("file", "a table or a sine, not both", "leave out amplitude and roll, or file");
    m.table = read_motion(file);
    constexpr double none = 1e-9;
    const RigidMotion start = m.table->at(0);
    if (start.displacement.norm() > none || std::abs(start.angle) > none)
      throw t.error(
          "file",
          fmt::format("a table whose places are 0 at t = 0: {} starts at x = {:.6g}, y = {:.6g} m, "
                      "angle = {:.6g} deg",
                      file.string(), start.displacement.x(), start.displacement.y(), start.angle / degree),
          "the tank starts where fluid.tank has it: shift the table, or draw the tank turned");
    if (m.table->start() > 0 || m.table->end() < common.end_time * (1 - 1e-9))
      throw t.error("file",
                    fmt::format("a table from 0 to end_time = {:.6g} s: {} goes from {:.6g} to {:.6g} s",
                                common.end_time, file.string(), m.table->start(), m.table->end()),
                    "extend the table, or shorten the run");
  }
  if (!m.moves()) return;
  const bool around = p.periodic[0] || p.periodic[1] || p.periodic[2];
  if (around && m.turns())
    throw t.error("roll", "a tank that does not turn where it is periodic", "roll = 0, or no fluid.periodic");
}

}  // namespace

void read_tank(CaseTable t, const CommonKeys& common, Parameters& p) {
  p.end_time = common.end_time;
  read_shape(t, p);
  read_water_shapes(t, p);
  read_periodic(t, p);
  t.choice(
      "wall", p.wall, {{"free-slip", WallSlip::free_slip}, {"no-slip", WallSlip::no_slip}},
      {.paper = "no-slip",
       .help = "of tank and bodies for viscous stresses; no-slip with a turbulence model: where the boundary "
               "layer is thinner than spacing, friction by the law of the wall"});
  read_absorbing(t, p);
  read_initial_velocity(
      t.table("initial_velocity",
              "of the water at t = 0, beside the tank's; walls and bodies turn it in the first step"),
      p);
  read_motion_keys(t.table("motion", "how the tank moves: a table, or a sine; at rest where it is not given"),
                   common, p);
}

}  // namespace strake::fluid
