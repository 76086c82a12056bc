#include "structure/case/keys.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace strake::structure {
namespace {

const std::vector<std::pair<std::string, Support>> supports = {
    {"free", Support::free}, {"clamped", Support::clamped}, {"pinned", Support::pinned}};

}  // namespace

void read_plate(CaseTable t, Plate& plate) {
  t.number("length", plate.length,
           {.unit = "m", .min = 0, .exclusive = true, .required = true, .help = "along x"});
  t.number("thickness", plate.thickness,
           {.unit = "m", .min = 0, .exclusive = true, .required = true, .help = "along y"});
  t.vector("bottom", plate.bottom, {.unit = "m", .help = "middle of the lower face"});
  t.number("angle", plate.angle,
           turn_key(89,
                    "against the horizontal, about the middle of the lower face; positive: the right end is "
                    "higher. Particles stay on a lattice along the axes"));
  t.number("hollow", plate.hollow,
           {.unit = "m",
            .help = "depth of the lower face's ends under its middle, a parabola; less than 0: they lie "
                    "higher; rigid plates alone"});
  CaseTable s = t.table("supports", "what holds the ends; held ends move with structure.velocity");
  s.choice("left", plate.left, supports, {.help = "pinned: at mid-height of the end face"});
  s.choice("right", plate.right, supports, {.help = "pinned: at mid-height of the end face"});
}

void read_hollow_plate(CaseTable t, Parameters& p) {
  const Plate& plate = p.plate;
  if (p.kind != "rigid" && p.kind != "replay")
    throw t.table("plate").error("hollow", "0: only rigid plates have a curved face",
                                 "structure.solver = \"rigid\", or an elastic one by structure.mesh");
  if (std::abs(plate.hollow) >= plate.thickness)
    throw t.table("plate").error("hollow", "less than the thickness", "hollow = 0.001");
  constexpr int chords = 40;
  const Eigen::Rotation2Dd turn(plate.angle * std::numbers::pi / 180);
  const auto add = [&](double x, double y) {
    p.shape.corner.push_back(plate.bottom.head<2>() + turn * Eigen::Vector2d(x, y));
  };
  const double half = 0.5 * plate.length;
  for (int k = 0; k <= chords; ++k) {
    const double s = 2.0 * k / chords - 1;
    add(s * half, -plate.hollow * s * s);
  }
  add(half, plate.thickness);
  add(-half, plate.thickness);
  p.shape.kind = ShapeKind::polygon;
  p.shape.middle = plate.bottom.z();
}

}  // namespace strake::structure
