#include "coupler/report/study_data.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "proto/error.hpp"

namespace strake::report {
namespace {

using Json = nlohmann::ordered_json;

const Json& member(const Json& json, const std::string& key) {
  static const Json null;
  if (!json.is_object()) return null;
  const auto found = json.find(key);
  return found == json.end() ? null : *found;
}

std::string text(const Json& json, const std::string& key) {
  const Json& value = member(json, key);
  return value.is_string() ? value.get<std::string>() : std::string();
}

std::optional<double> number(const Json& json, const std::string& key) {
  const Json& value = member(json, key);
  return value.is_number() ? std::optional<double>(value.get<double>()) : std::nullopt;
}

std::vector<std::string> texts(const Json& json, const std::string& key) {
  std::vector<std::string> values;
  if (const Json& list = member(json, key); list.is_array())
    for (const Json& value : list)
      values.push_back(value.is_string() ? value.get<std::string>() : value.dump());
  return values;
}

std::vector<double> numbers(const Json& json, const std::string& key) {
  std::vector<double> values;
  if (const Json& list = member(json, key); list.is_array())
    for (const Json& value : list)
      values.push_back(value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN());
  return values;
}

/// The objects of a list; nothing else in it counts.
std::vector<Json> objects(const Json& json, const std::string& key) {
  std::vector<Json> found;
  if (const Json& list = member(json, key); list.is_array())
    for (const Json& value : list)
      if (value.is_object()) found.push_back(value);
  return found;
}

StudyData::Run run_of(const Json& json, const std::filesystem::path& folder) {
  StudyData::Run run = {.name = text(json, "name"),
                        .state = text(json, "state"),
                        .labels = {},
                        .folder = {},
                        .exit_code = number(json, "exit_code"),
                        .seconds = number(json, "seconds"),
                        .values = {}};
  if (const std::string own = text(json, "folder"); !own.empty()) run.folder = folder / own;
  if (const Json& labels = member(json, "labels"); labels.is_object())
    for (const auto& [axis, label] : labels.items())
      run.labels[axis] = label.is_string() ? label.get<std::string>() : label.dump();
  if (const Json& values = member(json, "values"); values.is_object())
    for (const auto& [name, value] : values.items()) run.values[name] = number(values, name);
  return run;
}

StudyData::Check check_of(const Json& json) {
  StudyData::Check check = {.title = text(json, "title"),
                            .run = text(json, "run"),
                            .against = text(json, "against"),
                            .probe = text(json, "probe"),
                            .metric = text(json, "metric"),
                            .kind = text(json, "kind"),
                            .source = text(json, "source"),
                            .value = number(json, "value"),
                            .reference = number(json, "reference"),
                            .deviation = number(json, "deviation"),
                            .tolerance = number(json, "tolerance"),
                            .pass = std::nullopt};
  if (const Json& pass = member(json, "pass"); pass.is_boolean()) check.pass = pass.get<bool>();
  return check;
}

}  // namespace

StudyData read_study(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "study.json";
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  const Json json = stream ? Json::parse(content.str(), nullptr, false) : Json();
  if (!json.is_object())
    throw Error(ExitCode::case_file, path.string(), stream ? "is not a JSON object" : "cannot be read",
                "run the study again: strake study STUDY");
  StudyData study;
  study.title = text(json, "title");
  study.name = text(json, "study");
  study.file = text(json, "file");
  study.of_case = text(json, "case");
  study.commands = texts(json, "commands");
  study.seconds = number(json, "seconds");
  for (const Json& axis : objects(json, "axes"))
    study.axes.push_back({text(axis, "name"), texts(axis, "labels")});
  for (const Json& run : objects(json, "runs")) study.runs.push_back(run_of(run, folder));
  for (const Json& column : objects(json, "columns"))
    study.columns.push_back({text(column, "probe"), text(column, "metric"), text(column, "unit")});
  for (const Json& check : objects(json, "checks")) study.checks.push_back(check_of(check));
  for (const Json& item : objects(json, "references")) {
    study.references.push_back({.title = text(item, "title"),
                                .axis = text(item, "axis"),
                                .probe = text(item, "probe"),
                                .metric = text(item, "metric"),
                                .kind = text(item, "kind"),
                                .source = text(item, "source"),
                                .values = {}});
    if (const Json& values = member(item, "values"); values.is_object())
      for (const auto& [label, value] : values.items())
        study.references.back().values[label] = number(values, label);
  }
  for (const Json& item : objects(json, "convergence"))
    study.convergence.push_back({.title = text(item, "title"),
                                 .axis = text(item, "axis"),
                                 .probe = text(item, "probe"),
                                 .metric = text(item, "metric"),
                                 .unit = text(item, "unit"),
                                 .remark = text(item, "remark"),
                                 .along = numbers(item, "along"),
                                 .values = numbers(item, "values"),
                                 .order = number(item, "order"),
                                 .extrapolated = number(item, "extrapolated"),
                                 .gci = number(item, "gci")});
  for (const Json& claim : objects(json, "claims"))
    study.claims.push_back({text(claim, "claim"), text(claim, "source"), text(claim, "measured"),
                            text(claim, "verdict"), text(claim, "why")});
  return study;
}

}  // namespace strake::report
