#include "coupler/summary/resolution.hpp"

#include "coupler/summary/blockage.hpp"
#include "coupler/summary/hulls.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

namespace strake {
namespace {

// Bounds of resolution. Two layers of particles bend wrongly by tens of per cent, four by some per cent
// (cases/VALIDATION.md, "Strips: deflection and frequencies"). The mean force of a wedge keeps to some 15 %
// from twelve spacings per half wetted width on, and to 5 % from thirty on. Flat faces need more. The force
// is some 30 % low while the jet has less than a tenth of a spacing, and 5 to 15 % up to a fifth. Measured at
// 10 to 30 degrees (cases/VALIDATION.md, "Wedges and V sections at steps that resolve sound"). Below some 9
// degrees the mean force follows c tan β/l0 alone, with 15 % at 3.8 and 5 % at 7 (4 to 7.5 degrees).
constexpr double enough_layers = 4;
constexpr double coarse = 12, fine = 30;               // [l0]
constexpr double coarse_jet = 0.1, fine_jet = 0.2;     // [l0]
constexpr double least_slope = 0.165, most_slope = 1;  // where the two are taken to hold; below, as 1/tan β
constexpr double flattest_slope = 0.07;                // no flatter wedge was measured
constexpr double level_slope = 0.02;  // below it a face meets the water at once, and no peak runs along it
constexpr double steep_slope = 0.6;   // above some 30 degrees the pressure has no peak at the jet root

/// The y of the second corner of fluid.water, "[[-1, -0.5, 0], [1, 0, 0]]"; nothing for other shapes of
/// water.
std::optional<double> water_level(const CaseView& view) {
  const std::vector<double> corners = numbers_in(at_or(view.value, "fluid.water"));
  if (corners.size() != 4 && corners.size() != 6) return std::nullopt;
  return corners[corners.size() / 2 + 1];
}

/// Of a plate of particles, the only body or one of several.
std::optional<std::string> layers_line(const CaseView& view, const SideView& side) {
  if (side.solver != "particle") return std::nullopt;
  const std::string table = side.is_body ? "structures." + side.side : "structure";
  const auto thickness = view.number(table + ".plate.thickness");
  const std::string key = view.common.interface == "volume" ? "fluid.spacing" : table + ".particle.spacing";
  const auto spacing = view.number(key);
  if (!thickness || !spacing || !(*spacing > 0)) return std::nullopt;
  const double layers = *thickness / *spacing;
  if (!(layers < enough_layers - 1e-6)) return std::nullopt;
  return fmt::format("{}{:.2g} particle layers across the plate: its stiffness needs 4 or more; smaller {}",
                     side.is_body ? side.side + ": " : "", layers, key);
}

/// The part of a body that is wet at the end: half its width [m], and the mean slope of its face where the
/// water got that far. `left`: the width grows no more, the jet has left the face before the end.
struct Wetted {
  double half = 0, slope = 0;
  bool left = false, straight = false;  // straight: the face has one slope, as that of a wedge
  double rise = 0;                      // [m] of the water over its lowest point
  std::string dry;                      // why a body of no wetted width stays away
  bool round = false;                   // half the width is a radius
};

/// Half the width along an axis of what a level water surface at height y would wet [m].
double half_width_along(const InterfaceMesh& body, double y, Eigen::Index axis) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto take = [&](double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  };
  for (Eigen::Index k = 0; k < body.position.cols(); ++k)
    if (body.position(1, k) <= y) take(body.position(axis, k));
  for (Eigen::Index f = 0; f < body.faces.cols(); ++f)
    for (Eigen::Index k = 0; k < body.faces.rows(); ++k) {
      const Eigen::Vector3d a = body.position.col(body.faces(k, f)),
                            b = body.position.col(body.faces((k + 1) % body.faces.rows(), f));
      if ((a.y() <= y) != (b.y() <= y)) take(a[axis] + (y - a.y()) / (b.y() - a.y()) * (b[axis] - a[axis]));
    }
  return high > low ? 0.5 * (high - low) : 0;
}

/// The least rise [m] of the water that wets half a width, up to a given rise; by bisection.
double rise_that_wets(const InterfaceMesh& body, double lowest, double half, double rise) {
  double low = 0, high = rise;
  constexpr int halvings = 30;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (half_width_below(body, lowest + middle) < (1 - 1e-6) * half ? low : high) = middle;
  }
  return high;
}

