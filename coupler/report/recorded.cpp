#include "coupler/report/recorded.hpp"

#include "coupler/case/case_queries.hpp"
#include "coupler/case/case_view.hpp"
#include "coupler/compare/compare.hpp"
#include "proto/error.hpp"
#include "proto/files/json_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <sstream>

namespace strake::report {
namespace {

/// An object; an empty one where the file is missing or damaged, which is said.
Json object_of(const std::filesystem::path& path, std::vector<std::string>& problems) {
  const auto text = read_text(path);
  const std::string name = path.filename().string();
  if (!text) {
    problems.push_back(
        name + " is missing: " +
        (name == "summary.json" ? "the run has not ended, or was killed" : "it cannot be read"));
    return Json::object();
  }
  Json json = parse_json(*text);
  if (json.is_object()) return json;
  problems.push_back(name + " is damaged: it is not a JSON object");
  return Json::object();
}

std::string without_quotes(std::string text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return text;
}

/// The echo's own form: "[table]", "[[table]]", "key = value  # unit, origin".
std::vector<Setting> settings_of(const std::string& echo) {
  std::vector<Setting> settings;
  std::map<std::string, int> count;
  std::istringstream lines(echo);
  std::string table;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("[[")) {
      table = line.substr(2, line.find("]]") - 2);
      table += fmt::format("[{}]", count[table]++);
      continue;
    }
    if (line.starts_with("[")) {
      table = line.substr(1, line.find(']') - 1);
      for (const auto& [array, elements] : count)  // "[box.supports]" is that of the last [[box]]
        if (table.starts_with(array + "."))
          table = fmt::format("{}[{}]{}", array, elements - 1, table.substr(array.size()));
      continue;
    }
    const auto equals = line.find(" = "), note = line.rfind("  # ");
    if (line.starts_with("#") || equals == std::string::npos || note == std::string::npos || note < equals)
      continue;
    Setting setting;
    setting.key = (table.empty() ? "" : table + ".") + line.substr(0, equals);
    setting.value = without_quotes(line.substr(equals + 3, note - equals - 3));
    const std::string said = line.substr(note + 4);
    const auto comma = said.rfind(", ");
    setting.origin = comma == std::string::npos ? said : said.substr(comma + 2);
    setting.unit = comma == std::string::npos ? "" : said.substr(0, comma);
    settings.push_back(std::move(setting));
  }
  return settings;
}

/// "# physics    flat-bottom slamming: …", and the lines that continue it.
std::vector<std::pair<std::string, std::string>> notes_of(const std::string& case_text) {
  std::vector<std::pair<std::string, std::string>> notes;
  std::istringstream lines(case_text);
  for (std::string line; std::getline(lines, line) && line.starts_with("#");) {
    std::string text = line.substr(1);
    const auto begin = text.find_first_not_of(' ');
    if (begin == std::string::npos) continue;
    const bool goes_on = begin > 3 && !notes.empty();
    text = text.substr(begin);
    if (goes_on) {
      notes.back().second += " " + text;
      continue;
    }
    const auto gap = text.find("  ");
    const auto word = text.substr(0, text.find(' '));
    if (gap != std::string::npos && gap == word.size())
      notes.emplace_back(word, text.substr(text.find_first_not_of(' ', gap)));
    else if (notes.empty())
      notes.emplace_back("case", text);
    else if (word == "expect" || word == "choices" || word == "note" || word == "run")
      notes.emplace_back(word, text.substr(word.size() + 1));
  }
  return notes;
}

void read_record(const Json& record, Recorded& run) {
  run.origin.version = string_of(record, "strake");
  run.origin.commit = string_of(record, "commit");
  run.origin.started = string_of(record, "started");
  run.origin.host = string_of(record, "host");
  run.origin.compiler = string_of(record, "compiler");
  run.origin.threads = number_of(record, "threads");
  if (const auto code = number_of(record, "exit_code")) run.exit_code = static_cast<int>(*code);
  const Json& error = member(record, "error");
  if (error.is_object()) run.origin.error = string_of(error, "where") + ": " + string_of(error, "problem");
  for (const Json& word : member(record, "command"))
    if (word.is_string()) run.origin.command.push_back(word.get<std::string>());
  for (const char* list : {"participants", "attachments"})
    for (const auto& [side, participant] : member(record, list).items())
      if (const std::string solver = string_of(participant, "solver"); !solver.empty())
        run.solver[side] = solver;
  for (const auto& [side, participant] : member(record, "participants").items())
    if (const auto ranks = number_of(participant, "ranks")) {
      const auto threads = number_of(participant, "threads");  // none: they divide other machines
      run.origin.ranks.push_back(fmt::format("{}: {:g} ranks{}", side, *ranks,
                                             threads ? fmt::format(" × {:g}", *threads) : std::string()));
    }
  for (const auto& [probe, time] : member(record, "contact").items())
    if (time.is_number()) run.contact[probe] = time.get<double>();
  if (const auto text = read_text(string_of(record, "case"))) run.notes = notes_of(*text);
}

/// Of one structure its events, of several bodies the same under their names; null: nothing can break it.
void read_failure(const Json& failure, const std::string& body, Recorded& run) {
  if (!failure.is_object()) return;
  if (const auto energy = number_of(failure, "energy")) run.failure_energy[body] = *energy;
  for (const auto& [name, event] : failure.items()) {
    const bool known = name == "start" || name == "crack" || name == "parted";
    if (known)
      run.failure.push_back({body, name, number_of(event, "time"), number_of(event, "x"),
                             number_of(event, "y"), number_of(event, "z")});
    else if (body.empty())
      read_failure(event, name, run);
  }
}

