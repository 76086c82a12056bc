#include "proto/mesh_files/stl.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"
#include "structure/case/keys.hpp"
#include "structure/mesh_files/mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace strake::structure {
namespace {

const std::vector<std::pair<std::string, Support>> support_kinds = {{"free", Support::free},
                                                                    {"clamped", Support::clamped},
                                                                    {"pinned", Support::pinned},
                                                                    {"roller", Support::roller},
                                                                    {"symmetry", Support::symmetry}};

constexpr const char* initial_help = "of this part at t = 0, beside structure.initial_velocity";

SolidBox read_box(CaseTable t, const Parameters& p, const std::vector<SolidBox>& others,
                  Eigen::Vector3d& velocity) {
  SolidBox box;
  box.material = p.material;
  t.text("name", box.name, {.required = true, .help = "of this part, for supports, output and messages"});
  t.vector("min", box.min, {.unit = "m", .required = true, .help = "corner with the smallest coordinates"});
  t.vector("max", box.max, {.unit = "m", .required = true, .help = "corner with the largest coordinates"});
  CaseTable supports = t.table("supports", "what holds its sides; held places move with structure.velocity");
  for (std::size_t side = 0; side < side_names.size(); ++side)
    supports.choice(
        side_names[side], box.support[side], support_kinds,
        {.help = side < 4 ? "clamped: all of the side; pinned: its middle line; roller: that line across "
                            "the side's normal; symmetry: all of it along the normal"
                          : "as left; three dimensions"});
  supports.flag("all", box.constrained, {.help = "the whole part is held: a frame, a deck that is driven"});
  t.vector("initial_velocity", velocity, {.unit = "m/s", .help = initial_help});
  read_material(t.table("material", "of this part; keys that are not given: structure.material"),
                box.material);
  if (!t.has("name")) return box;  // a list of declarations contains no box

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

/// The box, or its copies. Their middles have equal distances along x, also from the ends of `between`.
std::vector<SolidBox> read_copies(CaseTable t, const SolidBox& box) {
  int copies = 1;
  Eigen::Vector3d between = Eigen::Vector3d::Zero();
  t.integer("copies", copies,
            {.min = 0, .max = 1000, .help = "how many of it there are, e.g. ribs; 0 leaves it out"});
  t.vector(
      "between", between,
      {.unit = "m",
       .help =
           "two x; copies stand along x as far from one another as from these, instead of at min and max"});
  if (!t.has("between")) {
    if (copies > 1)
      throw t.error("copies", "0 or 1, or two x between which they stand", "between = [-0.1, 0.1]");
    return copies == 0 ? std::vector<SolidBox>{} : std::vector{box};
  }
  const double from = between[0], step = (between[1] - from) / (copies + 1);
  const double width = box.max[0] - box.min[0];
  if (!(step > 0) || (copies > 1 && step <= width))
    throw t.error(
        "between",
        fmt::format("two x that ascend and leave room for {} of {:g} m side by side", copies, width),
        "fewer copies, or a longer span");
  std::vector<SolidBox> all;
  for (int k = 1; k <= copies; ++k) {
    SolidBox one = box;
    if (copies > 1) one.name += fmt::format("_{}", k);
    // Rounded to what a spacing is ever given in, so that planes of other boxes are met.
    constexpr double grain = 1e-9;  // [m]
    one.min[0] = std::round((from + k * step - 0.5 * width) / grain) * grain;
    one.max[0] = std::round((from + k * step + 0.5 * width) / grain) * grain;
    all.push_back(one);
  }
  return all;
}

/// A body is cut along the planes of all its boxes, and all boxes are searched for each piece.
void check_grid(CaseTable structure, int dimension, const std::vector<SolidBox>& boxes) {
  constexpr double most_boxes = 2000, most_pieces = 5e5, most_looks = 2e8;
  const auto n = static_cast<double>(boxes.size());
  if (n > most_boxes)
    throw structure.error(
        "box", fmt::format("at most {:g} boxes with all their copies, these are {}", most_boxes, n),
        "fewer copies, or structure.mesh");
  const double pieces = grid_count(dimension, boxes);
  if (pieces > most_pieces || pieces * n > most_looks)
    throw structure.error(
        "box",
        fmt::format("boxes whose planes cut the body into at most {:g} pieces, these cut it into {:g}",
                    std::min(most_pieces, std::floor(most_looks / n)), pieces),
        "let boxes end in the same planes, or give the body as structure.mesh");
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
      {{"linear", MaterialModel::linear},
       {"saint_venant_kirchhoff", MaterialModel::saint_venant_kirchhoff},
       {"neo_hookean", MaterialModel::neo_hookean}},
      {.help =
           "linear: small strain; saint_venant_kirchhoff: large rotation, small strain; neo_hookean: large "
           "strain"});
  t.number("density", m.density, positive("kg/m^3", "of the solid"));
  t.number("young", m.young, positive("Pa", "Young's modulus E"));
  t.number("poisson", m.poisson,
           {.min = -1, .max = 0.5, .exclusive = true, .help = "Poisson's ratio, below 0.5"});
  if (m.poisson >= 0.5)
    throw t.error("poisson",
                  "a number greater than -1 and below 0.5: at 0.5 the plane-strain stiffness is infinite",
                  "poisson = 0.49");
  if (m.plane_stress && m.model == MaterialModel::neo_hookean)
    throw t.error("model", "linear or saint_venant_kirchhoff: structure.plane is \"stress\"",
                  "structure.plane = \"strain\"");
}

namespace {

/// [[structure.part]] and [[structure.support]]: what the parts and faces of a mesh file are.
void read_parts(CaseTable t, bool all, Solid& solid, std::vector<Eigen::Vector3d>& velocity) {
  for (CaseTable& table : t.tables("part", "a part of structure.mesh, by its physical name")) {
    std::string name;
    table.text("name", name, {.required = true, .help = "physical name of the part's cells"});
    const auto found = std::find_if(solid.parts.begin(), solid.parts.end(),
                                    [&](const Part& part) { return part.name == name; });
    Part spare, &part = found == solid.parts.end() ? spare : *found;
    table.flag("held", part.constrained, {.help = "all of it moves with the supports"});
    Eigen::Vector3d initial = Eigen::Vector3d::Zero();
    table.vector("initial_velocity", initial, {.unit = "m/s", .help = initial_help});
    if (found != solid.parts.end())
      velocity.at(static_cast<std::size_t>(found - solid.parts.begin())) = initial;
    read_material(table.table("material", "of this part; keys that are not given: structure.material"),
                  part.material);
    if (all || found != solid.parts.end()) continue;
    std::string known;
    for (const Part& other : solid.parts) known += (known.empty() ? "" : ", ") + other.name;
    throw table.error("name", "the physical name of a part of structure.mesh: " + known,
                      fmt::format("name = \"{}\"", solid.parts.empty() ? "" : solid.parts.front().name));
  }
}

/// The names of all [[structure.part]].
std::vector<std::string> part_names(CaseTable t) {
  std::vector<std::string> names;
  for (CaseTable& table : t.tables("part")) {
    names.emplace_back();
    table.text("name", names.back(), {});
  }
  return names;
}

/// The error of a support whose face is not there: a wrong name, or a side of a turned or round body, at
/// whose outermost place no face of a cell lies.
Error no_face(const CaseTable& table, const Solid& solid, const std::string& on) {
  std::vector<std::string> names = {"left", "right", "bottom", "top"};
  if (solid.dimension == 3) names.insert(names.end(), {"back", "front"});
  const bool is_side = std::find(names.begin(), names.end(), on) != names.end();
  for (const SupportedFace& face : solid.supported) names.push_back(face.name);
  const std::string near = is_side ? "" : did_you_mean(on, names);
  return table.error("on",
                     is_side ? "a side that is level across its axis: at the outermost place of that side "
                               "the body has a point or an edge, and no face"
                             : "a face at the body's boundary: " + joined(names),
                     near.empty() ? "give that side a physical name in the mesh file, or PART.SIDE of a box"
                                  : fmt::format("did you mean \"{}\"?", near));
}

void read_supports(CaseTable t, bool all, Solid& solid) {
  for (CaseTable& table :
       t.tables("support", "what holds a face of a body of structure.mesh or structure.box")) {
    std::string on;
    Support support = Support::clamped;
    table.text(
        "on", on,
        {.required = true,
         .help =
             "physical name of the face; left, right, bottom, top, back or front of the body; or PART.SIDE"});
    table.choice(
        "kind", support, support_kinds,
        {.help = "clamped: all of the face; pinned: its middle line; roller: that line across the face's "
                 "normal; symmetry: all of it along the normal"});
    if (all) continue;
    const std::vector<int> facets = facets_named(solid, on);
    if (facets.empty()) {
      throw no_face(table, solid, on);
    }
    auto found = std::find_if(solid.supported.begin(), solid.supported.end(),
                              [&](const SupportedFace& face) { return face.name == on; });
    if (found == solid.supported.end()) found = solid.supported.insert(found, {on, support, facets});
    found->support = support;
  }
}

}  // namespace

namespace {

/// A plate as a box, before it is turned.
Solid solid_of_plate(const Parameters& p) {
  const Plate& plate = p.plate;
  const Eigen::Vector3d half(0.5 * plate.length, 0, 0.5 * p.shape.depth);
  SolidBox box{
      .name = "plate", .min = plate.bottom - half, .max = plate.bottom + half, .material = p.material};
  box.max.y() += plate.thickness;
  box.support[0] = plate.left;
  box.support[1] = plate.right;
  return solid_of_boxes(p.dimension, {box});
}

/// [[structure.box]] with all copies, and the initial velocity of each.
std::vector<SolidBox> read_boxes(CaseTable t, const Parameters& p, std::vector<Eigen::Vector3d>& velocity) {
  std::vector<SolidBox> boxes;
  for (CaseTable& table : t.tables("box", "one part of a body that is a union of axis-aligned boxes")) {
    Eigen::Vector3d initial = Eigen::Vector3d::Zero();
    const SolidBox box = read_box(table, p, boxes, initial);
    for (SolidBox& one : read_copies(table, box)) {
      boxes.push_back(std::move(one));
      velocity.push_back(initial);
    }
  }
  check_grid(t, p.dimension, boxes);
  return boxes;
}

/// Refuses a file by its ending, before it is read.
void check_ending(const CaseTable& t, const std::filesystem::path& mesh) {
  const std::string ending = lower_case(mesh.extension().string());
  if (ending != ".msh" && ending != ".inp")
    throw t.error("mesh",
                  "a file that ends in .msh (Gmsh) or .inp (Abaqus), or in .stl for the closed surface of a "
                  "rigid body in space",
                  "save the mesh in one of these formats");
}

}  // namespace

void read_solid(const CaseFile& file, CaseTable t, Parameters& p) {
  const bool all = file.only_declares();
  std::vector<Eigen::Vector3d>& velocity = p.initial.of_part;
  const std::vector<SolidBox> boxes = read_boxes(t, p, velocity);
  std::filesystem::path mesh;
  if (all || t.has("mesh"))
    t.file("mesh", mesh,
           {.help =
                "cells of the body: Gmsh (.msh, text) or Abaqus (.inp); triangles, tetrahedra and prisms are "
                "cut into "
                "quadrilaterals and hexahedra; physical names of cells are parts, those of their sides "
                "faces; or "
                "the closed surface of a rigid body in space: STL (.stl, text or binary), lengths in m or "
                "placed.scale = 0.001"});
  const Placing placing = read_placing(t, p, all);
  if (!all) place_section(t, p, placing);
  const bool body = p.shape.kind == ShapeKind::solid;
  if (!all && is_stl(mesh)) {
    read_surface_body(t, p, mesh, placing.map(), placing.move);
    return;
  }
  if (!all && !mesh.empty()) check_ending(t, mesh);
  if (!all && !body)
    for (const char* key : {"part", "support"})
      if (t.has(key))
        throw t.error(key, "nothing: it belongs to a body of structure.mesh or structure.box",
                      "structure.plate.supports for a plate");
  const bool tilted_plate = body && boxes.empty() && mesh.empty();
  if (!all && body)
    p.solid = tilted_plate   ? solid_of_plate(p)
              : mesh.empty() ? solid_of_boxes(p.dimension, boxes)
                             : read_mesh(mesh, p.dimension, p.material, part_names(t));
  if (!all && body) place(p.solid, tilted_plate ? tilt_of(p.plate) : placing);
  if (!all && mesh.empty() && t.has("part"))
    throw t.error("part", "nothing: parts of structure.box say in their own table what they are",
                  "leave it out");
  velocity.resize(p.solid.parts.size(), Eigen::Vector3d::Zero());
  read_parts(t, all, p.solid, velocity);
  read_supports(t, all, p.solid);
  if (all || !body) return;

  const std::string key = tilted_plate ? "plate" : mesh.empty() ? "box" : "mesh";
  if (const SolidFault fault = fault_of(p.solid); !fault.problem.empty())
    throw t.error(key, "a sound body: " + fault.problem, fault.fix);
  check_planes(t, p.solid);
  if (p.dimension == 3) return;
  const auto polygons = outer_polygons(p.solid);
  if (polygons.size() != 1)
    throw t.error(key, fmt::format("one outer boundary, it has {}", polygons.size()),
                  "let the parts share a side, not only a corner");
  p.shape.corner = polygons.front();
}

}  // namespace strake::structure
