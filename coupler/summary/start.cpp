#include "coupler/summary/start.hpp"

#include "coupler/compare/compare_block.hpp"
#include "proto/error.hpp"
#include "proto/files/motion_file.hpp"
#include "proto/lookup.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

namespace strake {
namespace {

constexpr double no_height = std::numeric_limits<double>::infinity();

bool is_given(const CaseView& view, const std::string& key) {
  return !at_or(view.value, key).empty();
}

/// The table of a body in the case: "structure", or of several "structures.left".
std::string table_of(const CaseView& view, const std::string& name) {
  const bool one = view.structures.size() == 1 && !view.structures.front().is_body;
  return one ? "structure" : "structures." + name;
}

/// A body that its mesh file gives in millimetres.
void look_at_size(const CaseView& view, const BodyAtStart& body, std::vector<std::string>& lines) {
  const auto& [name, mesh] = body;
  const Eigen::Vector3d l = mesh->position.rowwise().maxCoeff() - mesh->position.rowwise().minCoeff();
  const std::string table = table_of(view, name);
  const std::string words = larger_than_ships({l[0], l[1], l[2]}, mesh->dimension,
                                              table == "structure" ? "the body" : "the body " + name);
  if (!words.empty())
    lines.push_back(words + ": lengths are in m" +
                    (is_given(view, table + ".mesh")
                         ? fmt::format("; {}.placed.scale = 0.001 is for a mesh in mm", table)
                         : ""));
}

/// Volume inside a closed surface, V = 1/d Σ x·n A over its faces; in the plane its area.
double volume_of(const InterfaceMesh& mesh) {
  double volume = 0;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const Eigen::Vector3d a = mesh.position.col(mesh.faces(0, f)), b = mesh.position.col(mesh.faces(1, f));
    volume += mesh.dimension == 2 ? a.cross(b).z() / 2
                                  : a.dot(b.cross(Eigen::Vector3d(mesh.position.col(mesh.faces(2, f))))) / 6;
  }
  return volume;
}

/// A free rigid body whose mass is in tonnes or grams, or whose centre of gravity is in the axes of its file.
void look_at_inertia(const CaseView& view, const BodyAtStart& body, std::vector<std::string>& lines) {
  constexpr double lightest = 20, heaviest = 2e4;  // [kg/m³] of a foam, of gold
  const auto& [name, mesh] = body;
  const std::string table = table_of(view, name);
  const auto free = [&](const char* key) { return at_or(view.value, table + ".free." + key) == "true"; };
  if (at_or(view.value, table + ".solver") != "rigid" ||
      !(free("x") || free("y") || free("z") || free("angle") || free("rotation")))
    return;
  const bool plane = mesh->dimension == 2, closed = at_or(view.value, table + ".loaded_faces") == "[]";
  const auto kilograms = [&](const char* key) { return view.number(table + key).value_or(0); };
  const double mass = kilograms(".mass") + kilograms(".lumped.mass"), volume = closed ? volume_of(*mesh) : 0;
  if (mass > 0 && volume > 0 && (mass / volume < lightest || mass / volume > heaviest))
    lines.push_back(fmt::format("{}.mass = {:.4g} kg in {:.3g} {} are {:.3g} kg/m^3, {}: masses are in kg{}",
                                table, mass, volume, plane ? "m^2" : "m^3", mass / volume,
                                mass / volume < lightest ? "lighter than foam" : "heavier than gold",
                                plane ? " per metre of depth" : ""));
  const std::vector<double> centre = numbers_in(at_or(view.value, table + ".centre_of_gravity"));
  const Eigen::Vector3d low = mesh->position.rowwise().minCoeff(), high = mesh->position.rowwise().maxCoeff();
  for (std::size_t d = 0; d < centre.size() && d < static_cast<std::size_t>(mesh->dimension); ++d) {
    const auto axis = static_cast<Eigen::Index>(d);
    if (centre[d] >= low[axis] && centre[d] <= high[axis]) continue;
    lines.push_back(
        fmt::format("{}.centre_of_gravity lies outside the body: {} = {:.4g} m, the body reaches from {:.4g} "
                    "to {:.4g} m; it is given where the body starts, after structure.placed",
                    table, "xyz"[d], centre[d], low[axis], high[axis]));
    break;
  }
}

/// A sine x = A sin 2πft has the speed 2πfA at t = 0. The water starts with it too, and not at rest.
void look_at_tank_start(const CaseView& view, std::vector<std::string>& lines) {
  const auto number = [&](const char* key) { return view.number(key).value_or(0); };
  const double frequency = number("fluid.motion.frequency"), omega = 2 * std::numbers::pi * frequency;
  if (!(frequency > 0) || number("fluid.motion.ramp") > 0 || is_given(view, "fluid.motion.file")) return;
  std::vector<std::string> speeds;
  if (const double speed = omega * number("fluid.motion.amplitude"); speed > 0)
    speeds.push_back(fmt::format("{:.3g} m/s", speed));
  if (const double rate = omega * number("fluid.motion.roll"); rate > 0)
    speeds.push_back(fmt::format("{:.3g} deg/s", rate));
  if (speeds.empty()) return;
  lines.push_back(fmt::format(
      "fluid.motion is a sine without ramp: tank and water start at {}, 2 pi f times the amplitude; "
      "with fluid.motion.ramp = {:.3g}, one period, they start at rest",
      joined(speeds, " and "), 1 / frequency));
}

/// Distance of the tank's farthest corner from the point about which it turns [m].
double reach_of_tank(const CaseView& view) {
  std::vector<double> pivot = numbers_in(at_or(view.value, "fluid.motion.pivot"));
  pivot.resize(2, 0);
  const bool is_box = is_given(view, "fluid.tank");
  const std::vector<double> n = numbers_in(at_or(view.value, is_box ? "fluid.tank" : "fluid.tank_polygon"));
  const std::size_t stride = is_box && n.size() == 6 ? 3 : 2;
  double x = 0, y = 0;  // a polygon lies in the box of its corners
  for (std::size_t k = 0; k + 1 < n.size(); k += stride) {
    x = std::max(x, std::abs(n[k] - pivot[0]));
    y = std::max(y, std::abs(n[k + 1] - pivot[1]));
  }
  return std::hypot(x, y);
}

/// An interval in which a table's speed changes fast.
struct Jump {
  double time = 0, lasts = 0, change = 0;  // [s], [s], [m/s]
};

/// The first interval in which a table's acceleration is above `largest` [m/s^2].
std::optional<Jump> first_jump(const MotionTable& table, double end, double reach, double largest) {
  const std::vector<double>& times = table.times();
  constexpr int parts = 4;  // between two rows a speed is a cubic at most
  const auto change = [&](const RigidMotion& a, const RigidMotion& b) {
    return (b.velocity - a.velocity).norm() + std::abs(b.angular_velocity - a.angular_velocity) * reach;
  };
  std::optional<double> since;
  double before = 0;
  for (std::size_t row = 0; row + 1 < times.size(); ++row)
    for (int part = 1; part <= parts; ++part) {
      const double t = times[row] + (times[row + 1] - times[row]) * part / parts;
      if (t <= 0) continue;
      const bool fast =
          t <= end && change(table.at(before), table.at(t)) > largest * (t - before) && t > before;
      if (fast && !since) since = before;
      if (!fast && since) return Jump{*since, before - *since, change(table.at(*since), table.at(before))};
      before = t;
    }
  if (!since) return std::nullopt;
  return Jump{*since, before - *since, change(table.at(*since), table.at(before))};
}

/// A table whose speed at t = 0 is not 0, with which the water starts too, and one whose speed jumps.
///
/// Water of length L under the acceleration a has the pressure ρ a L. It is told from 10 g on, by which tanks
/// are driven in shock tests alone: 1 m/s within 10 ms.
void look_at_tank_table(const CaseView& view, std::vector<std::string>& lines) {
  constexpr double largest = 98.1;   // [m/s^2]
  constexpr double at_start = 0.05;  // of the largest speed: below it is the end of a spline
  const std::string file = at_or(view.value, "fluid.motion.file");
  if (file.empty()) return;
  const MotionTable table = read_motion(view.folder / file);
  const double reach = reach_of_tank(view), end = std::min(table.end(), view.common.end_time);
  const RigidMotion start = table.at(0);
  if (const double speed = start.velocity.norm() + std::abs(start.angular_velocity) * reach;
      speed > at_start * table.largest_speed(end, reach))
    lines.push_back(fmt::format(
        "fluid.motion.file starts at {:.3g} m/s: tank and water start with that speed; for water at rest let "
        "the table begin with speed 0 and grow from there",
        speed));
  if (const auto jump = first_jump(table, end, reach, largest))
    lines.push_back(fmt::format(
        "fluid.motion.file: the tank's speed jumps by {:.3g} m/s at t = {:.6g} s, within {:.3g} s: the "
        "water's pressure is an impulse there, {:.3g} g on average; a change over {:.2g} s has 1 g",
        jump->change, jump->time, jump->lasts, jump->change / jump->lasts / 9.81, jump->change / 9.81));
}

/// The lowest height of a box or polygon of the case, "[[x, y, z], [x, y, z]]"; infinity where there is none.
double lowest_of(const CaseView& view, const std::string& key) {
  const std::vector<double> numbers = numbers_in(at_or(view.value, key));
  // A box has two corners, of two or three numbers; a polygon has corners of two.
  const std::size_t stride = numbers.size() == 6 && key.find("polygon") == std::string::npos ? 3 : 2;
  double lowest = no_height;
  for (std::size_t k = 1; k < numbers.size(); k += stride) lowest = std::min(lowest, numbers[k]);
  return lowest;
}

/// Water whose lower edge is above the floor of the tank, with no body below it: it falls.
void look_at_floor(const CaseView& view, const std::vector<BodyAtStart>& bodies,
                   std::vector<std::string>& lines) {
  const std::vector<double> gravity = numbers_in(at_or(view.value, "fluid.gravity"));
  const double l0 = view.number("fluid.spacing").value_or(0);
  if (gravity.size() < 2 || !(gravity[1] < 0) || is_given(view, "fluid.tank_polygon") ||
      at_or(view.value, "fluid.periodic").find("\"y\"") != std::string::npos)
    return;
  if (bodies.size() < view.structures.size()) return;  // what stands under the water is not known
  const double floor = lowest_of(view, "fluid.tank");
  double water = std::min(lowest_of(view, "fluid.water"), lowest_of(view, "fluid.water_polygon"));
  for (std::size_t k = 0;; ++k) {
    const std::string more = fmt::format("fluid.more_water[{}].", k);
    const double lowest = std::min(lowest_of(view, more + "box"), lowest_of(view, more + "polygon"));
    if (!std::isfinite(lowest)) break;
    water = std::min(water, lowest);
  }
  if (!std::isfinite(floor) || !std::isfinite(water) || !(water - floor > 0.5 * l0)) return;
  for (const auto& [name, mesh] : bodies)
    if (mesh->position.cols() > 0 && mesh->position.row(1).minCoeff() < water) return;
  lines.push_back(fmt::format(
      "the water starts {:.3g} m above the floor of the tank, which is at y = {:.6g} m, and falls",
      water - floor, floor));
}

/// A body that its constant speed drives to the floor of the tank before the run ends.
void look_at_way(const CaseView& view, const BodyAtStart& body, std::vector<std::string>& lines) {
  const auto& [name, mesh] = body;
  const std::string table = table_of(view, name);
  const std::vector<double> velocity = numbers_in(at_or(view.value, table + ".velocity"));
  if (velocity.size() < 2 || !(velocity[1] < 0) || at_or(view.value, table + ".free.y") == "true" ||
      is_given(view, "fluid.motion.file") ||
      at_or(view.value, "fluid.periodic").find("\"y\"") != std::string::npos)
    return;
  const double floor = std::min(lowest_of(view, "fluid.tank"), lowest_of(view, "fluid.tank_polygon")),
               reached = (floor - mesh->position.row(1).minCoeff()) / velocity[1];
  if (!std::isfinite(floor) || !(reached > 0) || !(reached < view.common.end_time)) return;
  // Boundary::check_place lets a body a spacing into a wall, where floors and gates rest.
  const double end = reached - view.number("fluid.spacing").value_or(0) / velocity[1];
  lines.push_back(fmt::format(
      "{}.velocity drives the body to the floor of the tank at t = {:.3g} s: loads after that are not to be "
      "used{}",
      table, reached,
      end < view.common.end_time ? fmt::format(", and the run ends a spacing deeper, at t = {:.3g} s", end)
                                 : ""));
}

}  // namespace

