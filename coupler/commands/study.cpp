#include "coupler/commands/commands.hpp"
#include "coupler/console/console.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/participant/stop_request.hpp"
#include "coupler/run/run_folder.hpp"
#include "coupler/study/results.hpp"
#include "coupler/study/runner.hpp"
#include "proto/files/json_file.hpp"
#include "proto/files/result_file.hpp"
#include "proto/version.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

namespace strake {
namespace {

using namespace study;
std::string command_of(const Plan& plan, const PlannedRun& run, const std::filesystem::path& folder) {
  std::string line = "strake";
  for (const std::string& word : arguments_of(plan, run, folder)) line += " " + shell_word(word);
  return line;
}

/// The results of each element, as the list that study.json holds.
template <class T, class ToJson>
Json list_of(const std::vector<T>& elements, const ToJson& to_json) {
  Json list = Json::array();
  for (const T& element : elements) list.push_back(to_json(element));
  return list;
}

Json json_of(const Axis& axis) {
  return {{"name", axis.name},
          {"labels", list_of(axis.values, [](const AxisValue& v) { return Json(v.label); })}};
}

Json json_of(const Plan& plan, const PlannedRun& run, const Results& results,
             const std::filesystem::path& folder) {
  const Outcome& outcome = results.outcome.at(run.name);
  Json values = Json::object();
  if (results.values.contains(run.name))
    for (const auto& [name, value] : results.values.at(run.name)) values[name] = value;
  return {{"name", run.name},
          {"labels", run.label},
          {"folder", outcome.folder.filename().string()},
          {"state", to_text(outcome.state)},
          {"exit_code", outcome.exit_code},
          {"seconds", outcome.seconds},
          {"problem", outcome.problem},
          {"command", command_of(plan, run, folder)},
          {"values", values}};
}

Json json_of(const CheckResult& c) {
  return {{"title", c.title},
          {"run", c.run},
          {"against", c.against},
          {"probe", c.probe},
          {"metric", c.metric},
          {"value", finite(c.value)},
          {"reference", finite(c.reference)},
          {"deviation", finite(c.deviation)},
          {"tolerance", finite(c.tolerance)},
          {"pass", c.pass ? Json(*c.pass) : Json(nullptr)},
          {"kind", c.kind},
          {"source", c.source},
          {"unit", c.unit}};
}

Json json_of(const Reference& r) {
  return {
      {"title", r.title}, {"axis", r.axis},     {"probe", r.quantity.probe}, {"metric", r.quantity.metric},
      {"kind", r.kind},   {"source", r.source}, {"values", r.value}};
}

Json json_of(const GridConvergence& c, const Results& results) {
  return {{"title", c.title},
          {"axis", c.axis},
          {"probe", c.probe},
          {"metric", c.metric},
          {"unit", results.unit_of({c.probe, c.metric})},
          {"runs", c.runs},
          {"along", c.along},
          {"values", c.value},
          {"order", finite(c.order)},
          {"extrapolated", finite(c.extrapolated)},
          {"gci", finite(c.gci)},
          {"remark", c.remark}};
}

Json json_of(const ClaimResult& c) {
  return {{"claim", c.claim},
          {"source", c.source},
          {"measured", c.measured},
          {"verdict", c.verdict},
          {"why", c.why}};
}

Json json_of(const Plan& plan, const Results& results, const std::filesystem::path& folder,
             const std::vector<CheckResult>& checks, const std::vector<GridConvergence>& orders,
             const std::vector<ClaimResult>& claims, double seconds) {
  Json json = {
      {"title", plan.title},        {"study", plan.file.stem().string()},
      {"file", plan.file.string()}, {"case", plan.case_file.string()},
      {"commit", strake_commit()},  {"commands", {fmt::format("strake study {}", plan.file.string())}}};
  json["axes"] = list_of(plan.axes, [](const Axis& axis) { return json_of(axis); });
  json["runs"] =
      list_of(plan.runs, [&](const PlannedRun& run) { return json_of(plan, run, results, folder); });
  json["columns"] = list_of(plan.columns, [&](const Quantity& column) -> Json {
    return {{"probe", column.probe}, {"metric", column.metric}, {"unit", results.unit_of(column)}};
  });
  json["checks"] = list_of(checks, [](const CheckResult& c) { return json_of(c); });
  json["references"] = list_of(plan.references, [](const Reference& r) { return json_of(r); });
  json["convergence"] = list_of(orders, [&](const GridConvergence& c) { return json_of(c, results); });
  json["claims"] = list_of(claims, [](const ClaimResult& c) { return json_of(c); });
  json["seconds"] = seconds;
  return json;
}

/// " [Pa s]"; nothing for a number without a unit.
std::string bracketed(const std::string& unit) {
  return unit == "1" ? "" : " [" + unit + "]";
}

std::string csv_of(const Plan& plan, const Results& results) {
  std::string text = "# " + plan.title + "\nrun";
  for (const Axis& axis : plan.axes) text += "," + axis.name;
  text += ",state,seconds [s]";
  for (const Quantity& column : plan.columns)
    text += "," + column.name() + bracketed(results.unit_of(column));
  text += "\n";
  for (const PlannedRun& run : plan.runs) {
    const Outcome& outcome = results.outcome.at(run.name);
    text += run.name;
    for (const Axis& axis : plan.axes) text += "," + run.label.at(axis.name);
    text += fmt::format(",{},{:.3f}", to_text(outcome.state), outcome.seconds);
    for (const Quantity& column : plan.columns) {
      const auto value = results.value(run, column);
      text += value ? fmt::format(",{:.9g}", *value) : ",";
    }
    text += "\n";
  }
  return text;
}

/// Columns as wide as their widest cell.
void print_table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> width;
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c == width.size()) width.push_back(0);
      width[c] = std::max(width[c], row[c].size());
    }
  for (const auto& row : rows) {
    std::string line = "  ";
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string blank(width[c] - row[c].size(), ' ');
      line += c == 0 ? row[c] + blank : "  " + blank + row[c];
    }
    fmt::print("{}\n", visible(line));
  }
}