/// Whether the face below a rise has one slope: half of the width is wet at half of the rise.
bool is_straight(const InterfaceMesh& body, double lowest, double half, double rise) {
  constexpr double slack = 0.1;  // of the slope
  const double below = rise_that_wets(body, lowest, 0.5 * half, rise);
  return std::abs(below - 0.5 * rise) <= slack * 0.5 * rise;
}

/// The table of a body in the case: "structure", or of several "structures.left".
std::string table_named(const std::string& name) {
  return name.empty() ? "structure" : "structures." + name;
}

bool is_free_body(const CaseView& view, const std::string& table) {
  return std::ranges::any_of(view.value, [&](const auto& key) {
    return key.first.starts_with(table + ".free.") && key.second == "true";
  });
}

/// Way that a body falls from rest until the end [m], ½ g t², where it is free to; else 0. Of several bodies
/// one may start at rest and another not.
double fall_of(const CaseView& view, const std::string& table) {
  const std::vector<double> gravity = numbers_in(at_or(view.value, "fluid.gravity"));
  if (!view.common.chosen.from_rest || gravity.size() < 2 || at_or(view.value, table + ".free.y") != "true")
    return 0;
  return std::max(0.0, -0.5 * gravity[1] * view.common.end_time * view.common.end_time);
}

/// Whether gravity brings a free body that starts upwards back to the water before the end:
///   h + |v| t - g t^2/2 < 0.
bool comes_down(const CaseView& view, const std::string& table, double speed, double height) {
  if (at_or(view.value, table + ".free.y") != "true") return false;
  const std::vector<double> gravity = numbers_in(at_or(view.value, "fluid.gravity"));
  if (gravity.size() < 2) return true;  // not known: nothing is said
  const double t = view.common.end_time;
  return height - speed * t + 0.5 * gravity[1] * t * t < 0;
}

/// Says when a body that comes down too slowly, or from too high, would meet the water. speed: at t = 0.
std::string why_late(const CaseView& view, const std::string& table, double speed, double height) {
  if (is_free_body(view, table) || !(speed > 0)) return fmt::format("it starts {:.3g} m above it", height);
  return fmt::format("at {:.3g} m/s it does at t = {:.3g} s", speed, height / speed);
}

/// Whether a body in space is round where the water gets to: as wide along z as along x.
bool is_round(const InterfaceMesh& body, double y) {
  constexpr double slack = 0.1;  // of the width
  if (body.dimension != 3) return false;
  const double along_x = half_width_along(body, y, 0), along_z = half_width_along(body, y, 2);
  return along_x > 0 && std::abs(along_z - along_x) <= slack * along_x;
}

/// Height to which the water rises along a face whose lowest point is `depth` under the level, by Wagner's
/// condition (1932): that much of the face's height y(r) that r = c gives
///   depth = (2/π) ∫ y(c sin θ) dθ        in the plane, and along a long body
///   depth = ∫ y(c sin θ) sin θ dθ        of a round body,   θ from 0 to π/2.
/// So it is π/2 of the depth at a wedge, 4/π at a cone, 3/2 at a sphere. A round body that is not straight is
/// taken for a sphere.
double rise_along_face(const InterfaceMesh& body, double lowest, double depth) {
  const double wedge = 0.5 * std::numbers::pi * depth, cone = 4 * std::numbers::inv_pi * depth,
               sphere = 1.5 * depth;
  if (!is_round(body, lowest + cone)) return wedge;
  const double half = half_width_below(body, lowest + cone);
  return is_straight(body, lowest, half, cone) ? cone : sphere;
}

