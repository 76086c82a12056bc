#include "coupler/report/study_data.hpp"

#include "proto/error.hpp"
#include "proto/files/json_file.hpp"

#include <nlohmann/json.hpp>

#include <limits>

namespace strake::report {
namespace {

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
  StudyData::Run run = {.name = string_of(json, "name"),
                        .state = string_of(json, "state"),
                        .labels = {},
                        .folder = {},
                        .exit_code = number_of(json, "exit_code"),
                        .seconds = number_of(json, "seconds"),
                        .values = {}};
  if (const std::string own = string_of(json, "folder"); !own.empty()) run.folder = folder / own;
  if (const Json& labels = member(json, "labels"); labels.is_object())
    for (const auto& [axis, label] : labels.items())
      run.labels[axis] = label.is_string() ? label.get<std::string>() : label.dump();
  if (const Json& values = member(json, "values"); values.is_object())
    for (const auto& [name, value] : values.items()) run.values[name] = number_of(values, name);
  return run;
}

}  // namespace

StudyData read_study(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "study.json";
  const auto content = read_text(path);
  const Json json = parse_json(content.value_or(""));
  if (!json.is_object())
    throw Error(ExitCode::case_file, path.string(), content ? "is not a JSON object" : "cannot be read",
                "run the study again: strake study STUDY");
  StudyData study;
  study.title = string_of(json, "title");
  study.name = string_of(json, "study");
  study.file = string_of(json, "file");
  study.of_case = string_of(json, "case");
  study.commands = texts(json, "commands");
  study.seconds = number_of(json, "seconds");
  for (const Json& axis : objects(json, "axes"))
    study.axes.push_back({string_of(axis, "name"), texts(axis, "labels")});
  for (const Json& run : objects(json, "runs")) study.runs.push_back(run_of(run, folder));
  for (const Json& column : objects(json, "columns"))
    study.columns.push_back(
        {string_of(column, "probe"), string_of(column, "metric"), string_of(column, "unit")});
  for (const Json& check : objects(json, "checks")) study.checks.push_back(study::check_of(check));
  for (const Json& item : objects(json, "references")) {
    study.references.push_back({.title = string_of(item, "title"),
                                .axis = string_of(item, "axis"),
                                .probe = string_of(item, "probe"),
                                .metric = string_of(item, "metric"),
                                .kind = string_of(item, "kind"),
                                .source = string_of(item, "source"),
                                .values = {}});
    if (const Json& values = member(item, "values"); values.is_object())
      for (const auto& [label, value] : values.items())
        study.references.back().values[label] = number_of(values, label);
  }
  for (const Json& item : objects(json, "convergence"))
    study.convergence.push_back({.title = string_of(item, "title"),
                                 .axis = string_of(item, "axis"),
                                 .probe = string_of(item, "probe"),
                                 .metric = string_of(item, "metric"),
                                 .unit = string_of(item, "unit"),
                                 .remark = string_of(item, "remark"),
                                 .along = numbers(item, "along"),
                                 .values = numbers(item, "values"),
                                 .order = number_of(item, "order"),
                                 .extrapolated = number_of(item, "extrapolated"),
                                 .gci = number_of(item, "gci")});
  for (const Json& claim : objects(json, "claims"))
    study.claims.push_back({string_of(claim, "claim"), string_of(claim, "source"),
                            string_of(claim, "measured"), string_of(claim, "verdict"),
                            string_of(claim, "why")});
  return study;
}

}  // namespace strake::report
