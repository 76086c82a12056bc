#include "coupler/import/imported_run.hpp"
#include "coupler/new_case/case_lines.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

namespace strake {
namespace {

/// A limit that no residual is below but 0. The limit 0 would be a default, or that of the other data.
constexpr double never = 1e-300;

/// A number as short as it can be without a change of its value.
std::string shortest(double x) {
  return fmt::format("{}", x);
}

std::string list_of(const std::vector<std::string>& texts) {
  std::vector<std::string> quoted;
  for (const std::string& text : texts) quoted.push_back('"' + text + '"');
  return fmt::format("[{}]", joined(quoted));
}

void add_head(const ImportedRun& run, CaseLines& lines) {
  const std::string file = visible(run.file.filename().string(), "");
  lines.comment(fmt::format("Written by `strake import` from {}; the comments say from which line.", file))
      .comment(
          "Left to do: fluid.solver and structure.solver are the programs, arguments their command lines.");
  for (const std::string& note : run.notes) lines.comment(note);
  lines
      .text("title", fmt::format("{} and {}", run.fluid.participant.value, run.structure.participant.value),
            file)
      .key("end_time", shortest(run.scheme.end_time.value), "s; " + run.scheme.end_time.from);
}

void add_side(const char* table, const ImportedSide& side, const std::string& folder, CaseLines& lines) {
  const std::string& name = side.participant.value;
  lines.table(fmt::format("[{}]", table))
      .text("solver", "./" + name,
            fmt::format("TO DO: path of the program of {} ({})", name, side.participant.from))
      .key("arguments", "[]", "TO DO: all that follows the program's name on its command line")
      .text("folder", folder, "where it is started; it looks for its own files from there")
      .key("precice_names", list_of(side.names), "the configuration's data, and what they are");
}

void add_mapping(const ImportedMapping& mapping, CaseLines& lines) {
  lines.table("[coupling.surface.mapping]").text("kind", mapping.kind.value, mapping.kind.from);
  if (mapping.kind.value != "radial-basis") return;
  lines.table("[coupling.surface.mapping.radial_basis]")
      .text("function", mapping.function, mapping.kind.from)
      .key("support", shortest(mapping.support),
           mapping.function == "thin-plate" ? "m; not used" : "m; " + mapping.kind.from)
      .text("polynomial", mapping.polynomial, "what is reproduced exactly, as preCICE's polynomial")
      .text("solve", mapping.solve, mapping.kind.from)
      .key("patch_points", std::to_string(mapping.patch_points), "vertices-per-cluster")
      .key("overlap", shortest(mapping.overlap), "relative-overlap");
}

void add_acceleration(const ImportedAcceleration& acceleration, CaseLines& lines) {
  lines.table("[coupling.surface.accelerator]")
      .text("kind", acceleration.kind.value, acceleration.kind.from)
      .key("initial_relaxation", shortest(acceleration.initial_relaxation.value),
           acceleration.initial_relaxation.from);
  if (!acceleration.quasi_newton()) return;
  if (acceleration.kind.value == "iqn-ils")
    lines.key("reused_windows", std::to_string(acceleration.reused_windows.value),
              acceleration.reused_windows.from);
  lines.text("filter_kind", acceleration.filter_kind.value, acceleration.filter_kind.from)
      .key("filter", shortest(acceleration.filter.value), acceleration.filter.from)
      .key("max_columns", std::to_string(acceleration.max_columns.value), acceleration.max_columns.from);
}

void add_limits(const ImportedLimits& limits, const std::string& sender, CaseLines& lines) {
  const std::string none =
      limits.from.empty() ? "no measure: " + sender + "'s data need not settle" : "no such measure";
  const auto add = [&](const char* key, double limit) {
    const bool given = limit > 0 && !limits.from.empty();
    lines.key(key, shortest(limit > 0 ? limit : never), given ? limits.from : none);
  };
  add("relative", limits.relative);
  add("absolute", limits.absolute);
  add("residual_relative", limits.residual_relative);
}

void add_convergence(const ImportedRun& run, CaseLines& lines) {
  const ImportedScheme& scheme = run.scheme;
  lines.table("[coupling.surface.converged]")
      .key("min_iterations", std::to_string(scheme.min_iterations.value), scheme.min_iterations.from)
      .key("max_iterations", std::to_string(scheme.max_iterations.value), scheme.max_iterations.from)
      .text("unconverged", scheme.strict.value ? "stop" : "accept",
            scheme.strict.value ? "strict, " + scheme.strict.from : "as preCICE");
  if (!scheme.implicit.value) return;
  lines.text("measure", "value", "as preCICE");
  add_limits(scheme.of_structure, run.structure.participant.value, lines);
  lines.table("[coupling.surface.converged.load]");
  add_limits(scheme.of_fluid, run.fluid.participant.value, lines);
}

}  // namespace

std::string case_text(const ImportedRun& run, const std::string& folder) {
  CaseLines lines;
  add_head(run, lines);
  add_side("fluid", run.fluid, folder, lines);
  add_side("structure", run.structure, folder, lines);
  lines.table("[coupling.surface]")
      .text("scheme", run.scheme.parallel.value ? "parallel" : "serial", run.scheme.parallel.from)
      .key("window", shortest(run.scheme.window.value), "s; " + run.scheme.window.from)
      .text("predictor", "constant", "as preCICE");
  add_mapping(run.mapping, lines);
  add_acceleration(run.acceleration, lines);
  add_convergence(run, lines);
  return lines.str();
}

}  // namespace strake
