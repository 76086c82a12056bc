#include "coupler/compare/compare_block.hpp"
#include "coupler/compare/record.hpp"
#include "proto/case/case_file.hpp"
#include "proto/files/history.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace strake {
namespace {

const std::vector<std::string>& known_metrics() {
  static const std::vector<std::string> names = {"first_peak",
                                                 "time_of_first_peak",
                                                 "peak",
                                                 "time_of_peak",
                                                 "impulse",
                                                 "mean_peak_50us",
                                                 "final",
                                                 "mean",
                                                 "rms",
                                                 "noise",
                                                 "slope",
                                                 "drift",
                                                 "period",
                                                 "onset",
                                                 "l2",
                                                 "dtw",
                                                 "largest_deviation",
                                                 "mean_deviation"};
  return names;
}

bool needs_reference(const std::string& metric) {
  return metric == "l2" || metric == "dtw" || metric == "largest_deviation" || metric == "mean_deviation";
}

/// Refuses a reference whose header names other units than those of a run, unless the block says how long one
/// is. Angles of bodies are in degrees in a run too.
void check_units(const CompareBlock& block, const Table& table) {
  const std::string place = block.file.string() + ":1";
  if (!block.column.empty()) table.column(block.column);  // refuses a name that is not there
  const Column &time = table.columns[0],
               &value = table.columns[block.column.empty() ? 1 : *table.find(block.column)];
  if (time.unit != "s" && block.axes.time == 1)
    throw Error(ExitCode::case_file, place,
                fmt::format("its first column ({}) is in \"{}\", not in seconds", time.name, time.unit),
                "give the compare block the unit: axes = { time = … }, in seconds");
  const SiUnit si = in_si(value.unit);
  if (si.factor != 1 && value.unit != "deg" && block.axes.value == 1)
    throw Error(ExitCode::case_file, place,
                fmt::format("its column {} is in \"{}\", not in \"{}\"", value.name, value.unit, si.unit),
                fmt::format("give the compare block the unit: axes = {{ value = {:g} }}", si.factor));
}

/// Refuses a reference with anything but finite numbers, with its line.
void check_reference(const CompareBlock& block) {
  const std::filesystem::path& path = block.file;
  const Table table = read_given_table(path);
  if (table.columns.size() < 2)
    throw Error(ExitCode::case_file, path.string() + ":1",
                "a reference curve has two columns, time and value");
  check_units(block, table);
  // Lines of numbers follow the header; comments and empty lines do not count.
  std::vector<std::size_t> line_of_row;
  std::ifstream in(path);
  std::string line;
  bool header = false;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    if (header) line_of_row.push_back(number);
    header = true;
  }
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto place = [&] {
      return row < line_of_row.size() ? fmt::format("{}:{}", path.string(), line_of_row[row]) : path.string();
    };
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      if (!std::isfinite(table.value[c][row]))
        throw Error(ExitCode::case_file, place(),
                    fmt::format("column {} ({}) is not a finite number", c + 1, table.columns[c].name),
                    "correct the reference or leave the row out");
    if (row > 0 && !(table.value[0][row] > table.value[0][row - 1]))
      throw Error(ExitCode::case_file, place(),
                  fmt::format("column 1 ({}) does not ascend", table.columns[0].name),
                  "sort the rows by time");
  }
  if (table.rows() < 2)
    throw Error(ExitCode::case_file, path.string(), "a reference curve has at least two rows");
}

std::vector<CompareBlock::Metric> read_metrics(CaseTable block, bool only_declares) {
  CaseTable value = block.table("value", "what is expected of the probe, metric by metric, SI");
  CaseTable tolerance =
      block.table("tolerance", "allowed deviation of each, relative to |value|; absolute where that is 0");
  const std::vector<std::string> given = value.keys();
  std::vector<CompareBlock::Metric> metrics;
  for (const std::string& name : only_declares ? known_metrics() : given) {
    if (std::find(known_metrics().begin(), known_metrics().end(), name) == known_metrics().end()) {
      const std::string near = did_you_mean(name, known_metrics());
      throw value.error(name, "a metric: " + joined(known_metrics()),
                        near.empty() ? "" : "did you mean " + near + "?");
    }
    CompareBlock::Metric metric = {name, 0, 0};
    value.number(name, metric.value,
                 {.unit = "SI", .required = true, .conditional = true, .help = "expected " + name});
    tolerance.number(
        name, metric.tolerance,
        {.min = 0, .required = true, .conditional = true, .help = "allowed deviation of " + name});
    metrics.push_back(metric);
  }
  for (const std::string& name : tolerance.keys())
    if (std::find(given.begin(), given.end(), name) == given.end())
      throw tolerance.error(name, "a metric that stands in value", "value = { " + name + " = … }");
  return metrics;
}