void print_summary(const Plan& plan, const Results& results) {
  std::vector<std::vector<std::string>> rows = {{"run", "state", "wall [s]"}};
  for (const Quantity& column : plan.columns)
    rows.front().push_back(column.name() + bracketed(results.unit_of(column)));
  for (const PlannedRun& run : plan.runs) {
    const Outcome& outcome = results.outcome.at(run.name);
    rows.push_back({run.name, to_text(outcome.state), fmt::format("{:.1f}", outcome.seconds)});
    for (const Quantity& column : plan.columns) {
      const auto value = results.value(run, column);
      rows.back().push_back(value ? fmt::format("{:.5g}", *value) : "-");
    }
  }
  fmt::print("\n");
  print_table(rows);
  if (std::any_of(plan.columns.begin(), plan.columns.end(),
                  [](const Quantity& column) { return column.metric == "impulse"; }))
    fmt::print(
        "  impulse: of the first 300 us after contact; strake compare RUN RUN has that of whole records\n");
}

std::string percent(const std::optional<double>& part) {
  return part ? fmt::format("{:+.2f} %", 100 * *part) : "not measured";
}

/// Says which run a check lacks, as "b has failed"; empty where both are done.
std::string missing_run(const Results& results, const CheckResult& check) {
  for (const std::string& name : {check.run, check.against})
    if (const auto found = results.outcome.find(name); found != results.outcome.end())
      if (found->second.state != Outcome::State::done)
        return name + (found->second.state == Outcome::State::failed ? " has failed" : " was not run");
  return {};
}

void print_checks(const Results& results, const std::vector<CheckResult>& checks) {
  if (!checks.empty()) fmt::print("\n");
  for (const CheckResult& c : checks) {
    const std::string other = !c.against.empty() ? c.against
                              : c.source.empty() ? c.kind + ", no source is stated"
                                                 : c.kind + ", " + c.source;
    const bool absolute = c.reference && *c.reference == 0;
    const std::string missing = missing_run(results, c);
    const std::string off = !missing.empty()          ? missing
                            : absolute && c.deviation ? fmt::format("{:.3g}", *c.deviation)
                                                      : percent(c.deviation);
    const std::string within = !c.tolerance ? "stated only"
                               : absolute   ? fmt::format("within {:.3g}", *c.tolerance)
                                            : fmt::format("within {:.3g} %", 100 * *c.tolerance);
    fmt::print("{}", visible(fmt::format("  {}  {} {} {}: {} ({})   {}\n",
                                         !c.pass            ? "    "
                                         : !missing.empty() ? "no run"
                                         : *c.pass          ? "pass"
                                                            : "FAIL",
                                         c.run, c.probe, c.metric, off, within, other)));
  }
}

void print_orders(const std::vector<GridConvergence>& orders) {
  if (orders.empty()) return;
  fmt::print("\n");
  for (const GridConvergence& c : orders) {
    std::vector<std::string> values;
    for (std::size_t k = 0; k < c.value.size(); ++k)
      values.push_back(fmt::format("{:g}: {:.5g}", c.along[k], c.value[k]));
    fmt::print("  {}\n    {}\n    {}", visible(c.title), joined(values), visible(c.remark));
    if (c.order) fmt::print(", order {:.2f}, {:.5g} at zero", *c.order, *c.extrapolated);
    if (c.gci) fmt::print(", GCI {:.2g} %", 100 * *c.gci);
    fmt::print("\n");
  }
}

