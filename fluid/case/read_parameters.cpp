#include "fluid/case/read_parameters.hpp"

#include "fluid/boundary/fill.hpp"
#include "fluid/case/tank_keys.hpp"
#include "fluid/least_squares/compressible_layer.hpp"
#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::fluid {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double most_steps = 1e7;  // in a window; no case needed a thousandth of that
constexpr double arc_radius = 2.1;  // [l0] reach of the arc test

void read_water(CaseTable t, Parameters& p) {
  t.integer("dimension", p.dimension, {.min = 2, .max = 3, .help = "2: xy-plane, per metre of depth"});
  t.number(
      "spacing", p.spacing,
      {.unit = "m", .min = 0, .exclusive = true, .required = true, .help = "initial particle distance l0"});
  t.number("density", p.density, {.unit = "kg/m^3", .min = 0, .exclusive = true, .help = "of the water"});
  t.number("kinematic_viscosity", p.kinematic_viscosity,
           {.unit = "m^2/s", .min = 0, .help = "nu of the water"});
  t.vector("gravity", p.gravity, {.unit = "m/s^2", .help = "body force on the water"});
  t.number("gravity_ramp", p.gravity_ramp,
           {.unit = "s", .min = 0, .help = "gravity rises as (1 - cos(pi t/ramp))/2; 0: at once"});
  t.number(
      "sound_speed", p.sound_speed,
      {.unit = "m/s",
       .min = 0,
       .exclusive = true,
       .infinite = true,
       .paper = infinity,
       .help =
           "of the water; inf: incompressible, where the pressure of a flat impact grows as 1/time_step"});
  t.number("sound_depth", p.sound_depth,
           {.unit = "m",
            .min = 0,
            .exclusive = true,
            .infinite = true,
            .help = "water less deep than this has sound_speed, deeper water is incompressible; sound that "
                    "comes down to there goes on without an echo (the water yields by (p - rho g depth)/(rho "
                    "c) over 4 l0); inf: all of it"});
}

void read_radii(CaseTable t, Scheme& s) {
  const auto radius = [&](const char* name, double& value, const char* help) {
    t.number(name, value, {.unit = "l0", .min = 1.5, .max = 6, .help = help});
  };
  radius("density", s.radius_density, "of the number density and the surface test");
  radius("gradient", s.radius_gradient, "of the pressure and the velocity gradient");
  radius("divergence", s.radius_divergence, "of the divergence");
  radius("laplacian", s.radius_laplacian, "of the viscous term and the pressure equation");
}

/// Reads gamma and tau, two ways to give one strength. The one that is given sets the other's default to 0.
void read_source(CaseTable t, Scheme& s) {
  t.choice(
      "kind", s.source, {{"mixed", Source::mixed}, {"divergence", Source::divergence}},
      {.help = "right-hand side of the pressure equation: divergence with a share of density, or alone"});
  t.choice("density_at", s.density_at, {{"old", DensityAt::old}, {"star", DensityAt::star}},
           {.help = "number density of the source at the start of the step, or after the explicit stage"});
  NumberKey gamma{
      .min = 0, .max = 1, .paper = 0.01, .help = "share of the density error removed per step; or tau"};
  NumberKey tau{.unit = "s",
                .min = 0,
                .paper = 0.0,
                .help =
                    "time in which the density error decays, gamma = time step / tau; of least-squares at "
                    "least spacing / speed of water and waves"};
  if (t.has("gamma") && !t.has("tau")) {
    s.tau = 0;
    tau.paper = 0;
  }
  if (t.has("tau") && !t.has("gamma")) gamma.paper = 0;
  t.number("gamma", s.gamma, gamma);
  t.number("tau", s.tau, tau);
  if (s.gamma > 0 && s.tau > 0) throw t.error("gamma", "gamma or tau, not both", "gamma = 0, or tau = 0");
}

void read_surface(CaseTable t, Scheme& s) {
  t.number("beta", s.beta,
           {.min = 0.5, .max = 1, .help = "a particle with n < beta n0 may be surface; `none`: it is"});
  t.choice("second", s.second, {{"arc", SecondCriterion::arc}, {"none", SecondCriterion::none}},
           {.paper = "none", .help = "what must hold as well: an uncovered arc"});
}

void read_anti_penetration(CaseTable t, Scheme& s) {
  t.choice(
      "kind", s.anti_penetration,
      {{"collision", AntiPenetration::collision},
       {"average", AntiPenetration::average},
       {"none", AntiPenetration::none}},
      {.paper = "average", .help = "water too near a solid: two-body collision, or the mean of velocities"});
  t.number("distance", s.collision_distance,
           {.unit = "l0",
            .min = 0,
            .max = 1,
            .help = "too near is nearer than this; 0.85 but with least-squares"});
  t.number("restitution", s.restitution, {.min = 0, .max = 1, .help = "of the collision"});
  t.flag(
      "conserve", s.collision_conserve,
      {.paper = false, .help = "the body feels what the water lost; else the paper's fluid-only correction"});
}

