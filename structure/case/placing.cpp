#include "proto/geometry/thinning.hpp"
#include "structure/case/keys.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <numbers>
#include <string>

namespace strake::structure {
namespace {

/// A key of a shape that is a polygon in the plane, and what it has to be.
struct Section {
  const char *key, *expected;
};
constexpr std::array<Section, 3> sections = {{{"offsets", "a section that is a closed outline: "},
                                              {"outline", "a closed polygon that does not cross itself: "},
                                              {"wedge", "a wedge that the surface's points can resolve: "}}};

/// The section that the case gives, which may be placed; none: another shape.
const Section* section_of(const CaseTable& structure) {
  for (const Section& section : sections)
    if (structure.has(section.key)) return &section;
  return nullptr;
}

bool is_upright(const Eigen::Vector3d& axis) {
  return axis.head<2>().norm() <= 1e-9 * axis.norm();
}

}  // namespace

NumberKey turn_key(double most, const std::string& help) {
  return {.unit = "deg", .min = -most, .max = most, .help = help};
}

Eigen::Matrix3d Placing::turn() const {
  return Eigen::AngleAxisd(angle * std::numbers::pi / 180, axis.normalized()).toRotationMatrix();
}

Placing read_placing(CaseTable structure, const Parameters& p, bool only_declares) {
  CaseTable t =
      structure.table("placed", "where a body of structure.mesh, box, outline, offsets or wedge goes");
  Placing placing;
  t.number("scale", placing.scale, positive("1", "factor on all lengths, first: 0.001 for a mesh in mm"));
  t.number("angle", placing.angle,
           turn_key(360,
                    "turn about the axis through the origin, counter-clockwise, second; particles stay on "
                    "their lattice, which is not turned"));
  t.vector("axis", placing.axis,
           {.help = "of the turn; in two dimensions, and of an outline, a section or a wedge: z alone"});
  t.vector("move", placing.move, {.unit = "m", .help = "shift, last"});
  if (placing.axis.norm() == 0) throw t.error("axis", "a direction", "axis = [0, 0, 1]");
  if (only_declares) return placing;
  const bool turned = placing.angle != 0, section = section_of(structure) != nullptr;
  const bool plate = !section && (p.shape.kind != ShapeKind::solid || p.plate.angle != 0);
  if (plate && (turned || placing.scale != 1 || !placing.move.isZero()))
    throw t.error(turned               ? "angle"
                  : placing.scale != 1 ? "scale"
                                       : "move",
                  "nothing: it belongs to a body of structure.mesh, box, outline, offsets or wedge",
                  "a plate at an angle: structure.plate.angle; a cylinder or sphere has its centre");
  if (turned && (section || p.dimension == 2) && !is_upright(placing.axis))
    throw t.error("axis",
                  section ? "[0, 0, 1]: an outline, a section or a wedge turns in its plane"
                          : "[0, 0, 1]: in two dimensions a body turns in the plane",
                  "leave axis out");
  return placing;
}

Placing tilt_of(const Plate& plate) {
  Placing placing{.angle = plate.angle};
  placing.move = plate.bottom - placing.turn() * plate.bottom;
  return placing;
}

void place(Solid& solid, const Placing& placing) {
  const Eigen::Matrix3d R = placing.turn();
  solid.node = ((placing.scale * R) * solid.node).colwise() + placing.move;
  if (solid.dimension == 2) solid.node.row(2).setZero();
  solid.turn = R;
  const Eigen::Vector3d move = R.transpose() * placing.move;  // along the boxes' own axes
  for (int axis = 0; axis < 3; ++axis)
    for (double& plane : solid.plane.at(static_cast<std::size_t>(axis)))
      plane = placing.scale * plane + move[axis];
}

void place_section(CaseTable t, Parameters& p, const Placing& placing) {
  const Section* section = section_of(t);
  if (section == nullptr) return;
  const Eigen::Matrix3d map = placing.map();
  for (Eigen::Vector2d& corner : p.shape.corner)
    corner = map.topLeftCorner<2, 2>() * corner + placing.move.head<2>();
  if (p.dimension == 3) p.shape.middle = placing.scale * p.shape.middle + placing.move.z();
  if (const PolygonFault fault = polygon_fault(p.shape.corner); !fault.problem.empty())
    throw t.error(section->key, section->expected + fault.problem, fault.fix);
  const Polygon fewer = thinned(p.shape.corner, std::min(p.surface_spacing, p.fluid_spacing));
  if (!polygon_fault(fewer).problem.empty()) return;
  p.shape.unseen = static_cast<int>(p.shape.corner.size() - fewer.size());
  p.shape.corner = fewer;
}

}  // namespace strake::structure