void print_claims(const std::vector<ClaimResult>& claims) {
  if (!claims.empty()) fmt::print("\n");
  for (const ClaimResult& c : claims) {
    fmt::print("  {:<16} {}  ({})\n", c.verdict, visible(c.claim), visible(c.source));
    if (!c.measured.empty()) fmt::print("  {:<16}   {}\n", "", visible(c.measured));
    if (!c.why.empty()) fmt::print("  {:<16}   {}\n", "", visible(c.why));
  }
}

int jobs_of(const StudyOptions& options, const Plan& plan) {
  if (options.jobs > 0) return options.jobs;
  if (plan.jobs > 0) return plan.jobs;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// How the study ended: runs, checks and where the results stand; the exit code.
ExitCode close_study(const StudyOptions& options, const StopRequest& stop, const Results& results,
                     const std::vector<CheckResult>& checks, const std::filesystem::path& folder,
                     double seconds) {
  const Plan& plan = *results.plan;
  int failed = 0, missing = 0;
  ExitCode code = ExitCode::done;
  for (const PlannedRun& run : plan.runs) {
    const Outcome& outcome = results.outcome.at(run.name);
    missing += outcome.state == Outcome::State::missing;
    if (outcome.state != Outcome::State::failed) continue;
    if (failed++ == 0)
      code = outcome.exit_code > 0 ? static_cast<ExitCode>(outcome.exit_code) : ExitCode::solver_fault;
  }
  const auto judged =
      std::count_if(checks.begin(), checks.end(), [](const CheckResult& c) { return c.pass.has_value(); });
  const auto passed = std::count_if(checks.begin(), checks.end(),
                                    [](const CheckResult& c) { return c.pass.value_or(false); });
  fmt::print("\n{}  {} of {} runs, {} of {} checks pass, {}\n", stop.requested() ? "interrupted" : "done",
             static_cast<int>(plan.runs.size()) - failed - missing, plan.runs.size(), passed, judged,
             duration_text(seconds));
  fmt::print("  table   {}\n  all     {}\n", (folder / "study.csv").string(),
             (folder / "study.json").string());
  if (failed > 0) fmt::print("  logs    {}\n", (folder / "*.log").string());
  fmt::print("  next    {}\n", stop.requested() || failed > 0
                                   ? "the same command goes on where this one stopped"
                                   : "strake report " + shell_word(folder.string()));
  if (stop.requested()) return stop.code();
  if (failed == 0 && options.strict && passed != judged) return ExitCode::outside_tolerance;
  return code;
}

}  // namespace

ExitCode study_command(const StudyOptions& options, const StopRequest& stop) {
  const auto start = std::chrono::steady_clock::now();
  const Plan plan = read_plan(options.file);
  const std::filesystem::path folder = options.runs / plan.file.stem();
  const int jobs = jobs_of(options, plan);
  if (!options.quiet)
    fmt::print("{}   {} run{} of {}, {} at once   {}\n", visible(plan.title), plan.runs.size(),
               plan.runs.size() == 1 ? "" : "s", plan.case_file.filename().string(), jobs, folder.string());
  if (options.list) {
    for (const PlannedRun& run : plan.runs) fmt::print("  {}\n", visible(command_of(plan, run, folder)));
    return ExitCode::done;
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw Error(ExitCode::cannot_write, folder.string(), error.message(),
                "choose another folder with --runs DIR");
  const FolderLock lock(folder);

  const Results results = collect(plan, perform(plan,
                                                {.folder = folder,
                                                 .jobs = jobs,
                                                 .again = options.again,
                                                 .console = options.quiet ? nullptr : stdout},
                                                stop));
  const auto checks = judge_checks(results);
  const auto orders = judge_convergence(results);
  const auto claims = judge_claims(results);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  write_text(folder / "study.json",
             json_text(json_of(plan, results, folder, checks, orders, claims, seconds), 2) + "\n");
  write_text(folder / "study.csv", csv_of(plan, results));
  if (!options.quiet) {
    print_summary(plan, results);
    print_orders(orders);
    print_claims(claims);
  }
  print_checks(results, checks);
  if (!stop.requested()) refuse_unknown_probes(results);  // a run that is missing may have the probe
  return close_study(options, stop, results, checks, folder, seconds);
}

}  // namespace strake