/// Either times in seconds, or shares of the record.
CompareBlock::Span read_window(CaseTable window, bool only_declares) {
  CompareBlock::Span span;
  window.choice("after", span.after, {"contact", "start"}, {.help = "where its time begins"});
  const bool shares = window.has("from_share") || window.has("to_share");
  if (shares || only_declares) {
    span.to = 1;
    window.number("from_share", span.from,
                  {.min = 0, .max = 1, .help = "instead of from: share of the time up to the run's end"});
    window.number("to_share", span.to,
                  {.min = 0, .max = 1, .exclusive = true, .help = "instead of to; not given: the run's end"});
    span.shares = shares;
  }
  if (!shares || only_declares) {
    span.from = span.to = 0;
    window.number("from", span.from, {.unit = "s", .min = 0, .help = "begin of the window"});
    window.number("to", span.to,
                  {.unit = "s",
                   .min = 0,
                   .exclusive = true,
                   .required = !shares,
                   .conditional = true,
                   .help = "its end"});
  }
  for (const char* key : {"from", "to"})
    if (shares && window.has(key))
      throw window.error(key, "seconds or shares, not both", std::string("leave out ") + key);
  if (!only_declares && span.to <= span.from)
    throw shares ? window.error("to_share", fmt::format("more than from_share = {:g}", span.from))
                 : window.error("to", fmt::format("a time after from = {:g} s", span.from));
  return span;
}

void read_axes(CaseTable block, CompareBlock& into) {
  block.text("column", into.column,
             {.help = "which column of the file holds the value; not given: the second"});
  CaseTable axes = block.table("axes", "units of the reference's columns, where they are not SI");
  axes.number("time", into.axes.time,
              {.unit = "s", .min = 0, .exclusive = true, .help = "length of one unit of the first column"});
  axes.number("time_zero", into.axes.time_zero, {.unit = "s", .help = "time of the run where it is 0"});
  axes.number("value", into.axes.value, {.unit = "SI", .help = "size of one unit of the value's column"});
  axes.number("value_zero", into.axes.value_zero,
              {.unit = "SI", .help = "what the probe shows where it is 0"});
}

}  // namespace

std::vector<CompareBlock> read_compare_blocks(CaseFile& file) {
  std::vector<CompareBlock> blocks;
  for (CaseTable t :
       file.root().tables("compare", "what the case expects of itself; judged as soon as it is known")) {
    CompareBlock block;
    t.text("probe", block.probe,
           {.required = true, .help = "name of a probe, with .x, .y or .z of a vector: mid.y"});
    block.where = t.where("probe");
    CaseTable when =
        t.table("when", "\"key\" = value or list of values; the block applies if all of them hold");
    for (const std::string& key : when.keys()) block.when[key] = when.scalars_as_text(key);
    block.metrics = read_metrics(t, file.only_declares());
    if (t.has("window") || file.only_declares()) {
      CaseTable window = t.table("window", "part of the record that is judged");
      block.window = read_window(window, file.only_declares());
    }
    t.choice("kind", block.kind, {"theory", "experiment", "code", "calibration"},
             {.help = "what the reference is"});
    t.text("source", block.source, {.help = "where it comes from"});
    if (t.has("file") || file.only_declares())
      t.file("file", block.file,
             {.help = "reference curve for l2, dtw and deviations: columns time and value, with units"});
    if (t.has("file") || file.only_declares()) read_axes(t, block);
    t.number("divide_by", block.divide_by,
             {.help = "what is measured is divided by it: a slope by rho V^3 is the K of a wedge"});
    if (!file.only_declares()) {
      if (block.metrics.empty())
        throw t.error("probe", "a value beside it, e.g. value = { first_peak = 1e-3 }");
      if (block.divide_by == 0) throw t.error("divide_by", "a number that is not 0");
      if (!block.file.empty()) check_reference(block);
      for (const auto& metric : block.metrics)
        if (needs_reference(metric.name) && block.file.empty())
          throw t.table("value").error(metric.name, "a reference curve to compare with",
                                       "file = \"reference/….csv\"");
    }
    blocks.push_back(std::move(block));
  }
  if (file.only_declares()) blocks.clear();
  return blocks;
}

}  // namespace strake
