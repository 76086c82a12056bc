#include "structure/solid_keys.hpp"

#include <fmt/format.h>

#include <cmath>

namespace strake::structure {
namespace {

const std::vector<std::pair<std::string, Support>> support_names = {{"free", Support::free},
                                                                    {"clamped", Support::clamped},
                                                                    {"pinned", Support::pinned},
                                                                    {"roller", Support::roller},
                                                                    {"symmetry", Support::symmetry}};

SolidBox read_box(CaseTable t, const Parameters& p, const std::vector<SolidBox>& others) {
  SolidBox box;
  box.material = p.material;
  t.text("name", box.name, {.required = true, .help = "of this part, for supports, output and messages"});
  t.vector("min", box.min, {.unit = "m", .required = true, .help = "corner with the smallest coordinates"});
  t.vector("max", box.max, {.unit = "m", .required = true, .help = "corner with the largest coordinates"});
  CaseTable supports = t.table("supports", "what holds its sides; held places move with structure.velocity");
  for (std::size_t side = 0; side < side_names.size(); ++side)
    supports.choice(
        side_names[side], box.support[side], support_names,
        {.help = side < 4 ? "clamped: all of the side; pinned: its middle line; roller: that line across "
                            "the side's normal; symmetry: all of it along the normal"
                          : "as left; three dimensions"});
  supports.flag("all", box.held, {.help = "the whole part is held: a frame, a deck that is driven"});
  read_material(t.table("material", "of this part; keys that are not given: structure.material"),
                box.material);
  if (!t.has("name")) return box;  // a list of declarations holds no box

  for (const SolidBox& other : others)
    if (other.name == box.name)
      throw t.error("name", "a name that no other box has", fmt::format("name = \"{}_2\"", box.name));
  for (int axis = 0; axis < p.dimension; ++axis)
    if (!(box.min[axis] < box.max[axis]))
      throw t.error("max",
                    fmt::format("above min along {}: {:g} is not above {:g}", "xyz"[axis], box.max[axis],
                                box.min[axis]),
                    "exchange min and max");
  if (p.dimension == 2)
    for (const std::size_t side : {4U, 5U})
      if (box.support[side] != Support::free)
        throw supports.error(side_names[side], "free: fluid.dimension is 2, there is no such side");
  return box;
}

/// The plate as a union of one box.
SolidBox box_of(const Parameters& p) {
  const Plate& plate = p.plate;
  SolidBox box;
  box.name = "plate";
  box.material = p.material;
  const double half = 0.5 * plate.length;
  box.min << plate.bottom.x() - half, plate.bottom.y(), p.shape.middle - 0.5 * p.shape.depth;
  box.max << plate.bottom.x() + half, plate.bottom.y() + plate.thickness,
      p.shape.middle + 0.5 * p.shape.depth;
  box.support[0] = plate.left;
  box.support[1] = plate.right;
  return box;
}

/// Planes that all but coincide are a slip of the pen: they would make cells as thin as the slip.
void check_planes(CaseTable structure, const Solid& solid) {
  constexpr double sliver = 0.02;  // of the thinnest part
  const double least = sliver * thinnest(solid);
  for (std::size_t axis = 0; axis < solid.plane.size(); ++axis)
    for (std::size_t i = 1; i < solid.plane[axis].size(); ++i) {
      const double a = solid.plane[axis][i - 1], b = solid.plane[axis][i];
      if (b - a < least)
        throw structure.error(
            "box",
            fmt::format("boxes whose planes coincide or stand well apart: {} = {:.9g} and {:.9g} m "
                        "differ by {:.3g} m",
                        "xyz"[axis], a, b, b - a),
            fmt::format("give both boxes {:.9g}", a));
    }
}

}  // namespace

void read_material(CaseTable t, Material& m) {
  t.choice(
      "model", m.model,
      {{"linear", MaterialModel::linear}, {"saint_venant_kirchhoff", MaterialModel::saint_venant_kirchhoff}},
      {.not_built = {"neo_hookean"}, .help = "linear: small strain; saint_venant_kirchhoff: large rotation"});
  t.number("density", m.density, {.unit = "kg/m^3", .min = 0, .exclusive = true, .help = "of the solid"});
  t.number("young", m.young, {.unit = "Pa", .min = 0, .exclusive = true, .help = "Young's modulus E"});
  t.number("poisson", m.poisson,
           {.min = -1, .max = 0.5, .exclusive = true, .help = "Poisson's ratio, below 0.5"});
  if (m.poisson >= 0.5)
    throw t.error("poisson",
                  "a number greater than -1 and below 0.5: at 0.5 the plane-strain stiffness is infinite",
                  "poisson = 0.49");
}

void read_solid(const CaseFile& file, CaseTable t, Parameters& p) {
  std::vector<SolidBox> boxes;
  for (CaseTable& box : t.tables("box", "one part of a body that is a union of axis-aligned boxes"))
    boxes.push_back(read_box(box, p, boxes));
  if (file.only_declares()) return;
  const bool given = p.shape.kind == ShapeKind::boxes;
  if (!given && p.shape.kind != ShapeKind::plate) return;
  if (!given) boxes = {box_of(p)};
  p.solid = solid_of_boxes(p.dimension, boxes);
  if (!given) return;
  if (const SolidFault fault = fault_of(p.solid); !fault.problem.empty())
    throw t.error("box", "a body in one piece: " + fault.problem, fault.fix);
  check_planes(t, p.solid);
  if (p.dimension == 3) return;
  const auto polygons = outer_polygons(p.solid);
  if (polygons.size() != 1)
    throw t.error("box", fmt::format("one outer boundary, it has {}", polygons.size()),
                  "let the parts share a side, not only a corner");
  p.shape.corner = polygons.front();
}

}  // namespace strake::structure