void read_pressure(CaseTable t, Scheme& s) {
  std::string solver = "cg";
  t.choice("solver", solver, {"cg"},
           {.help = "conjugate gradients; \"cholmod\" and \"hypre\" were removed in version 0.2"});
  t.choice("preconditioner", s.preconditioner,
           {{"auto", Preconditioner::automatic},
            {"multilevel", Preconditioner::multilevel},
            {"jacobi", Preconditioner::jacobi}},
           {.help = "of cg: grids over the particles' cells, or the diagonal; auto: diagonal where "
                    "compressibility makes it enough, else grids; \"ic\" was removed in version 0.2"});
  t.number("tolerance", s.pressure_tolerance,
           {.min = 0,
            .max = 1e-2,
            .exclusive = true,
            .help = "residual over right-hand side, 2-norms |b - A p| / |b|"});
  t.integer("max_iterations", s.pressure_max_iterations, {.min = 1, .help = "of cg, per step"});
}

/// Reads the constants of turbulence, C_s = (C_ν³/C_ε)^¼. A given cs sets the default of c_eps, and the other
/// way round.
void read_turbulence(CaseTable t, Scheme& s) {
  t.choice("model", s.turbulence,
           {{"static", Turbulence::statics}, {"k", Turbulence::k}, {"none", Turbulence::none}},
           {.help = "sub-particle-scale model: local equilibrium, or an equation for its energy k"});
  t.choice(
      "sps", s.sps, {{"joint", SpsForm::joint}, {"stress_pair", SpsForm::stress_pair}},
      {.paper = "stress_pair", .help = "viscous sum: one for nu and the model, or stress pairs beside nu's"});
  t.number("c_nu", s.c_nu, {.min = 0, .exclusive = true, .help = "eddy viscosity = c_nu l0 sqrt(k)"});
  const NumberKey eps{.min = 0, .exclusive = true, .help = "dissipation = c_eps k^1.5 / l0"};
  const NumberKey smagorinsky{
      .min = 0, .exclusive = true, .help = "Smagorinsky's constant, (c_nu^3/c_eps)^0.25; give this or c_eps"};
  const double c_nu3 = std::pow(s.c_nu, 3);
  double cs = std::pow(c_nu3 / s.c_eps, 0.25);
  if (t.has("cs")) {
    t.number("cs", cs, smagorinsky);
    s.c_eps = c_nu3 / std::pow(cs, 4);
    t.number("c_eps", s.c_eps, eps);
  } else {
    t.number("c_eps", s.c_eps, eps);
    cs = std::pow(c_nu3 / s.c_eps, 0.25);
    t.number("cs", cs, smagorinsky);
  }
  constexpr double printed = 1e-6;  // a resolved case file writes both
  if (std::abs(std::pow(c_nu3 / s.c_eps, 0.25) - cs) > printed * cs)
    throw t.error("cs", fmt::format("(c_nu^3/c_eps)^0.25 = {:.6g}", std::pow(c_nu3 / s.c_eps, 0.25)),
                  "give cs or c_eps, not both");
  t.flag("wall_damping", s.wall_damping, {.help = "van Driest's factor near the tank's walls"});
}

/// Sets the default of the largest step and reads the key. A window shorter than the usual step becomes the
/// step. Without sound the step is the window, except in the paper preset: an incompressible impact is one
/// impulse. With shorter steps, the one that makes contact would depend on the interface motion that the
/// coupling has not found yet. With sound, steps that resolve it serve a level face alone. Elsewhere the flow
/// limits the step: shorter ones change the mean force by less than its scatter, and cost time.
void read_time_step(CaseTable& t, const CommonKeys& common, double sound_speed, bool level, Scheme& s) {
  const bool resolves_sound = level || common.preset == "paper" || common.interface == "volume";
  if (common.window > 0 && std::isinf(sound_speed) && common.preset != "paper")
    s.time_step = common.window;
  else if (!resolves_sound)
    s.time_step = std::numeric_limits<double>::infinity();
  else if (common.window > 0)
    s.time_step = std::min(s.time_step, common.window);
  t.number(
      "time_step", s.time_step,
      {.unit = "s",
       .min = 0,
       .exclusive = true,
       .infinite = true,
       .help =
           "largest; steps end with a window, and inf leaves them to the limits of stability; not given in "
           "preset improved: with sound_speed = inf the window, else inf unless a plate or box may fall "
           "level "
           "on the water"});
  t.number("acoustic_cfl", s.acoustic_cfl,
           {.min = 0,
            .help = "sound speed times time step over spacing, to resolve pressure waves; 0: no such limit"});
}

