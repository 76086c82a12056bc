#include "structure/case/read_parameters.hpp"

#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"
#include "structure/body/size.hpp"
#include "structure/body/surface.hpp"
#include "structure/body/wall.hpp"
#include "structure/case/keys.hpp"
#include "structure/failure/softening.hpp"
#include "structure/particle/failure.hpp"
#include "structure/particle/lattice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake::structure {
namespace {

void read_shared(CaseFile& file, const CommonKeys& common, Parameters& p) {
  p.interface = common.interface;
  p.threads = common.threads;
  CaseTable t = file.root().table("fluid");
  t.integer("dimension", p.dimension,
            {.min = 2, .max = 3, .help = "2: xy-plane, plane strain, per metre of depth"});
  t.number("spacing", p.fluid_spacing, positive("m", "initial particle distance l0"));
  t.number("density", p.fluid_density, positive("kg/m^3", "of the fluid"));
  // A structure without a fluid has no gravity unless the case gives one.
  p.gravity = common.fluid_solver == "none" ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(0, -9.81, 0);
  t.vector("gravity", p.gravity,
           {.unit = "m/s^2", .help = "body force on the structure too; zero when fluid.solver is none"});
  t.number("gravity_ramp", p.gravity_ramp,
           {.unit = "s", .min = 0, .help = "gravity rises as (1 - cos(pi t/ramp))/2; 0: at once"});
}

void read_load(CaseTable t, CaseLoad& load) {
  t.choice("kind", load.kind,
           {{"none", LoadKind::none}, {"traction", LoadKind::traction}, {"point", LoadKind::point}},
           {.help = "load of the case itself, beside the fluid's"});
  t.vector("value", load.value,
           {.unit = "Pa | N/m", .help = "traction on the face, or force per metre of depth"});
  t.text("face", load.face,
         {.help =
              "where a traction acts: left, right, bottom, top, back or front of the body, or PART.SIDE of a "
              "structure.box"});
  t.vector("at", load.at,
           {.unit = "m", .help = "where a point force acts: the nearest point of the outline"});
  t.number("ramp", load.ramp, {.unit = "s", .min = 0, .help = "rises as (1 - cos(pi t/ramp))/2; 0: at once"});
}

void read_particle(CaseTable t, ParticleKeys& particle, bool volume) {
  particle.model = volume ? ParticleModel::pair : ParticleModel::total_lagrangian;
  particle.spacing = 0;
  t.number(
      "spacing", particle.spacing,
      {.unit = "m",
       .min = 0,
       .help = "surface coupling; 0: four layers across the walls, and forty particles along the longest "
               "side; volume coupling uses fluid.spacing"});
  t.choice("model", particle.model,
           {{"pair", ParticleModel::pair}, {"total_lagrangian", ParticleModel::total_lagrangian}},
           {.help = "volume coupling: pair unless given"});
  t.choice("rotation", particle.rotation,
           {{"kinematic", Rotation::kinematic}, {"dynamic", Rotation::dynamic}},
           {.help = "pair: kinematic: of the neighbourhood; dynamic: with an inertia of its own, angular "
                    "momentum is exact"});
  t.number(
      "radius", particle.radius,
      {.unit = "spacing", .min = 1.5, .max = 4.1, .help = "reach r_e of the bonds; keep off whole numbers"});
  t.number("hourglass", particle.hourglass,
           {.min = 0, .max = 10, .help = "alpha of the hourglass energy; total_lagrangian only"});
  particle.clamp = particle.model == ParticleModel::pair ? ClampColumn::outside : ClampColumn::inside;
  t.choice(
      "clamp", particle.clamp, {{"inside", ClampColumn::inside}, {"outside", ClampColumn::outside}},
      {.help =
           "first fixed column of a clamped end: the last inside the span (total_lagrangian), or the first "
           "outside (pair)"});
  t.number("safety", particle.safety,
           {.min = 0, .max = 1, .exclusive = true, .help = "sub-step over the elastic limit"});
}

void read_ccx(CaseTable t, CalculixKeys& ccx) {
  t.choice(
      "calls", ccx.calls,
      {{"auto", CalculixCalls::automatic}, {"window", CalculixCalls::window}, {"once", CalculixCalls::once}},
      {.help = "window: CalculiX is started for each window and goes on from its restart file; once: for a "
               "whole run whose load is known beforehand; auto: once where fluid.solver is replay or none"});
  t.number("answer_within", ccx.answer_within,
           positive("s", "wall clock that CalculiX has for an increment"));
}

/// Reads from the coupler's and the fluid's tables what the load will be.
void read_load_to_come(CaseFile& file, const CommonKeys& common, Parameters& p) {
  p.fluid_none = common.fluid_solver == "none";
  p.end_time = common.end_time;
  p.window = common.window;
  p.output_every = common.output_every;
  p.probes = common.probes;
  if (common.fluid_solver != "replay" || p.kind != "ccx") return;
  std::string run;
  file.root()
      .table("fluid")
      .table("replay", "fluid.solver = replay")
      .text("run", run, {.path = true, .help = "run folder whose recorded interface force is played back"});
  p.load_run = run;
}

void check_ccx(CaseTable structure, Parameters& p) {
  CaseTable t = structure.table("ccx");
  const bool known = p.fluid_none || !p.load_run.empty();
  if (p.ccx.calls == CalculixCalls::automatic)
    p.ccx.calls = known ? CalculixCalls::once : CalculixCalls::window;
  if (p.ccx.calls == CalculixCalls::once && !known)
    throw t.error("calls", "window: the load of a computed fluid is not known beforehand",
                  "strake replay RUN --onto CASE --set structure.solver=ccx takes a recorded one");
  if (p.fem.rho_infinity != 1)
    throw structure.table("fem").error("rho_infinity", "1: CalculiX steps with Newmark 1/4-1/2 here",
                                       "leave rho_infinity out, or structure.solver = \"fem\"");
}

void read_failure(CaseTable t, FailureKeys& failure) {
  t.choice(
      "criterion", failure.criterion,
      {{"none", FailureCriterion::none},
       {"bond_strain", FailureCriterion::bond_strain},
       {"max_principal", FailureCriterion::max_principal},
       {"von_mises", FailureCriterion::von_mises}},
      {.help =
           "bond_strain: particles, bonds break at a strain of their own (pair: with rotation = dynamic); a "
           "stress that softens first: total_lagrangian particles and fem"});
  t.number(
      "fracture_energy", failure.fracture_energy,
      {.unit = "J/m^2", .min = 0, .help = "G_c that a crack takes per area; bond_strain: of the pair model"});
  t.number("strength", failure.strength,
           {.unit = "Pa", .min = 0, .help = "stress at which softening begins; max_principal and von_mises"});
  t.number(
      "critical_strain", failure.critical_strain,
      {.min = 0, .max = 10, .help = "bond_strain: at which a bond breaks; not given: from fracture_energy"});
}

void check_softening(CaseTable t, const FailureKeys& f) {
  if (f.strength == 0 || f.fracture_energy == 0)
    throw t.error(f.strength == 0 ? "strength" : "fracture_energy", "a number greater than 0",
                  "strength in Pa and fracture_energy in J/m^2");
}

/// Finite elements. The mesh decides whether softening ends later than it begins, so this is checked there.
void check_cell_failure(CaseTable t, const Parameters& p) {
  if (p.failure.criterion == FailureCriterion::bond_strain)
    throw t.error("criterion", "max_principal or von_mises: finite elements have no bonds",
                  "criterion = \"max_principal\" with strength and fracture_energy");
  if (p.damping.stiffness > 0)
    throw t.error("criterion",
                  "none: structure.damping.stiffness is that of the intact body, and would hold a crack shut",
                  "structure.damping.mass in its place");
  if (p.fem.strain == StrainField::enhanced || p.fem.strain == StrainField::solid_shell)
    throw t.error("criterion", "none: a cell that softens has the strains of its displacement alone",
                  "structure.fem.strain = \"compatible\" or \"auto\"");
  check_softening(t, p.failure);
}

/// Checks the keys of a criterion, and that softening ends later than it begins on this lattice. A solver
/// without failure runs the case with the body intact, and says so; so the solver can be swapped by one word.
void check_failure(CaseTable t, Parameters& p) {
  if (p.failure.criterion != FailureCriterion::none && p.kind != "particle" && p.kind != "fem") {
    p.failure.criterion = FailureCriterion::none;
    p.stays_intact = true;
  }
  const FailureKeys& f = p.failure;
  if (f.criterion == FailureCriterion::none) return;
  if (p.analysis != Analysis::dynamic)
    throw t.error("criterion", "none: statics and modes are those of the intact body",
                  "structure.analysis = \"dynamic\"");
  if (p.kind == "fem") {
    check_cell_failure(t, p);
    return;
  }
  const bool pair = p.particle.model == ParticleModel::pair;
  if (pair && f.criterion != FailureCriterion::bond_strain)
    throw t.error("criterion", "bond_strain: the pair model has no stress of a particle to soften",
                  "structure.particle.model = \"total_lagrangian\"");
  if (pair && p.particle.rotation == Rotation::kinematic)
    throw t.error("criterion",
                  "none: with the rotation of the neighbourhood a fragment of few bonds spins itself up and "
                  "makes energy",
                  "structure.particle.rotation = \"dynamic\"");
  if (f.criterion == FailureCriterion::bond_strain) {
    if (f.critical_strain > 0) return;
    if (!pair)
      throw t.error("critical_strain",
                    "a number greater than 0: a bond of total_lagrangian has no energy of its own that "
                    "fracture_energy could be told from",
                    "critical_strain = 0.01, or criterion = \"max_principal\"");
    if (f.fracture_energy == 0)
      throw t.error("fracture_energy", "a number greater than 0, or critical_strain",
                    "critical_strain = 0.01");
    return;
  }
  check_softening(t, f);
  const double band =
      crack_band(p.dimension, p.particle.radius, p.particle.hourglass).width * p.particle.spacing;
  for (const Part& part : elastic_solid(p).parts) {
    const double most = widest_band(f, part.material, p.dimension);
    if (band >= most)
      throw t.error("fracture_energy",
                    fmt::format("more than {:.4g} J/m^2 on this lattice: a band of {:.4g} m holds as much "
                                "elastic energy at the strength already",
                                f.fracture_energy * band / most, band),
                    fmt::format("structure.particle.spacing below {:.4g}", p.particle.spacing * most / band));
  }
}

bool divides(double part, double whole) {
  const double n = whole / part;
  return std::abs(n - std::round(n)) < 1e-6 * n;  // decimals of a case file, not physics
}

void check_plate_lattice(CaseTable plate, const std::string& source, const Parameters& p) {
  const double d = p.particle.spacing;
  const std::string asked =
      fmt::format("structure.plate.thickness / {} = {:.6g}", source, p.plate.thickness / d);
  if (!divides(d, p.plate.thickness) || p.plate.thickness / d < 2 - 1e-6)
    throw plate.error("thickness", fmt::format("a whole number of particle layers, at least 2 ({})", asked),
                      fmt::format("{} = {:.6g}  (4 layers)", source, p.plate.thickness / 4));
  if (!divides(d, p.plate.length))
    throw plate.error("length",
                      fmt::format("a whole number of particle columns (structure.plate.length / {} = {:.6g})",
                                  source, p.plate.length / d));
}

/// The lattice must fill the shape, or the comparison with other solvers would compare two bodies.
void check_lattice(const CaseFile& file, CaseTable structure, const CommonKeys& common, Parameters& p) {
  const bool volume = common.interface == "volume";
  if (volume) p.particle.spacing = p.fluid_spacing;
  if (p.particle.spacing == 0) p.particle.spacing = particle_spacing(elastic_solid(p));
  const std::string source = volume ? "fluid.spacing" : "structure.particle.spacing";
  if (p.shape.kind == ShapeKind::plate) check_plate_lattice(structure.table("plate"), source, p);
  CaseTable t = structure.table("particle");
  refuse_oversized(file, lattice_sizes(p));  // before a lattice is built to check it
  if (const SolidFault fault = lattice_fault(elastic_solid(p), p.particle.spacing); !fault.problem.empty())
    throw t.error("spacing", "a lattice that fills the body: " + fault.problem, fault.fix);
  if (p.dimension == 3 && p.particle.model == ParticleModel::pair)
    throw t.error("model",
                  "total_lagrangian in three dimensions: the pair model has the rotation of the plane",
                  "model = \"total_lagrangian\"");
  if (p.particle.rotation == Rotation::dynamic && p.particle.model != ParticleModel::pair)
    throw t.error("rotation",
                  "kinematic: total_lagrangian has no rotation of its own and keeps angular momentum",
                  "leave rotation out, or model = \"pair\"");
  if (p.particle.rotation == Rotation::dynamic && p.analysis != Analysis::dynamic)
    throw t.error("rotation", "kinematic: statics and modes have no spin", "rotation = \"kinematic\"");
  if (p.damping.stiffness > 0)
    throw structure.table("damping").error("stiffness", "0: particles have mass-proportional damping only",
                                           "structure.solver = \"fem\"");
}

void check_face(CaseTable load, const Parameters& p) {
  const Solid solid = elastic_solid(p);
  if (!facets_named(solid, p.load.face).empty()) return;
  std::string parts;
  for (const Part& part : solid.parts) parts += (parts.empty() ? "" : ", ") + part.name;
  throw load.error("face",
                   "a side of the body at its boundary: left, right, bottom, top" +
                       std::string(p.dimension == 3 ? ", back, front" : "") + ", or PART.SIDE of " + parts,
                   "face = \"top\"");
}

/// A probe of the structure measures a material point, so it must be one.
void check_probes(const CaseFile& file, const CommonKeys& common, const Parameters& p) {
  for (const ProbeKeys& probe : common.probes) {
    if (probe.of != "structure" || is_in_body(p, probe.at)) continue;
    const Box box = bounds(p);
    throw Error(
        ExitCode::case_file, fmt::format("{}: output.probe \"{}\"", file.path().string(), probe.name),
        fmt::format("at = [{:.6g}, {:.6g}] lies outside the {} (x {:.6g} to {:.6g} m, y {:.6g} to {:.6g} m)",
                    probe.at.x(), probe.at.y(), p.shape.kind == ShapeKind::plate ? "plate" : "body",
                    box.min.x(), box.max.x(), box.min.y(), box.max.y()),
        fmt::format("move the probe onto the {}", p.shape.kind == ShapeKind::plate ? "plate" : "body"));
  }
}

/// Whether anything holds the body: of a plate so that no rigid motion is left. Finite elements look for
/// rigid motions of other bodies themselves.
bool is_constrained(const Parameters& p) {
  if (!p.solid.empty()) return p.kind != "particle" || has_supports(p.solid);
  if (p.plate.left == Support::clamped || p.plate.right == Support::clamped) return true;
  return p.plate.left != Support::free && p.plate.right != Support::free;
}

/// A body of an elastic solver has a part that can deform.
void refuse_held_whole(CaseTable structure, const Parameters& p) {
  const auto held = [](const Part& part) { return part.constrained; };
  if (p.kind == "rigid" || p.kind == "replay" || p.solid.parts.empty()) return;
  if (std::ranges::all_of(p.solid.parts, held))
    throw structure.error("solver", "\"rigid\": all parts of the body are held, and nothing of it can deform",
                          "structure.solver = \"rigid\", or leave a part free");
}

void check_together(CaseFile& file, const CommonKeys& common, CaseTable structure, Parameters& p) {
  check_ranks(structure, p);
  refuse_held_whole(structure, p);
  if (file.is_right()) refuse_outside_tank(file, structure, common, p);  // not the form of a stand-in value
  if (common.interface == "volume" && p.kind != "particle")
    throw file.root()
        .table("coupling")
        .error("interface",
               fmt::format("surface: volume coupling moves particles, and structure.solver is {}", p.kind),
               "structure.solver = \"particle\", or coupling.interface = \"surface\"");
  if (p.analysis != Analysis::dynamic && (p.kind == "rigid" || p.kind == "replay"))
    throw structure.error("analysis",
                          fmt::format("dynamic: a {} structure has no statics and no modes", p.kind),
                          "structure.solver = \"fem\" or \"particle\"");
  if (p.analysis != Analysis::dynamic && p.kind != "rigid" && p.kind != "replay" && p.free.any())
    throw structure.table("free").error(
        p.free.x   ? "x"
        : p.free.y ? "y"
                   : "z",
        "false: statics and modes are those of a body whose supports are at rest",
        "leave structure.free out");
  if (p.analysis == Analysis::statics && !is_constrained(p))
    throw structure.error("analysis", "dynamic or modal: without enough supports there is no equilibrium",
                          p.shape.kind == ShapeKind::plate
                              ? "structure.plate.supports = { left = \"clamped\", right = \"clamped\" }"
                              : "[[structure.support]] with on = \"left\" and kind = \"clamped\"");
  if (p.load.kind == LoadKind::traction) check_face(structure.table("load"), p);
  if (p.kind == "particle") check_lattice(file, structure, common, p);
  if (p.kind == "fem" || p.kind == "ccx") check_fem(structure.table("fem"), p);
  if (p.kind == "ccx") check_ccx(structure, p);
  check_failure(structure.table("failure"), p);
  check_probes(file, common, p);
  if (p.analysis != Analysis::dynamic && common.fluid_solver != "none")
    throw structure.error("analysis",
                          fmt::format("dynamic: statics and modes take no force of the water, and "
                                      "fluid.solver is \"{}\"",
                                      common.fluid_solver),
                          "fluid.solver = \"none\" for the body alone, or structure.analysis = \"dynamic\"");
}

}  // namespace