/// Nothing where the body does not come down on the water; half = 0 where it does not reach it.
std::optional<Wetted> wetted_at_end(const CaseView& view, const MovingBody& moving, double level) {
  const auto& [name, body, velocity] = moving;
  const std::string table = table_named(name);
  if (body.position.cols() == 0 || velocity.cols() != body.position.cols()) return std::nullopt;
  const double lowest = body.position.row(1).minCoeff(), speed = -velocity.row(1).minCoeff();
  // A table changes the speed: how far the body comes is not known here.
  const bool by_table =
      view.common.chosen.by_table > 0 && (name.empty() || !at_or(view.value, table + ".motion.file").empty());
  if (lowest < level - 1e-9 || by_table) return std::nullopt;
  const bool free = is_free_body(view, table);
  if (speed < 0 && !comes_down(view, table, speed, lowest - level))
    return Wetted{.dry = "its velocity points up, along +y"};
  const bool level_way = speed == 0 && velocity.row(1).isZero(0) && !velocity.isZero(0);
  if (level_way && lowest > level + 1e-9 && !free) return Wetted{.dry = "its velocity is level, y points up"};
  const double way = speed > 0 ? speed * view.common.end_time : fall_of(view, table);
  if (!(way > 0)) return std::nullopt;
  const double depth = way - (lowest - level);
  if (!(depth > 0)) return Wetted{.dry = why_late(view, table, speed, lowest - level)};
  const double rise = rise_along_face(body, lowest, depth), half = half_width_below(body, lowest + rise);
  if (!(half > 0)) return Wetted{};
  const bool grows = half > 1.01 * half_width_below(body, lowest + 0.95 * rise);
  const bool round = is_round(body, lowest + rise);
  if (grows) return Wetted{half, rise / half, false, is_straight(body, lowest, half, rise), rise, {}, round};
  // The outermost point may stand on the side above the face, half a plate's thickness higher.
  const double inner = 0.95 * half, whole = rise_that_wets(body, lowest, half, rise) / half,
               face = rise_that_wets(body, lowest, inner, rise) / inner;
  const double slope = whole > 2 * face ? face : whole;
  return Wetted{half, slope, true, is_straight(body, lowest, inner, face * inner), rise, {}, round};
}

/// Returns the spacings on half the wetted width that a jet of `jet` spacings needs, at least `least`:
/// c = 2π δ/tan²β (Wagner 1932). Below least_slope it grows as 1/tan β, down to flattest_slope.
double spacings_needed(const Wetted& wetted, double least, double jet) {
  const double slope = wetted.slope;
  if (!(slope > level_slope) || !(slope <= most_slope)) return least;
  const double product = std::max(slope, flattest_slope) * std::max(slope, least_slope);
  return std::max(least, 2 * std::numbers::pi * jet / product);
}

std::string width_line(const Wetted& wetted, double spacing) {
  if (!(wetted.half > 0))
    return "the body does not reach the water before end_time" +
           (wetted.dry.empty() ? "" : ": " + wetted.dry);
  const double count = wetted.half / spacing, enough = spacings_needed(wetted, coarse, coarse_jet),
               good = spacings_needed(wetted, fine, fine_jet);
  const std::string judged =
      count >= good ? "mean force to some 5 %"
      : count >= enough
          ? fmt::format("mean force to some 15 %, to 5 % from {:.0f} on", good)
          : fmt::format("too few for forces: {:.0f} give some 15 %, {:.0f} some 5 %", enough, good);
  return fmt::format("{:.{}f} spacings on {} of {:.3g} m at the end: {}", count, count >= fine ? 0 : 1,
                     wetted.round ? "the wetted radius" : "half the wetted width", wetted.half, judged);
}

