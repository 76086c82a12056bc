#include "coupler/case/case_queries.hpp"
#include "coupler/case/case_view.hpp"
#include "coupler/commands/commands.hpp"
#include "coupler/commands/compare_plot.hpp"
#include "coupler/compare/compare.hpp"
#include "coupler/console/console.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace strake {

namespace {

std::string read_whole(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream)
    throw Error(ExitCode::case_file, path.string(), "cannot be read",
                "name the folder of a run that `strake run` has made, e.g. runs/plate_entry");
  return text.str();
}

nlohmann::json read_json(const std::filesystem::path& path) {
  nlohmann::json json = nlohmann::json::parse(read_whole(path), nullptr, false);
  if (json.is_discarded())
    throw Error(ExitCode::case_file, path.string(), "is not JSON", "run the case again");
  return json;
}

/// What the run had found, as its participants reported it.
std::map<std::string, double> results_of(const nlohmann::json& summary, const nlohmann::json& record) {
  std::map<std::string, double> monitor;
  if (summary.contains("probes"))
    for (const auto& [probe, entry] : summary["probes"].items())
      for (const auto& [metric, value] : entry.items())
        if (value.is_number()) monitor[probe + ":" + metric] = value.get<double>();
  if (record.contains("contact"))
    for (const auto& [probe, value] : record["contact"].items())
      if (value.is_number()) monitor[probe + ":contact"] = value.get<double>();
  return monitor;
}

}  // namespace

/// The blocks of the run's own case.toml against its summary and history.
ExitCode compare_run(const CompareOptions& options) {
  const std::filesystem::path folder = options.operands.front();
  if (!options.plot.empty()) require_picture(options.plot);
  const auto text = read_whole(folder / "case.toml");
  const nlohmann::json summary = read_json(folder / "summary.json");
  const nlohmann::json record = read_json(folder / "run.json");
  std::vector<CompareBlock> blocks = compare_blocks_of(folder / "case.toml");
  const auto values = flatten_toml(text, (folder / "case.toml").string());
  const CaseLookup lookup = [&values](const std::string& key) -> std::optional<std::string> {
    const auto found = values.find(key);
    return found == values.end() ? std::nullopt : std::optional<std::string>(found->second);
  };

  const std::size_t in_file = blocks.size();
  std::erase_if(blocks, [&](const CompareBlock& block) {
    const auto& asked = options.probes;
    return !applies(block, lookup) ||
           (!asked.empty() && std::find(asked.begin(), asked.end(), block.probe) == asked.end());
  });
  const Table history = read_table(folder / "history.csv");
  RunData data{.monitor = results_of(summary, record), .history = &history, .time = 0, .finished = false};
  if (summary.contains("end_time") && summary["end_time"].is_number())
    data.time = summary["end_time"].get<double>();
  data.finished = summary.contains("exit_code") && summary["exit_code"] == 0;

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
    write_plots(options.plot,
                reference_plots(blocks, data, folder.string(), common_keys_of(folder / "case.toml").probes));
    fmt::print("plot  {}\n", options.plot.string());
  }
  return code;
}

}  // namespace strake
