#include "proto/case/case_keys.hpp"

#include "proto/case/case_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

namespace strake {
namespace {

ProbeKeys read_probe(CaseTable table, const CommonKeys& keys) {
  const std::vector<ProbeKeys>& others = keys.probes;
  ProbeKeys probe;
  table.text("name", probe.name, {.required = true, .help = "name of the probe's columns and results"});
  std::vector<std::string> sides = {"fluid", "structure"};
  for (const BodyKeys& body : keys.bodies) {
    if (sides.back() == "structure") sides.pop_back();
    sides.push_back(body.name);
  }
  table.choice("of", probe.of, sides,
               {.required = true, .help = "which side is measured; of several bodies the name of one"});
  table.vector(
      "at", probe.at,
      {.unit = "m", .required = true, .help = "place in the reference configuration; moves with the body"});
  probe.quantity = probe.of == "fluid" ? "pressure" : "deflection";
  table.choice(
      "quantity", probe.quantity,
      {"deflection", "displacement", "velocity", "von_mises", "stress", "pressure", "front", "level",
       "height", "gap", "air_pressure"},
      {.help =
           "structure: deflection (displacement less that of the supports, the default), displacement, "
           "velocity, von_mises or stress (Cauchy's, each component); fluid: pressure (the default; on the "
           "surface of the body, else on a wall of the tank), "
           "front (x where the water on the floor at `at` ends), "
           "level (of the water over `at`), height (wetted length over `at`), which stay where they are "
           "while the tank moves, or of the air under the body's face at `at`: gap or air_pressure (of that "
           "alone)"});
  table.number("diameter", probe.diameter, positive("m", "of a pressure sensor; not given: 2 fluid.spacing"));
  if (!table.has("name")) return probe;  // a list of declarations contains no probe to check

  // The name becomes part of a column name "mid.y" and of a result "mid.y:first_peak".
  constexpr std::size_t longest_name = 100;
  const bool printable = std::none_of(probe.name.begin(), probe.name.end(),
                                      [](unsigned char c) { return c <= ' ' || c == 127; });
  if (probe.name.empty() || !printable || probe.name.find_first_of(",:[]\"'\\/") != std::string::npos)
    throw table.error("name", "letters, digits, '_', '-' and '.'", "name = \"p_mid\"");
  if (probe.name.size() > longest_name)
    throw table.error("name",
                      fmt::format("a name of at most {} letters, not {}", longest_name, probe.name.size()),
                      "name = \"p_mid\"");
  for (const ProbeKeys& other : others)
    if (other.name == probe.name)
      throw table.error("name", "a name that no other probe has", "name = \"" + probe.name + "_2\"");
  const auto among = [&](std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(), [&](const char* name) { return probe.quantity == name; });
  };
  if (!keys.body.empty() && probe.of == keys.body) probe.of = "structure";
  if ((probe.of == "fluid") != among({"pressure", "front", "level", "height", "gap", "air_pressure"}))
    throw table.error(
        "quantity",
        probe.of == "fluid"
            ? "pressure, front, level, height, gap or air_pressure for a probe of the fluid"
            : "deflection, displacement, velocity, von_mises or stress for a probe of the structure",
        probe.of == "fluid" ? "quantity = \"pressure\"" : "of = \"fluid\", or another quantity");
  return probe;
}

/// Adds the probes of a plate where a case has none. They are the deflection at its middle, and the pressure
/// at the middle of its lower face. Other bodies have their force in the history. body: of several, its name.
void add_plate_probes(const CaseFile& file, const std::string& solver, const std::string& body,
                      CommonKeys& keys) {
  const std::vector<double> length = file.numbers_at("structure.plate.length"),
                            thickness = file.numbers_at("structure.plate.thickness"),
                            bottom = file.numbers_at("structure.plate.bottom"),
                            tank = file.numbers_at("fluid.tank");
  if (length.empty() || thickness.empty()) return;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < std::min<std::size_t>(3, bottom.size()); ++k)
    at[static_cast<Eigen::Index>(k)] = bottom[k];
  const std::string before = body.empty() ? "" : body + "_", of = body == keys.body ? "structure" : body;
  const bool elastic = solver == "fem" || solver == "particle" || solver == "ccx";
  if (elastic)
    keys.probes.push_back({.name = before + "middle",
                           .of = of,
                           .at = at + Eigen::Vector3d(0, 0.5 * thickness.front(), 0),
                           .quantity = "deflection"});
  // A sensor needs a wet face of known points inside the tank.
  const bool wet = keys.fluid_solver == "mps" && keys.interface == "surface" &&
                   (elastic || solver == "rigid") && !file.has("structure.surface_spacing") &&
                   !file.has("structure.loaded_faces") && !file.has("structure.wet");
  const std::size_t n = tank.size() / 2;
  bool inside = n == 2 || n == 3;
  for (std::size_t k = 0; inside && k < n; ++k) {
    const double x = at[static_cast<Eigen::Index>(k)];
    inside = tank[k] <= x && x <= tank[n + k];
  }
  if (wet && inside)
    keys.probes.push_back({.name = before + "p_middle", .of = "fluid", .at = at, .quantity = "pressure"});
}

std::string read_structure_solver(CaseFile& file) {
  std::string solver = "fem";
  file.root()
      .table("structure", "the structure: its shape, its material, its solver")
      .choice("solver", solver, {"fem", "particle", "ccx", "rigid", "replay", "precice", "none"},
              {.or_path = true, .help = "which program solves the structure"});
  return solver;
}