/// Spacings across the jet at the end, or where it leaves the face; nothing for faces without a thin jet. A
/// jet thinner than a spacing takes one particle after the other, and the force rises and falls with each
/// (cases/VALIDATION.md, "Wedges and V sections at steps that resolve sound"). Figures of faces whose slope
/// changes stand there, and in "Cylinder entry".
std::optional<std::string> jet_line(const Wetted& wetted, double spacing) {
  if (!(wetted.half > 0) || !(wetted.slope > level_slope) || !(wetted.slope <= 1)) return std::nullopt;
  const double jet = jet_thickness(wetted.half, wetted.slope);
  const std::string count = fmt::format("{:.2g} spacings through the jet{}", jet / spacing,
                                        wetted.left ? " as it leaves the face" : "");
  if (!wetted.straight)
    return count +
           ", by the mean slope of the face. Its slope changes: the force scattered about its mean by 3 to "
           "15 % on a cylinder and on a bow with flare, by 30 % while less than ten spacings were wet";
  if (jet >= spacing) return count + ": the force scatters by some 10 % about its mean, as that of wedges";
  return fmt::format(
      "{}: the force scatters by up to 50 % about its mean, as that of wedges; by 10 % with "
      "fluid.spacing = {:.2g}",
      count, jet);
}

/// Says that water closes a hollow of the body: between two hulls, or between two edges. In the plane its air
/// cannot leave, and only fluid.air.layer computes air. A body that stands in the water at the start,
/// and comes down, has the water at the level and its way; what lies under the level then holds water.
std::optional<std::string> hollow_line(const CaseView& view, const MovingBody& moving, double level,
                                       const std::optional<Wetted>& wetted) {
  if (at_or(view.value, "fluid.air.layer") == "true" || moving.mesh.position.cols() == 0) return std::nullopt;
  const double lowest = moving.mesh.position.row(1).minCoeff();
  const bool stands = !wetted && lowest < level && moving.velocity.cols() == moving.mesh.position.cols();
  const double way = stands ? -moving.velocity.row(1).minCoeff() * view.common.end_time : 0;
  if (wetted ? !(wetted->half > 0) : !(way > 0)) return std::nullopt;
  const auto hollow = hollow_below(moving.mesh, wetted ? lowest + wetted->rise : level + way);
  if (!hollow || (stands && hollow->roof <= level)) return std::nullopt;
  return fmt::format(
      "water closes a hollow {:.3g} m wide and {:.2g} m high: its air is not computed, and the blow on its "
      "roof "
      "follows step and spacing",
      hollow->right - hollow->left, hollow->roof - hollow->mouth);
}

/// Whether the face under the water is hollow: its edges meet the water first, and the water runs from them
/// to the middle. No jet leaves such a face as it leaves a wedge's, and the mean slope has no meaning.
bool is_hollow(const InterfaceMesh& body, const Wetted& wetted) {
  if (!(wetted.half > 0)) return false;
  const auto hollow = hollow_below(body, body.position.row(1).minCoeff() + wetted.rise);
  return hollow && hollow->right - hollow->left > wetted.half;
}

/// The slope of the body's face at the place nearest to `at`, as |dy/dx|; bodies in the plane.
double slope_at(const InterfaceMesh& body, const Eigen::Vector3d& at) {
  double nearest = std::numeric_limits<double>::infinity(), slope = 0;
  for (Eigen::Index f = 0; f < body.faces.cols(); ++f) {
    const Eigen::Vector3d a = body.position.col(body.faces(0, f)),
                          t = body.position.col(body.faces(1, f)) - a;
    if (t.squaredNorm() == 0) continue;
    const double s = std::clamp((at - a).dot(t) / t.squaredNorm(), 0.0, 1.0);
    const double distance = (a + s * t - at).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    slope = t.x() == 0 ? std::numeric_limits<double>::infinity() : std::abs(t.y() / t.x());
  }
  return slope;
}