void read_scheme(CaseTable t, const CommonKeys& common, double sound_speed, bool level, Scheme& s) {
  read_radii(t.table("radius", "reach of each operator, in spacings"), s);
  read_time_step(t, common, sound_speed, level, s);
  // The solids of volume coupling take part in the pressure equation as particles.
  if (common.interface == "volume") s.gradient = Gradient::pairwise;
  t.choice(
      "gradient", s.gradient,
      {{"least-squares", Gradient::least_squares},
       {"pairwise", Gradient::pairwise},
       {"corrected", Gradient::corrected},
       {"min-pressure", Gradient::min_pressure}},
      {.paper = "min-pressure",
       .help =
           "pressure gradient: least-squares is exact for linear fields at walls and surface too (the other "
           "operators with it), pairwise keeps momentum; volume coupling has no least-squares"});
  if (s.gradient == Gradient::least_squares && common.interface == "volume")
    throw t.error("gradient", "pairwise, corrected or min-pressure with coupling.interface = \"volume\"",
                  "gradient = \"pairwise\"");
  const double filter = s.filter;
  s = with_gradient(s, s.gradient);
  if (common.interface == "volume" && s.gradient == Gradient::pairwise) s.filter = filter;
  t.number("cfl", s.cfl,
           {.min = 0, .max = 1, .exclusive = true, .help = "largest speed times time step over spacing"});
  read_source(t.table("source", "what the pressure equation corrects"), s);
  read_surface(t.table("surface", "which particles are free surface"), s);
  t.flag("negative_pressure", s.negative_pressure,
         {.paper = false,
          .help = "false: no tension near a free surface, below it at most rho u^2, or the atmosphere with "
                  "fluid.submerged; a closed tank has it all"});
  read_anti_penetration(t.table("anti_penetration", "water that comes too near a solid"), s);
  read_pressure(t.table("pressure", "how the pressure equation is solved"), s);
  t.number("shifting", s.shifting,
           {.min = 0,
            .max = 100,
            .paper = 0.0,
            .help = "strength of particle shifting towards even spacing; 0: off"});
  t.number("filter", s.filter,
           {.min = 0,
            .max = 10,
            .paper = 0.0,
            .help = "damps what the velocity gradient does not explain: viscosity over l0 times that "
                    "velocity (least-squares) or sqrt(p/rho) (pairwise, of itself in volume coupling "
                    "alone); 0: off"});
  read_turbulence(t.table("turbulence", "sub-particle-scale stresses"), s);
}

void read_air(CaseTable t, AirKeys& air) {
  t.flag("layer", air.layer, {.help = "air between the lower faces of a body and the water is computed"});
  t.number("pressure", air.pressure, positive("Pa", "of the open air"));
  t.number("density", air.density, positive("kg/m^3", "of the open air"));
  t.number("gamma", air.gamma, {.min = 1, .max = 2, .exclusive = true, .help = "ratio of specific heats"});
  t.number("viscosity", air.viscosity, positive("Pa s", "of the air"));
  t.number(
      "film", air.film,
      positive("m",
               "thickness, at the open air's pressure, of the air that stays under each piece of a face"));
  t.integer("columns", air.columns,
            {.min = 1, .max = 16, .help = "of air in a spacing, in the plane; in space one"});
  t.flag("friction", air.friction, {.help = "of the air on body and water"});
}

void check_air(CaseTable fluid, const CommonKeys& common, const Parameters& p) {
  CaseTable air = fluid.table("air");
  if (common.interface == "volume")
    throw air.error("layer", "false with coupling.interface = \"volume\"",
                    "coupling.interface = \"surface\", or layer = false");
  if (p.scheme.gradient != Gradient::least_squares)
    throw air.error("layer", "false with this scheme: air belongs to gradient = \"least-squares\"",
                    "preset = \"improved\", or layer = false");
  if (common.structure_solver == "none")
    throw air.error("layer", "false: there is no body", "a structure, or layer = false");
  if (p.dimension == 3 && p.air.columns != 1)
    throw air.error("columns", "1 in three dimensions", "columns = 1");
  if (p.submerged)
    throw air.error("layer", "false: a body that starts in the water has no air under it", "layer = false");
}