std::string larger_than_ships(std::array<double, 3> lengths, int dimension, const std::string& body) {
  constexpr std::array<double, 3> largest = {500, 80, 50};
  std::sort(lengths.begin(), lengths.end(), std::greater<>());
  const std::size_t first = dimension == 3 ? 0 : 1;
  for (std::size_t k = 0; k + first < largest.size(); ++k)
    if (lengths[k] > largest[k + first])
      return fmt::format("{} is {:.4g} m {}, larger than any ship", body, lengths[k],
                         k + first == 0 ? "long" : "across");
  return {};
}

std::vector<std::string> start_lines(const CaseView& view, const std::vector<BodyAtStart>& bodies) {
  std::vector<std::string> lines;
  if (!view.fluid || view.fluid->solver != "mps") return lines;
  for (const BodyAtStart& body : bodies) {
    if (body.second->position.cols() == 0) continue;
    look_at_size(view, body, lines);
    look_at_inertia(view, body, lines);
    look_at_way(view, body, lines);
  }
  look_at_tank_start(view, lines);
  look_at_tank_table(view, lines);
  look_at_floor(view, bodies, lines);
  return lines;
}

std::vector<std::string> judged_lines(const CaseView& view, const std::vector<Column>& columns) {
  std::vector<std::string> names, lines;
  for (const Column& column : columns) names.push_back(column.name);
  if (view.coupled())
    for (const char* load : {"force.x", "force.y", "force.z", "moment.x", "moment.y", "moment.z", "work_gap",
                             "iterations", "residual"})
      names.emplace_back(load);
  const auto is_known = [&](const std::string& probe) {
    const std::string base = probe.substr(0, probe.find('.'));
    return std::ranges::find(names, probe) != names.end() ||
           std::ranges::any_of(view.common.probes, [&](const ProbeKeys& one) { return one.name == base; });
  };
  for (const CompareBlock& block : view.blocks) {
    if (is_known(block.probe) || !applies(block, lookup_in(view.value))) continue;
    const std::string near = did_you_mean(block.probe, names);
    lines.push_back(
        fmt::format("[[compare]] of \"{}\": nothing of this run has that name, so it is not judged{}",
                    block.probe, near.empty() ? "" : "; did you mean " + near + "?"));
  }
  return lines;
}

}  // namespace strake