std::vector<std::string> sensor_lines(const CaseView& view, const InterfaceMesh& body, double spacing) {
  std::vector<std::string> lines;
  if (body.dimension != 2 || body.faces.cols() == 0) return lines;
  Eigen::Index keel = 0;
  body.position.row(1).minCoeff(&keel);
  for (const ProbeKeys& probe : view.common.probes) {
    if (probe.of != "fluid" || (probe.quantity != "pressure" && !probe.quantity.empty())) continue;
    const double slope = slope_at(body, probe.at), c = std::abs(probe.at.x() - body.position(0, keel));
    if (!(slope > level_slope) || !(slope < steep_slope) || c == 0) continue;
    const double diameter = probe.diameter > 0 ? probe.diameter : 2 * spacing, width = peak_width(c, slope);
    if (diameter > width)
      lines.push_back(
          fmt::format("sensor {} of {:.3g} mm is wider than the pressure peak that passes it, {:.2g} mm: "
                      "it shows less than the peak",
                      probe.name, 1e3 * diameter, 1e3 * width));
  }
  return lines;
}

/// Half the width of the widest of several hulls [m]; 0 where a body has one.
double half_width_of_hulls(const InterfaceMesh& body, double y) {
  const auto hulls = hulls_at(body, y);
  double widest = 0;
  for (const auto& [left, right] : hulls) widest = std::max(widest, right - left);
  return hulls.size() > 1 ? 0.5 * widest : 0;
}

}  // namespace

double half_width_below(const InterfaceMesh& body, double y) {
  if (const double hulls = body.dimension == 2 ? half_width_of_hulls(body, y) : 0; hulls > 0) return hulls;
  const double along_x = half_width_along(body, y, 0);
  return body.dimension == 3 ? std::min(along_x, half_width_along(body, y, 2)) : along_x;
}

double jet_thickness(double c, double slope) {
  return c * slope * slope / (2 * std::numbers::pi);
}

double peak_width(double c, double slope) {
  constexpr double half_heights = 20.2;  // [δ]: 4q/(1+q)² = 1/2 at q = 3 ± √8, x/δ = (5 − 4q − q² − 2 ln q)/π
  return half_heights * jet_thickness(c, slope);
}

std::vector<std::string> resolution_lines(const CaseView& view, const InterfaceMesh& body,
                                          const Points& velocity) {
  return resolution_lines(view, {{.name = "", .mesh = body, .velocity = velocity}});
}

std::vector<std::string> resolution_lines(const CaseView& view, const std::vector<MovingBody>& bodies) {
  std::vector<std::string> lines;
  const auto spacing = view.number("fluid.spacing");
  if (!view.fluid || view.fluid->solver != "mps" || !spacing) return lines;
  for (const SideView& side : view.structures)
    if (const auto line = layers_line(view, side)) lines.push_back(*line);
  const auto level = water_level(view);
  bool hollow_face = false;
  for (const MovingBody& body : bodies) {
    auto wetted = level ? wetted_at_end(view, body, *level) : std::nullopt;
    hollow_face = wetted && is_hollow(body.mesh, *wetted);
    if (hollow_face) wetted->slope = 0;  // as of a level face
    const std::string begin = body.name.empty() ? "" : body.name + ": ";
    const auto hollow = level ? hollow_line(view, body, *level, wetted) : std::nullopt;
    if (!wetted) {
      if (hollow) lines.push_back(begin + *hollow);
      continue;
    }
    lines.push_back(begin + width_line(*wetted, *spacing));
    if (const auto jet = jet_line(*wetted, *spacing)) lines.push_back(begin + *jet);
    if (hollow) lines.push_back(begin + *hollow);
    if (const auto walls = blockage_line(view, body.mesh, wetted->half, *level, !wetted->left))
      lines.push_back(begin + *walls);
  }
  if (bodies.size() == 1 && !hollow_face)  // of several it is not known on which one a sensor sits
    for (std::string& line : sensor_lines(view, bodies.front().mesh, *spacing))
      lines.push_back(std::move(line));
  lines.push_back("one spacing: not checked against a second spacing (strake study varies fluid.spacing)");
  return lines;
}

}  // namespace strake