/// The window that suits every body, and why.
WindowChoice choose_for_all(const CaseFile& file, const CommonKeys& keys) {
  if (keys.bodies.empty()) return choose_window(file, keys);
  std::optional<WindowChoice> shortest;
  double speed = 0, by_table = 0;
  bool from_rest = false;
  for (const BodyKeys& body : keys.bodies) {
    CommonKeys own = keys;
    own.structure_solver = body.solver;
    WindowChoice choice = choose_window(file.of_body(body.name), own);
    choice.why = body.name + ": " + choice.why;
    speed = std::max(speed, choice.speed);
    by_table = std::max(by_table, choice.by_table);
    from_rest = from_rest || choice.from_rest;
    const bool level = choice.level || (shortest && shortest->level);
    if (!shortest || choice.window < shortest->window) shortest = choice;
    shortest->level = level;
  }
  shortest->speed = speed;
  shortest->by_table = by_table;
  shortest->from_rest = from_rest;
  return *shortest;
}

/// Names and solvers of [[structures]]. What else they have is read by their own programs.
void read_bodies(CaseFile& file, CommonKeys& keys) {
  CaseTable root = file.root();
  for (CaseTable& table : root.tables(
           "structures", "several bodies in one water: each has a name and the keys of [structure]")) {
    std::string name;
    table.text("name", name,
               {.required = true,
                .help = "the body's name in probes, columns, files and --set structures.NAME.KEY"});
    if (!file.only_declares()) table.accept_all();
  }
  for (const std::string& name : file.bodies()) {
    BodyKeys body{.name = name, .solver = "fem", .program = {}};
    CaseFile one = file.of_body(name);
    body.solver = read_structure_solver(one);
    if (body.solver == "none")
      throw one.root()
          .table("structure")
          .error("solver", "a solver: a body that is listed takes part", "leave its [[structures]] out");
    body.program = read_foreign(one, "structure", body.solver);
    keys.bodies.push_back(std::move(body));
  }
}

void read_run(CaseFile& file, CommonKeys& keys) {
  CaseTable run = file.root().table("run", "how the programs run");
  run.integer(
      "threads", keys.threads,
      {.min = 1,
       .max = 1024,
       .help = "threads of each solver, or of each of its ranks; several ranks without this key divide the "
               "processors of their machine"});
  keys.threads_given = file.has("run.threads");
  run.number("checkpoint", keys.checkpoint, positive("s", "wall clock between checkpoints"));
}

}  // namespace

CommonKeys read_common(CaseFile& file) {
  CommonKeys keys;
  CaseTable root = file.root();
  root.text("title", keys.title, {.help = "headline of the run"});
  root.choice("preset", keys.preset, {"improved", "paper"},
              {.help = "which defaults the scheme's keys have"});
  root.number("end_time", keys.end_time,
              {.unit = "s", .min = 0, .exclusive = true, .required = true, .help = "length of the run"});

  CaseTable fluid = root.table("fluid", "the fluid: its box, its material, its scheme");
  fluid.choice("solver", keys.fluid_solver, {"mps", "replay", "precice", "none"},
               {.or_path = true, .help = "which program solves the fluid"});
  keys.fluid_program = read_foreign(file, "fluid", keys.fluid_solver);
  keys.body = file.body();
  read_bodies(file, keys);
  if (keys.bodies.empty() || !keys.body.empty()) {
    keys.structure_solver = read_structure_solver(file);
    keys.structure_program = read_foreign(file, "structure", keys.structure_solver);
  } else {
    keys.structure_solver = keys.bodies.front().solver;
    keys.structure_program = keys.bodies.front().program;
  }

  CaseTable coupling = root.table("coupling", "how the two are coupled");
  coupling.choice(
      "interface", keys.interface, {"surface", "volume"},
      {.help = "surface: wet surface, partitioned; volume: all solid particles, the unified loop"});
  keys.chosen = choose_for_all(file, keys);
  double surface_window = keys.chosen.window, volume_window = 2e-6;
  CaseTable surface = coupling.table("surface", "used where interface = \"surface\"");
  surface.number("window", surface_window,
                 positive("s",
                          "exchange interval; the default is for a level face that meets the water, else "
                          "it follows spacing, speed and structure and divides output.every where that is "
                          "given (`strake check` says which and why)"));
  surface.choice(
      "interpolation", keys.interpolation, {"mean", "constant", "linear", "quadratic", "b-spline"},
      {.help = "what a structure with steps of its own feels in a window: the load's mean, or its "
               "history over the fluid's steps, taken so between them (b-spline: the cubic spline)"});
  coupling.table("volume", "used where interface = \"volume\"")
      .number("window", volume_window, positive("s", "exchange interval: one step of the fluid"));
  keys.window = keys.interface == "volume" ? volume_window : surface_window;

  read_run(file, keys);
  CaseTable output = root.table("output", "what is written");
  output.number("every", keys.output_every, positive("s", "time between field frames"));
  for (const CaseTable& probe : output.tables("probe", "one place, one quantity, over time"))
    keys.probes.push_back(read_probe(probe, keys));
  bool default_probes = true;
  output.flag("default_probes", default_probes,
              {.help = "a plate without any output.probe has two: middle, its deflection, and p_middle, the "
                       "pressure at the middle of its lower face"});
  if (!default_probes || output.has("probe")) return keys;
  if (keys.bodies.empty()) add_plate_probes(file, keys.structure_solver, {}, keys);
  for (const BodyKeys& body : keys.bodies)
    add_plate_probes(file.of_body(body.name), body.solver, body.name, keys);
  return keys;
}

}  // namespace strake