void read_summary(const Json& summary, Recorded& run) {
  run.end_time = number_of(summary, "end_time");
  run.windows = number_of(summary, "windows");
  run.mean_iterations = number_of(member(summary, "iterations"), "mean");
  run.wall_seconds = number_of(member(summary, "seconds"), "wall");
  if (const auto code = number_of(summary, "exit_code"); code && !run.exit_code)
    run.exit_code = static_cast<int>(*code);
  const Json &probes = member(summary, "probes"), &checks = member(summary, "checks");
  if (probes.is_object())
    for (const auto& [name, entry] : probes.items()) {
      ProbeResult result = {.probe = name, .unit = string_of(entry, "unit"), .metrics = {}};
      if (entry.is_object())
        for (const auto& [metric, value] : entry.items())
          if (metric != "unit") result.metrics.emplace_back(metric, number_of(entry, metric));
      run.probes.push_back(std::move(result));
    }
  if (checks.is_object())
    for (const auto& [name, value] : checks.items())
      if (!value.is_object()) run.checks.emplace_back(name, number_of(checks, name));
  if (const Json& grades = member(checks, "grades"); grades.is_object())
    for (const auto& [name, entry] : grades.items())
      run.grades[name] = {string_of(entry, "grade"), number_of(entry, "good"), number_of(entry, "poor")};
  for (const Json& entry : member(summary, "alarms"))
    if (const std::string text = string_of(entry, "text"); !text.empty()) run.alarms.push_back(text);
  for (const Json& entry : member(summary, "resolution"))
    if (entry.is_string()) run.resolution.push_back(entry.get<std::string>());
  read_failure(member(summary, "failure"), "", run);
  for (const Json& entry : member(summary, "compare"))
    if (entry.is_object()) run.compare.push_back(study::verdict_of(entry));
}

/// What the case of a run compares it with: its blocks, and their curves.
void read_blocks(const std::filesystem::path& case_file, Recorded& run) {
  const auto text = read_text(case_file);
  if (!text) return;
  const CaseLookup lookup = lookup_in(flatten_toml(*text, case_file.string()));
  for (CompareBlock& block : compare_blocks_of(case_file)) {
    if (!applies(block, lookup)) continue;
    if (!block.file.empty())
      run.reference_curves.push_back(
          {block.probe, block.file.stem().string() + ", " + block.kind, reference_curve(block)});
    run.blocks.push_back(std::move(block));
  }
}

}  // namespace

std::optional<double> ProbeResult::metric(const std::string& name) const {
  for (const auto& [metric, value] : metrics)
    if (metric == name) return value;
  return std::nullopt;
}

const ProbeResult* Recorded::probe(const std::string& wanted) const {
  for (const ProbeResult& result : probes)
    if (result.probe == wanted) return &result;
  return nullptr;
}

const CompareBlock* Recorded::block_of(const study::CheckResult& judged) const {
  for (const CompareBlock& block : blocks)
    for (const CompareBlock::Metric& metric : block.metrics)
      if (block.probe == judged.probe && block.kind == judged.kind && block.source == judged.source &&
          metric.name == judged.metric && metric.value == judged.reference)
        return &block;
  return nullptr;
}

std::string Recorded::setting(const std::string& key) const {
  for (const Setting& setting : settings)
    if (setting.key == key) return setting.value;
  return {};
}

std::string Recorded::state() const {
  if (!exit_code) return problems.empty() ? "running or killed" : "no result";
  switch (*exit_code) {
    case 0:
      return "finished";
    case 1:
      return "finished, outside tolerance";
    case 4:
      return "failed: the solver";
    case 5:
      return "failed: a program was lost";
    case 6:
      return "failed: could not write";
    case 129:
    case 130:
    case 143:
      return "stopped before its end";
    default:
      return fmt::format("failed, exit code {}", *exit_code);
  }
}

std::vector<std::string> head_of(const std::vector<Recorded>& runs, std::vector<std::string> first) {
  for (const Recorded& run : runs) first.push_back(run.name);
  return first;
}

std::string name_of_run(const std::filesystem::path& folder) {
  const std::filesystem::path whole = std::filesystem::absolute(folder).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

Recorded read_run(const std::filesystem::path& folder) {
  Recorded run;
  run.folder = folder;
  run.name = name_of_run(folder);
  std::error_code none;
  const bool any = std::filesystem::exists(folder / "run.json", none) ||
                   std::filesystem::exists(folder / "case.toml", none);
  if (!any)
    throw Error(ExitCode::case_file, folder.string(), "is not the folder of a run: it has no run.json",
                "name a folder that `strake run` has made, e.g. runs/plate_entry");
  read_record(object_of(folder / "run.json", run.problems), run);
  read_summary(object_of(folder / "summary.json", run.problems), run);
  if (const auto echo = read_text(folder / "case.toml"))
    run.settings = settings_of(*echo);
  else
    run.problems.emplace_back("case.toml is missing: what was set is not known");
  run.title = run.setting("title");
  try {
    read_blocks(folder / "case.toml", run);
  } catch (const Error& error) {
    run.problems.push_back("reference curves: " + error.problem());
  }
  try {
    run.history = read_table(folder / "history.csv");
  } catch (const Error& error) {
    run.problems.push_back("history.csv: " + error.problem());
  }
  if (const auto time = run.history.find("time"); time && !run.end_time && run.history.rows() > 0)
    run.end_time = run.history.value[*time].back();
  return run;
}

}  // namespace strake::report