Parameters read(CaseFile& file, const std::string& kind) {
  return read(file, kind, read_common(file));
}

Parameters read(CaseFile& file, const std::string& kind, const CommonKeys& common) {
  Parameters p;
  p.kind = kind;
  read_shared(file, common, p);
  read_load_to_come(file, common, p);

  CaseTable t = file.root().table("structure");
  t.vector("velocity", p.velocity,
           {.unit = "m/s", .help = "of the supports, and of the whole body at t = 0"});
  p.surface_spacing = p.fluid_spacing;
  t.number(
      "surface_spacing", p.surface_spacing,
      positive("m", "distance of the interface points, the same for every solver; default fluid.spacing"));
  read_ranks(t, p);
  if (p.ranks > 1) p.threads = threads_of_rank(common, p.ranks, processors_here());
  t.choice("analysis", p.analysis,
           {{"dynamic", Analysis::dynamic}, {"static", Analysis::statics}, {"modal", Analysis::modal}},
           {.help = "static: equilibrium under the case's own load; modal: natural frequencies; both with "
                    "fluid.solver = none"});
  read_shape(file, t, p);
  t.choice("plane", p.material.plane_stress, {{"strain", false}, {"stress", true}},
           {.help = "two dimensions: strain, no motion across the plane (a long hull); stress, no load "
                    "across it (a thin "
                    "sheet)"});
  if (p.material.plane_stress && p.dimension == 3 && !file.only_declares())
    throw t.error("plane", "strain: fluid.dimension is 3", "leave plane out");
  read_material(t.table("material"), p.material);
  read_solid(file, t, p);
  read_load(t.table("load"), p.load);
  read_loaded_faces(t, file.only_declares(), p);
  CaseTable damping = t.table("damping", "Rayleigh");
  damping.number("mass", p.damping.mass, {.unit = "1/s", .min = 0, .help = "mass-proportional"});
  damping.number("stiffness", p.damping.stiffness, {.unit = "s", .min = 0, .help = "stiffness-proportional"});
  read_fem(t.table("fem", "structure.solver = fem or ccx"), p.dimension, p.fem);
  read_particle(t.table("particle", "structure.solver = particle"), p.particle, common.interface == "volume");
  read_ccx(t.table("ccx", "structure.solver = ccx: CalculiX on the mesh of structure.fem"), p.ccx);
  read_failure(t.table("failure", "what breaks a body"), p.failure);
  CaseTable replay = t.table("replay", "structure.solver = replay");
  std::string run;
  replay.text("run", run,
              {.path = true, .help = "run folder whose recorded interface motion is played back"});
  p.replay_run = run;
  if (kind == "replay" && run.empty() && !file.only_declares())
    throw replay.error("run", "the folder of a run with interface/*.h5",
                       "structure.replay.run = \"runs/plate_entry\"");

  read_body(file, t, common, p);
  read_initial_velocity(file, t, p);

  if (!file.only_declares()) check_together(file, common, t, p);
  return p;
}

}  // namespace strake::structure