void check_sound_depth(CaseTable& fluid, CaseTable& scheme, const Parameters& p) {
  if (p.scheme.gradient != Gradient::least_squares)
    throw scheme.error("gradient",
                       "least-squares with fluid.sound_depth: in the other schemes all water has sound_speed",
                       "gradient = \"least-squares\", or leave fluid.sound_depth out");
  if (!std::isfinite(p.sound_speed))
    throw fluid.error("sound_depth", "nothing with sound_speed = inf: there is no sound to keep from an echo",
                      "leave sound_depth out, or sound_speed = 1500");
  if (p.absorbing_bottom)
    throw fluid.error("sound_depth",
                      "a sound_depth or an absorbing bottom, not both: no sound comes down there",
                      "leave \"bottom\" out of absorbing, or leave sound_depth out");
  const double sheet = SoundLayer::thickness(p.spacing), water = p.water.max[1] - p.water.min[1];
  if (p.sound_depth < sheet || p.sound_depth > water - sheet)
    throw fluid.error("sound_depth",
                      fmt::format("from {:.4g} to {:.4g} m, in water {:.4g} m deep: the sheet that takes the "
                                  "sound is {:.2g} m to either side",
                                  sheet, water - sheet, water, sheet),
                      "leave sound_depth out; absorbing = [\"bottom\"] takes the sound at the bottom");
}

void check_together(CaseFile& file, const CommonKeys& common, const Parameters& p) {
  CaseTable fluid = file.root().table("fluid"), scheme = fluid.table("scheme");
  if (const auto fault = find_box_fault(p)) throw fluid.error(fault->key, fault->expected, fault->fix);
  if (std::isfinite(p.scheme.time_step) && p.scheme.time_step > common.window * (1 + 1e-9))
    throw scheme.error("time_step",
                       fmt::format("at most the exchange interval, coupling.{}.window = {:.6g} s",
                                   common.interface, common.window),
                       fmt::format("time_step = {:.6g}, or a longer window", common.window));
  if (const double steps = common.window / p.scheme.time_step; steps > most_steps)
    throw scheme.error(
        "time_step",
        fmt::format("at most {:g} steps in an exchange interval of {:.6g} s, these would be {:.2g}",
                    most_steps, common.window, steps),
        fmt::format("time_step = {:.2g} or more", common.window / most_steps));
  if ((p.absorbing_bottom || p.absorbing_sides) && p.scheme.gradient != Gradient::least_squares)
    throw scheme.error("gradient",
                       "least-squares with fluid.absorbing: the other schemes' walls do not yield",
                       "gradient = \"least-squares\", or leave fluid.absorbing out");
  if (std::isfinite(p.sound_depth)) check_sound_depth(fluid, scheme, p);
  if (p.air.layer) check_air(fluid, common, p);
  check_ranks(fluid, p);
  if (p.scheme.gradient == Gradient::least_squares) {
    CaseTable source = scheme.table("source");
    if (p.scheme.density_at == DensityAt::star)
      throw source.error("density_at", "old with gradient = \"least-squares\"",
                         "density_at = \"old\", or gradient = \"pairwise\"");
  }
  if (p.scheme.second == SecondCriterion::arc && p.scheme.radius_density < arc_radius)
    throw scheme.table("radius").error("density",
                                       fmt::format("at least {} with surface.second = arc", arc_radius),
                                       fmt::format("density = {}", arc_radius));
  for (const ProbeKeys& probe : p.probes)
    for (int d = 0; d < p.dimension; ++d)
      if (probe.at[d] < p.tank.min[d] - 1e-9 || probe.at[d] > p.tank.max[d] + 1e-9)
        throw Error(ExitCode::case_file,
                    fmt::format("{}: output.probe \"{}\"", file.path().string(), probe.name),
                    fmt::format("at = [{:.6g}, {:.6g}] lies outside fluid.tank", probe.at[0], probe.at[1]),
                    "place the sensor on the body or on a wall of the tank");
}

}  // namespace

Parameters read(CaseFile& file) {
  return read(file, read_common(file));
}

Parameters read(CaseFile& file, const CommonKeys& common) {
  Parameters p;
  p.interface = common.interface;
  p.threads = common.threads;
  for (const ProbeKeys& probe : common.probes)
    if (probe.of == "fluid") p.probes.push_back(probe);
  CaseTable fluid = file.root().table("fluid", "the fluid: its box, its material, its scheme");
  read_water(fluid, p);
  read_tank(fluid, common, p);
  for (ProbeKeys& probe : p.probes)
    if (probe.diameter == 0) probe.diameter = 2 * p.spacing;
  read_scheme(fluid.table("scheme", "the particle method; preset = paper | improved sets the defaults"),
              common, p.sound_speed, common.chosen.level, p.scheme);
  read_ranks(fluid, p);
  if (p.ranks > 1) p.threads = threads_of_rank(common, p.ranks, processors_here());
  read_air(fluid.table("air", "the air that a flat body traps"), p.air);
  if (!file.only_declares()) check_together(file, common, p);
  return p;
}

}  // namespace strake::fluid
