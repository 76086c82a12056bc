#include "proto/files/motion_file.hpp"
#include "proto/visible.hpp"
#include "structure/body/mass.hpp"
#include "structure/body/surface.hpp"
#include "structure/case/keys.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

namespace strake::structure {
namespace {

constexpr double degree = std::numbers::pi / 180;  // [rad]

void read_outline(CaseTable structure, Shape& shape) {
  std::vector<Eigen::Vector3d> points;
  structure.points("outline", points,
                   {.unit = "m",
                    .help = "corners of a rigid body's polygon, counter-clockwise, the last not "
                            "repeated"});
  if (points.empty()) return;
  shape.kind = ShapeKind::polygon;
  for (const Eigen::Vector3d& point : points) shape.corner.push_back(point.head<2>());
  shape.middle = points.front().z();
}

void read_wedge(CaseTable t, Shape& shape) {
  Wedge wedge;
  double deadrise = 0, chine = 0;
  t.number("deadrise", deadrise,
           {.unit = "deg",
            .min = 0,
            .max = 85,
            .exclusive = true,
            .required = true,
            .help = "angle of the lower faces against the horizontal"});
  t.number("width", wedge.width, positive("m", "between the chines; this or draught"));
  t.number("draught", chine, positive("m", "of the chines above the apex; this or width"));
  t.vector("apex", wedge.apex, {.unit = "m", .help = "lowest point; in three dimensions of its middle"});
  t.number("height", wedge.height,
           positive("m",
                    "from the apex to the deck, vertical sides above the chines; not given: a quarter of the "
                    "width above them"));
  if (!t.has("deadrise")) return;  // a list of declarations contains no wedge
  if (t.has("width") == t.has("draught"))
    throw t.error(t.has("width") ? "draught" : "width",
                  "one of width and draught, the other follows from the deadrise",
                  t.has("width") ? "leave draught out" : "width = 0.5");
  wedge.deadrise = deadrise * degree;
  if (chine > 0) wedge.width = 2 * chine / std::tan(wedge.deadrise);
  const double least = draught(wedge);
  if (wedge.height == 0) wedge.height = least + 0.25 * wedge.width;
  if (wedge.height < least * (1 - 1e-9))
    throw t.error("height", fmt::format("at least the {:.6g} m that the chines lie above the apex", least),
                  fmt::format("height = {:.6g}", least));
  shape.kind = ShapeKind::wedge;
  shape.corner = wedge_polygon(wedge);
  shape.middle = wedge.apex.z();
}

void read_round(CaseTable t, ShapeKind kind, Shape& shape) {
  double radius = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  t.number("radius", radius,
           {.unit = "m", .min = 0, .exclusive = true, .required = true, .help = "of the body"});
  t.vector("centre", centre, {.unit = "m", .help = "of the body"});
  if (!t.has("radius")) return;
  shape.kind = kind;
  shape.radius = radius;
  shape.centre = centre;
  shape.middle = centre.z();
}

void check_outline(CaseTable structure, const Parameters& p, const std::string& key) {
  const Shape& shape = p.shape;
  if (shape.kind == ShapeKind::plate) return;
  if (shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::sphere) {
    if (shape.radius < 2 * p.surface_spacing)
      throw structure.table(key).error(
          "radius",
          fmt::format("at least twice the distance of the surface's points ({:.6g} m)", p.surface_spacing),
          fmt::format("structure.surface_spacing = {:.6g}", 0.25 * shape.radius));
    return;
  }
  // Sections are checked once they are placed.
  if (!p.plate.hollow) return;
  if (const PolygonFault fault = polygon_fault(shape.corner); !fault.problem.empty())
    throw structure.error("plate", "a plate that the surface's points can resolve: " + fault.problem,
                          fault.fix);
}

/// A free motion is not prescribed as well, by table or speed.
void check_motion(CaseTable t, const CommonKeys& common, const Parameters& p) {
  const std::array<std::pair<const char*, bool>, 4> free = {
      {{"x", p.free.x}, {"y", p.free.y}, {"z", p.free.z}, {"angle", p.free.angle || p.free.rotation}}};
  if (!p.motion) return;
  for (std::size_t channel = 0; channel < free.size(); ++channel) {
    if (!p.motion->gives(channel)) continue;
    const double speed = channel < 3 ? p.velocity[static_cast<Eigen::Index>(channel)] : p.angular_velocity;
    if (free[channel].second)
      throw t.table("free").error(
          free[channel].first, "false: structure.motion.file prescribes this motion",
          "leave its column out of the file, or free." + std::string(free[channel].first) + " = false");
    if (speed != 0)
      throw t.error(
          channel < 3 ? "velocity" : "angular_velocity",
          fmt::format("0 along {}: structure.motion.file prescribes this motion", free[channel].first),
          "leave the column out of the file, or the speed");
  }
  const double slack = 1e-9 * common.end_time;
  if (p.motion->start() > slack || p.motion->end() < common.end_time - slack)
    throw t.table("motion").error(
        "file",
        fmt::format("a table from 0 to the end of the run at {:.6g} s: it goes from {:.6g} s to {:.6g} s",
                    common.end_time, p.motion->start(), p.motion->end()),
        fmt::format("add rows, or end_time = {:.6g}", p.motion->end()));
}

/// Checks supports that a table turns: the body needs a law for large rotation, and clamps as its only
/// supports.
void check_turning(CaseTable t, const Parameters& p) {
  const auto refuse = [&](const std::string& why, const std::string& fix) {
    throw t.table("motion").error("file", "a table without angle or rate: " + why, fix);
  };
  if (p.kind == "ccx")
    refuse("CalculiX takes supports that move and do not turn", "structure.solver = \"fem\" or \"particle\"");
  if (!p.pivot) refuse("it is not said what the supports turn about", "structure.pivot = [0.0, 0.0, 0.0]");
  if (p.free.any()) refuse("supports that turn are free in no direction", "leave structure.free out");
  if (p.damping.mass > 0 || p.damping.stiffness > 0)
    refuse("Rayleigh's damping would brake the turn itself", "leave structure.damping out");
  if (p.kind == "particle" && p.particle.model == ParticleModel::pair)
    refuse("the pair model's own turn is not held by supports",
           "structure.particle.model = \"total_lagrangian\"");
  const Solid solid = elastic_solid(p);
  for (const Part& part : solid.parts)
    if (part.material.model == MaterialModel::linear)
      refuse("linear elasticity takes a turn for strain",
             "structure.material.model = \"saint_venant_kirchhoff\"");
  for (const SupportedFace& face : solid.supported)
    if (face.support != Support::clamped && face.support != Support::free)
      refuse("a face that is not clamped does not turn with its support", "clamp it");
}

/// The frame that an elastic body's supports stand in: it needs supports, and turns by a table alone.
void check_frame(CaseTable t, const Parameters& p) {
  CaseTable free = t.table("free"), lumped = t.table("lumped");
  const char* no_turn = "false: supports turn by a table alone; a body without supports turns by itself";
  if (p.free.angle) throw free.error("angle", no_turn, "leave it out, or structure.solver = \"rigid\"");
  if (p.free.rotation) throw free.error("rotation", no_turn, "leave it out, or structure.solver = \"rigid\"");
  if (p.motion && p.motion->turns()) check_turning(t, p);
  const bool supported = has_supports(elastic_solid(p));
  const char* floats = "nothing: the body has no supports, it floats and moves by its own inertia";
  const char* remedy = "structure.plate.supports, or supports of its boxes or mesh";
  if (p.motion && !supported) throw t.table("motion").error("file", floats, remedy);
  if (p.body.lumped_mass == 0) return;
  if (!supported) throw lumped.error("mass", floats, remedy);
  if (!p.free.translates())
    throw lumped.error("mass", "0: the supports are driven, whatever their mass", "structure.free.y = true");
}

/// Keys with their default values, as in the resolved case of a run, count as not given.
bool says_something(std::string_view key, const Parameters& p) {
  if (key == "angular_velocity") return p.angular_velocity != 0;
  return true;
}

void check_body(CaseTable t, const CommonKeys& common, const Parameters& p) {
  for (const char* key :
       {"mass", "inertia", "inertia_axes", "centre_of_gravity", "angular_velocity", "pivot"})
    if (t.has(key) && says_something(key, p) && p.kind != "rigid" && p.kind != "replay" &&
        !(key == std::string_view("pivot") && p.motion && p.motion->turns()))
      throw t.error(
          key, fmt::format("nothing: it belongs to rigid bodies, and structure.solver is \"{}\"", p.kind),
          key == std::string_view("mass")
              ? "lumped.mass = what stands on the supports, beside the cells' own; or structure.solver = "
                "\"rigid\""
              : fmt::format("leave {} out, or structure.solver = \"rigid\"", key));
  if (p.kind != "rigid" && p.kind != "replay") check_frame(t, p);
  CaseTable free = t.table("free");
  if (p.dimension == 2) {
    const char* solid = "false: there is no such motion in two dimensions";
    if (p.free.z) throw free.error("z", solid, "z = false, or fluid.dimension = 3");
    if (p.free.rotation) throw free.error("rotation", solid, "angle = true is the turn in the plane");
    if (p.body.inertia_axes)
      throw t.error("inertia_axes", "nothing in two dimensions", "inertia = the moment about z");
  }
  if (p.free.angle && p.free.rotation)
    throw free.error("angle", "one of angle and rotation: rotation holds the turn about z",
                     "leave angle out");
  if (p.pivot && p.free.translates())
    throw t.error("pivot", "nothing: a body that is free to move turns about its centre of gravity",
                  "leave pivot out, or structure.free.x = y = z = false");
  if (p.body.inertia_axes) {
    const Eigen::Vector3d& j = *p.body.inertia_axes;
    if (j.minCoeff() <= 0 || 2 * j.maxCoeff() > j.sum() * (1 + 1e-9))
      throw t.error("inertia_axes", "three numbers greater than 0, none larger than the sum of the other two",
                    "leave inertia_axes out: it follows from the shape");
  }
  if (p.shape.kind != ShapeKind::plate && p.shape.kind != ShapeKind::solid &&
      p.load.kind == LoadKind::traction)
    throw t.table("load").error(
        "kind", "point or none: only plates, boxes and meshes have faces that a traction could name",
        "kind = \"point\"");
  check_motion(t, common, p);
}

}  // namespace

void read_shape(const CaseFile& file, CaseTable t, Parameters& p) {
  std::vector<std::string> given;
  t.knows({"box", "wedge", "cylinder", "sphere"});
  for (const std::string name : {"box", "mesh", "outline", "offsets", "wedge", "cylinder", "sphere"})
    if (t.has(name)) given.push_back(name);
  const bool all = file.only_declares();
  if (!all && !given.empty() && t.has("plate")) given.insert(given.begin(), "plate");
  if (!all && given.size() > 1)
    throw t.error(given[1], fmt::format("one shape, and structure.{} is given too", given[0]),
                  "leave one of them out");

  if (all || given.empty()) read_plate(t.table("plate", "rectangle in the xy-plane"), p.plate);
  read_outline(t, p.shape);
  if (std::vector<Eigen::Vector2d> section = read_offsets(file, t); !section.empty()) {
    p.shape.kind = ShapeKind::polygon;
    p.shape.corner = std::move(section);
  }
  if (all || t.has("wedge")) read_wedge(t.table("wedge", "rigid wedge, apex down"), p.shape);
  if (all || t.has("cylinder"))
    read_round(t.table("cylinder", "rigid cylinder, its axis along z"), ShapeKind::cylinder, p.shape);
  if (all || t.has("sphere"))
    read_round(t.table("sphere", "rigid sphere, three dimensions"), ShapeKind::sphere, p.shape);
  t.number(
      "depth", p.shape.depth,
      positive("m",
               "three dimensions: how far a plate, outline, section, wedge or cylinder reaches along z"));
  if (all) return;

  if (given.empty() && p.plate.hollow != 0) read_hollow_plate(t, p);
  const bool tilted = given.empty() && p.plate.angle != 0 && p.plate.hollow == 0;
  if (t.has("box") || t.has("mesh") || tilted) p.shape.kind = ShapeKind::solid;
  const bool body = p.shape.kind == ShapeKind::solid;
  if (p.shape.kind == ShapeKind::plate || tilted) p.shape.middle = p.plate.bottom.z();
  if (p.shape.kind != ShapeKind::plate && !body && p.kind != "rigid" && p.kind != "replay")
    throw t.error("solver",
                  fmt::format("\"rigid\": {} structures have the shape of structure.plate, structure.box or "
                              "structure.mesh, not of "
                              "structure.{}",
                              p.kind, given[0]),
                  "structure.solver = \"rigid\", or structure.plate");
  const bool solid = p.dimension == 3, sphere = p.shape.kind == ShapeKind::sphere;
  if (sphere && !solid)
    throw t.error("sphere", "a shape of the plane: fluid.dimension is 2",
                  "structure.cylinder, or fluid.dimension = 3");
  if (solid && !sphere && (!body || tilted) && p.shape.depth == 0)
    throw t.error("depth", "a length along z: fluid.dimension is 3", "depth = 1.0");
  if (solid && t.has("depth") && (sphere || (body && !tilted)))
    throw t.error("depth", "nothing: a box, a mesh and a sphere have their own lengths along z",
                  "leave it out");
  if (!solid) p.shape.depth = p.shape.middle = 0;
  if (!body) check_outline(t, p, given.empty() ? "plate" : given[0]);
}

void read_initial_velocity(const CaseFile& file, CaseTable structure, Parameters& p) {
  const bool all = file.only_declares();
  CaseTable t = structure.table(
      "initial_velocity", "of an elastic body at t = 0, relative to its supports, beside structure.velocity");
  t.vector("value", p.initial.value, {.unit = "m/s", .help = "of all that is not held"});
  std::filesystem::path path;
  if (all || t.has("file"))
    t.file(
        "file", path,
        {.help =
             "added to it: columns x, y or z [m], ascending, and vx, vy, vz [m/s] there, joined by a cubic "
             "spline"});
  if (!path.empty()) {
    const VelocityProfile read = read_velocity_profile(path);
    p.initial.profile = read.velocity;
    p.initial.along = read.axis;
  }
  if (all || (p.kind != "rigid" && p.kind != "replay")) return;
  if (!p.initial.value.isZero() || p.initial.profile)
    throw structure.error("initial_velocity",
                          fmt::format("nothing: a {} body starts with structure.velocity", p.kind),
                          "leave it out, or structure.solver = \"fem\" or \"particle\"");
}

void read_body(const CaseFile& file, CaseTable t, const CommonKeys& common, Parameters& p) {
  const bool all = file.only_declares();
  BodyMass& body = p.body;
  t.number(
      "mass", body.mass,
      positive("kg",
               "of a rigid body, in two dimensions per metre of depth; not given: material.density times "
               "its volume"));
  t.number(
      "inertia", body.inertia,
      positive("kg m^2", "of a rigid body about z through its centre of gravity; not given: of the shape"));
  const auto optional_vector = [&](const char* name, std::optional<Eigen::Vector3d>& value, const char* unit,
                                   const char* help) {
    Eigen::Vector3d given = Eigen::Vector3d::Zero();
    if (!all && !t.has(name)) return;
    t.vector(name, given, {.unit = unit, .required = true, .conditional = true, .help = help});
    if (!all) value = given;
  };
  optional_vector("inertia_axes", body.inertia_axes, "kg m^2",
                  "of a rigid body about x, y and z through its centre of gravity; three dimensions");
  optional_vector("centre_of_gravity", body.centre, "m", "of a rigid body; not given: of the shape");
  CaseTable lumped = t.table(
      "lumped",
      "a point mass that a rigid body carries; of an elastic body that of the frame its supports stand in");
  lumped.number("mass", body.lumped_mass,
                {.unit = "kg",
                 .min = 0,
                 .help = "beside that of the body, in two dimensions per metre of depth; 0: none"});
  lumped.vector("at", body.lumped_at,
                {.unit = "m", .help = "where it sits; of no account for a frame, which does not turn"});

  t.number("angular_velocity", p.angular_velocity,
           {.unit = "rad/s", .help = "of a rigid body about z, counter-clockwise; of a free one at t = 0"});
  optional_vector("pivot", p.pivot, "m",
                  "about which a rigid body turns; not given: its centre of gravity; or the supports of an "
                  "elastic one, by "
                  "the table");
  CaseTable motion =
      t.table("motion", "motion of a rigid body, or of an elastic body's supports, by a table");
  if (all || motion.has("file")) {
    std::filesystem::path path;
    motion.file("file", path,
                {.help = "columns t [s] and x, y, z [m], angle [deg], or their rates vx, vy, vz [m/s], rate "
                         "[deg/s]; counted from the place at t = 0"});
    if (!path.empty()) p.motion = read_motion(path);
  }
  CaseTable free = t.table(
      "free", "which motions of a rigid body, or of an elastic body's supports, follow from the loads");
  free.flag("x", p.free.x, {.help = "moved by loads, not prescribed"});
  free.flag("y", p.free.y, {.help = "moved by loads, not prescribed"});
  free.flag("z", p.free.z, {.help = "moved by loads, not prescribed; three dimensions"});
  free.flag("angle", p.free.angle, {.help = "turned by loads about z, not prescribed"});
  free.flag("rotation", p.free.rotation, {.help = "turned by loads about all axes; three dimensions"});
  if (!all) check_body(t, common, p);
}

void read_loaded_faces(CaseTable t, bool only_declares, Parameters& p) {
  t.texts(
      "loaded_faces", p.loaded_faces,
      {.help = "faces that the water loads: left, right, bottom, top, back or front of the body, a physical "
               "name of its mesh, or PART.SIDE of a structure.box; others keep it out and feel nothing; "
               "[]: all of the outer surface"});
  std::vector<std::string> old_key;
  t.texts("wet", old_key, {.instead = "loaded_faces", .help = "name of loaded_faces before version 0.2"});
  if (only_declares) return;
  if (!old_key.empty() && !p.loaded_faces.empty())
    throw t.error("wet", "loaded_faces alone: wet is its older name", "leave wet out");
  p.loaded_by_old_key = !old_key.empty();
  if (p.loaded_by_old_key) p.loaded_faces = old_key;
  if (p.loaded_faces.empty()) return;
  const std::string key = p.loaded_by_old_key ? "wet" : "loaded_faces";
  const auto refuse = [&](const std::string& expected, const std::string& fix) {
    throw t.error(key, expected, fix);
  };
  if (p.interface == "volume")
    refuse("nothing: in volume coupling every particle of the body meets the water",
           "coupling.interface = \"surface\", or leave " + key + " out");
  if (p.shape.kind != ShapeKind::plate && p.shape.kind != ShapeKind::solid)
    refuse("nothing: only plates, boxes and meshes have faces with names", "leave " + key + " out");
  if (p.kind == "ccx" && !p.load_run.empty())
    refuse("nothing: CalculiX reads a recorded load itself, all of it",
           "structure.solver = \"fem\", or leave " + key + " out");
  const Solid solid = elastic_solid(p);
  std::vector<std::string> known(side_names.begin(), side_names.begin() + (p.dimension == 3 ? 6 : 4));
  for (const SupportedFace& face : solid.supported) known.push_back(face.name);
  for (const std::string& name : p.loaded_faces) {
    if (!facets_named(solid, name).empty()) continue;
    const std::string near = did_you_mean(name, known);
    refuse(fmt::format("faces at the body's boundary, and \"{}\" is none: {}, or PART.SIDE", name,
                       joined(known)),
           near.empty() ? key + " = [\"bottom\"]" : fmt::format("did you mean \"{}\"?", near));
  }
}

}  // namespace strake::structure
