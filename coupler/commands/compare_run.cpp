// strake compare of one run: against the references of its case.
#include "coupler/case/case_queries.hpp"
#include "coupler/case/case_view.hpp"
#include "coupler/commands/commands.hpp"
#include "coupler/commands/compare_plots.hpp"
#include "coupler/compare/compare.hpp"
#include "coupler/console/console.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/error.hpp"
#include "proto/files/json_file.hpp"
#include "proto/files/result_file.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <map>

namespace strake {

namespace {

std::string required_text(const std::filesystem::path& path) {
  const auto text = read_text(path);
  if (!text)
    throw Error(ExitCode::case_file, path.string(), "cannot be read",
                "name the folder of a run that `strake run` has made, e.g. runs/plate_entry");
  return *text;
}

Json required_json(const std::filesystem::path& path) {
  Json json = parse_json(required_text(path));
  if (json.is_null()) throw Error(ExitCode::case_file, path.string(), "is not JSON", "run the case again");
  return json;
}

/// What the run had found, as its participants reported it.
std::map<std::string, double> results_of(const Json& summary, const Json& record) {
  std::map<std::string, double> monitor;
  for (const auto& [probe, entry] : member(summary, "probes").items())
    for (const auto& [metric, value] : entry.items())
      if (value.is_number()) monitor[probe + ":" + metric] = value.get<double>();
  for (const auto& [probe, value] : member(record, "contact").items())
    if (value.is_number()) monitor[probe + ":contact"] = value.get<double>();
  return monitor;
}

}  // namespace

ExitCode compare_run(const CompareOptions& options) {
  const std::filesystem::path folder = options.operands.front();
  if (!options.plot.empty()) kind_of_plot(options.plot);
  const auto text = required_text(folder / "case.toml");
  const Json summary = required_json(folder / "summary.json");
  const Json record = required_json(folder / "run.json");
  std::vector<CompareBlock> blocks = compare_blocks_of(folder / "case.toml");
  const auto values = flatten_toml(text, (folder / "case.toml").string());
  const CaseLookup lookup = lookup_in(values);

  const std::size_t in_file = blocks.size();
  std::erase_if(blocks, [&](const CompareBlock& block) {
    const auto& asked = options.probes;
    return !applies(block, lookup) ||
           (!asked.empty() && std::find(asked.begin(), asked.end(), block.probe) == asked.end());
  });
  const Table history = read_table(folder / "history.csv");
  const RunData data{.monitor = results_of(summary, record),
                     .history = &history,
                     .time = number_of(summary, "end_time").value_or(0),
                     .finished = number_of(summary, "exit_code") == 0};

  const Style style = style_of(stdout);
  const std::vector<Verdict> verdicts = judge(blocks, data, lookup);
  ExitCode code = ExitCode::done;
  for (const Verdict& verdict : verdicts) {
    fmt::print("{}\n", verdict_text(verdict, style));
    if (verdict.result == Verdict::Result::fail) code = ExitCode::outside_tolerance;
  }
  if (verdicts.empty())
    fmt::print("{}: no [[compare]] block of its case applies to this run{} ({} in the file)\n",
               visible(folder.string()), options.probes.empty() ? "" : " and that probe", in_file);
  if (!options.plot.empty()) {
    write_plots(options.plot, run_plots(blocks, data, folder.string(),
                                        common_keys_of(folder / "case.toml").probes, options.probes));
    fmt::print("plot  {}\n", options.plot.string());
  }
  return code;
}

}  // namespace strake
