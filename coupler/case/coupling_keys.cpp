#include "coupler/case/coupling_keys.hpp"

#include "coupler/transport/endpoint.hpp"
#include "proto/case/case_file.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

namespace strake {

namespace {

void read_mapping(CaseTable mapping, MappingParameters& p) {
  mapping.choice(
      "kind", p.kind, {"nearest-projection", "nearest-neighbour", "linear-cell", "radial-basis"},
      {.help = "weights W: u_fluid = W u_structure; linear-cell goes on beyond the surface's border"});
  mapping.choice("constraint", p.constraint, {"conservative", "consistent", "scaled-consistent"},
                 {.help = "force: by the transpose of W; or per area of the fluid's points, as it is or with "
                          "the sum kept"});
  CaseTable basis = mapping.table("radial_basis", "interpolation through points, without faces");
  basis.choice("function", p.radial_basis.function,
               {"wendland-c2", "wendland-c4", "wendland-c6", "thin-plate"},
               {.help = "smoother ones are more accurate and worse conditioned"});
  basis.number(
      "support", p.radial_basis.support,
      {.unit = "m", .min = 0, .help = "where a Wendland function ends; 0: 40 spacings of the points"});
  basis.choice("polynomial", p.radial_basis.polynomial, {"linear", "constant"},
               {.help = "fields that are reproduced exactly; thin-plate always has the linear one"});
  basis.choice("solve", p.radial_basis.solve, {"partition", "global"},
               {.help = "many small overlapping systems, or one of at most 2000 structure points"});
  basis.integer("patch_points", p.radial_basis.patch_points,
                {.min = 8, .max = 500, .help = "structure points of one small system, about"});
  basis.number("overlap", p.radial_basis.overlap,
               {.min = 0, .max = 1, .help = "of the small systems, relative to their radius"});
}

void read_convergence(CaseTable converged, Convergence& keys) {
  converged.number("relative", keys.relative,
                   {.min = 0, .max = 1, .help = "of the displacement increment of the window, or its value"});
  converged.number(
      "absolute", keys.absolute,
      {.unit = "m",
       .min = 0,
       .help = "residual that is always enough; 0: 0.02 m/s^2 times the window's square, at most 1e-6 of "
               "fluid.spacing"});
  converged.number("residual_relative", keys.residual_relative,
                   {.min = 0, .max = 1, .help = "of the window's first residual; 0: it does not count"});
  std::string measure = "increment";
  converged.choice("measure", measure, {"increment", "value"},
                   {.help = "what `relative` refers to; by value the load has to settle as well"});
  keys.measure = measure == "value" ? Measure::value : Measure::increment;

  CaseTable load =
      converged.table("load", "the fluid's force (or what else it sends), which settles as well");
  load.number("relative", keys.load.relative,
              {.min = 0,
               .max = 1,
               .help = "of its value; 0: as of the displacement where measure = value or scheme = parallel, "
                       "else it does not count"});
  load.number("absolute", keys.load.absolute,
              {.unit = "N", .min = 0, .help = "residual per point that is always enough; 0: does not count"});
  load.number("residual_relative", keys.load.residual_relative,
              {.min = 0, .max = 1, .help = "of the window's first residual; 0: does not count"});

  converged.integer("max_iterations", keys.max_iterations,
                    {.min = 1, .max = 1000, .help = "coupling iterations per window at most; 1: explicit"});
  converged.integer("min_iterations", keys.min_iterations,
                    {.min = 1, .max = 1000, .help = "coupling iterations per window at least"});
  std::string unconverged = "accept";
  converged.choice("unconverged", unconverged, {"accept", "stop", "halve"},
                   {.help = "what happens to a window that reached max_iterations"});
  if (unconverged == "stop") keys.then = Unconverged::stop;
  if (unconverged == "halve") keys.then = Unconverged::halve;
  if (keys.min_iterations > keys.max_iterations)
    throw converged.error("min_iterations", "at most max_iterations");
}

void read_surface(CaseTable surface, CouplingKeys& keys) {
  std::string scheme = "serial";
  surface.choice("scheme", scheme, {"serial", "parallel"},
                 {.help = "fluid first, or both at once with each other's last answer"});
  keys.parallel = scheme == "parallel";

  read_mapping(surface.table("mapping", "how displacement and force cross the interface"), keys.mapping);

  CaseTable accelerator = surface.table("accelerator", "how the next interface displacement is chosen");
  accelerator.choice("kind", keys.accelerator.kind, {"iqn-ils", "iqn-imvj", "aitken", "constant"},
                     {.help = "quasi-Newton by least squares or with a Jacobian carried on, dynamic "
                              "relaxation, or fixed relaxation"});
  accelerator.number("initial_relaxation", keys.accelerator.initial_relaxation,
                     {.min = 0,
                      .max = 1,
                      .exclusive = true,
                      .help = "relaxation of the first iteration, and of every one with `constant`"});
  accelerator.integer("reused_windows", keys.accelerator.reused_windows,
                      {.min = 0, .max = 100, .help = "earlier windows whose differences iqn-ils keeps"});
  accelerator.number(
      "filter", keys.accelerator.filter,
      {.min = 0, .max = 1, .help = "quasi-Newton drops a difference nearer than this to the others"});
  accelerator.choice("filter_kind", keys.accelerator.filter_kind, {"QR2", "QR1"},
                     {.help = "nearer beside the difference's own size, or beside all the others"});
  accelerator.integer("max_columns", keys.accelerator.max_columns,
                      {.min = 1,
                       .max = 1000,
                       .help = "differences that quasi-Newton keeps at most: two interface vectors each"});

  surface.choice("predictor", keys.predictor, {"constant", "linear", "quadratic"},
                 {.help = "first guess of a window, from the committed windows"});

  read_convergence(surface.table("converged", "when a window is accepted"), keys.convergence);

  CaseTable shorter =
      surface.table("shorter", "windows that a solver, or unconverged = \"halve\", makes shorter");
  shorter.number("smallest", keys.control.smallest,
                 {.unit = "s", .min = 0, .help = "the run ends below it; 0: a millionth of the window"});
  shorter.number("growth", keys.control.growth,
                 {.min = 1, .max = 10, .help = "factor by which they grow again, up to the window"});
  shorter.integer("patience", keys.control.patience,
                  {.min = 1, .max = 1000000, .help = "windows of one length before they grow"});
}

/// Where the participants connect, and who may. What other machines can reach goes with keys, or with the
/// user's plain word that it goes without.
void read_network(CaseTable& coupling, NetworkKeys& keys) {
  coupling.text(
      "endpoint", keys.endpoint,
      {.help = "\"ipc\": a socket in a private temporary folder; or tcp://ADDRESS:PORT, where other "
               "machines reach it with keys"});
  coupling.folder("keys", keys.curve_keys,
                  {.help = "folder that `strake keys` made: all is encrypted, and only holders of a key may "
                           "take part"});
  const std::string consent = "anybody on this network may read and change this run";
  std::string unencrypted = "no";
  coupling.choice("unencrypted", unencrypted, {"no", consent},
                  {.help = "without keys, an endpoint that other machines reach needs these plain words"});
  keys.unencrypted = unencrypted == consent;
  const std::string problem = keys.endpoint == "ipc" ? "" : problem_of_endpoint(keys.endpoint);
  if (!problem.empty()) {
    const Error e = coupling.error("endpoint", "\"ipc\", ipc://PATH or tcp://ADDRESS:PORT");
    const bool known = keys.endpoint.starts_with("ipc://") || keys.endpoint.starts_with("tcp://");
    throw Error(e.code(), e.where(), known ? problem : e.problem(), e.fix());
  }
  if (keys.endpoint != "ipc" && leaves_machine(keys.endpoint) && keys.curve_keys.empty() && !keys.unencrypted)
    throw coupling.error(
        "endpoint", "keys for an endpoint that other machines can reach",
        fmt::format("strake keys, then coupling.keys = \"keys\"; on a network where all are trusted\n"
                    "coupling.unencrypted = \"{}\"",
                    consent));
}

}  // namespace

CouplingKeys read_coupling(CaseFile& file) {
  CouplingKeys keys;
  CaseTable coupling = file.root().table("coupling", "how the two solvers are coupled");
  read_surface(coupling.table("surface", "partitioned coupling over the wet surface"), keys);

  CaseTable volume = coupling.table("volume", "the unified loop: every solid particle is an interface point");
  std::string solid_velocity = "replace";
  volume.choice("solid_velocity", solid_velocity, {"replace"},
                {.help = "the elastic update replaces the velocity that the pressure gave a solid particle; "
                         "\"add\", which did the same, was removed in version 0.2"});

  std::string placement = "coupler";
  coupling.choice("placement", placement, {"coupler"},
                  {.help = "the process that runs the scheme; \"fluid\" was removed in version 0.2"});

  coupling.number("frozen_after", keys.waiting.frozen_after,
                  {.unit = "s",
                   .min = 0,
                   .exclusive = true,
                   .help = "patience with a participant that lives but is disconnected"});
  coupling.number(
      "answer_within", keys.waiting.answer_within,
      {.unit = "s", .min = 0, .exclusive = true, .help = "longest silence of a participant that is busy"});
  coupling.number(
      "start_within", keys.waiting.start_within,
      {.unit = "s", .min = 0, .exclusive = true, .help = "from the start of a program to its first word"});
  coupling.number("attach_within", keys.waiting.attach_within,
                  {.unit = "s",
                   .min = 0,
                   .exclusive = true,
                   .help = "patience with a participant that is started by hand (--attach)"});
  read_network(coupling, keys.network);

  CaseTable run = file.root().table("run", "how the programs run");
  run.number("checkpoint", keys.checkpoint,
             {.unit = "s", .min = 0, .exclusive = true, .help = "wall clock between checkpoints"});
  run.integer("checkpoint_windows", keys.checkpoint_windows,
              {.min = 0, .help = "windows between checkpoints; 0: by the clock alone"});
  return keys;
}

}  // namespace strake
