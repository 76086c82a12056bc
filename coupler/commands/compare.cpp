// strake compare: a run against its case's references, or records against the first of them.
#include "coupler/compare/compare.hpp"

#include "coupler/case/case_queries.hpp"
#include "coupler/case/case_view.hpp"
#include "coupler/commands/commands.hpp"
#include "coupler/compare/comparison.hpp"
#include "coupler/console/console.hpp"
#include "coupler/plot/canvas.hpp"
#include "coupler/plot/chart.hpp"
#include "coupler/plot/ticks.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/error.hpp"
#include "proto/files/json_file.hpp"
#include "proto/files/result_file.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace strake {
namespace {

constexpr double fine = 2;  // pixels of a PNG per unit, for fine screens

const MetricRow* row_of(const Comparison& comparison, const std::string& name) {
  for (const MetricRow& row : comparison.rows)
    if (row.name == name) return &row;
  return nullptr;
}

/// "deflection" of "mid.y", as the case asks for it; empty where it does not.
std::string quantity_of(const std::string& column, const std::vector<ProbeKeys>& probes) {
  for (const ProbeKeys& probe : probes)
    if (column == probe.name || column.starts_with(probe.name + ".")) return probe.quantity;
  return {};
}

/// Throws Error(command_line) unless it is a .png or an .svg.
picture::Canvas::Kind kind_of_plot(const std::filesystem::path& path) {
  return picture::kind_of(path, "--plot", "a plot", "compare.svg");
}

/// The plots one below the other. Throws Error(command_line) where there is nothing to draw.
void write_plots(const std::filesystem::path& path, const std::vector<report::Plot>& plots) {
  const std::string bytes = picture::chart(plots, {.ratio = fine}, kind_of_plot(path));
  if (bytes.empty())
    throw Error(ExitCode::command_line, "--plot " + path.string(), "there is no curve to draw",
                "--probe NAME chooses a quantity that was recorded over time");
  write_text(path, bytes);
}

/// All records of one quantity over the span of their comparison, with the first peak of each.
report::Plot overlay_plot(const std::string& quantity, const std::vector<Record>& records,
                          const Comparison& comparison) {
  report::Plot plot;
  plot.title = plot.y_name = quantity;
  plot.x_name = "time";
  plot.x_unit = "s";
  plot.y_unit = records.front().unit;
  plot.window = {comparison.from, comparison.to};
  const MetricRow *value = row_of(comparison, "first_peak"), *time = row_of(comparison, "time_of_first_peak");
  for (std::size_t r = 0; r < records.size(); ++r) {
    report::Series series = {
        .name = records[r].name, .curve = records[r].curve, .style = static_cast<int>(r)};
    if (value != nullptr && time != nullptr && value->value[r] && time->value[r])
      series.marker = CurvePoint{comparison.origin[r] + *time->value[r], *value->value[r]};
    plot.series.push_back(std::move(series));
  }
  return plot;
}

/// Plots a run against the expectations of its case, one plot for each probe of the blocks. Values of peaks,
/// means and final values are references, beside the points of reference curves. Plots are named as the case
/// names them.
std::vector<report::Plot> reference_plots(const std::vector<CompareBlock>& blocks, const RunData& data,
                                          const std::string& run_name, const std::vector<ProbeKeys>& probes) {
  std::vector<report::Plot> plots;
  for (const CompareBlock& block : blocks) {
    const auto column = data.history == nullptr ? std::nullopt : data.history->find(block.probe);
    if (!column) continue;
    const std::string quantity = quantity_of(block.probe, probes);
    const std::string title = quantity.empty() ? block.probe : quantity + " " + block.probe;
    const auto same = [&](const report::Plot& plot) { return plot.title == title; };
    auto plot = std::find_if(plots.begin(), plots.end(), same);
    if (plot == plots.end()) {
      report::Plot fresh;
      fresh.title = title;
      fresh.y_name = quantity.empty() ? block.probe : quantity;
      fresh.x_name = "time";
      fresh.x_unit = "s";
      fresh.y_unit = data.history->columns[*column].unit;
      report::Series own = {.name = run_name, .curve = curve_of(*data.history, block.probe)};
      const auto value = data.monitor.find(block.probe + ":first_peak"),
                 time = data.monitor.find(block.probe + ":time_of_first_peak");
      if (value != data.monitor.end() && time != data.monitor.end())
        own.marker = CurvePoint{time->second, value->second};
      fresh.series.push_back(std::move(own));
      plots.push_back(std::move(fresh));
      plot = std::prev(plots.end());
    }
    for (const CompareBlock::Metric& metric : block.metrics) {
      if (!is_value_of_curve(metric.name)) continue;
      const double value = metric.value * block.divide_by;
      const double within = metric.value == 0 ? metric.tolerance * std::abs(block.divide_by)
                                              : metric.tolerance * std::abs(value);
      plot->references.push_back(
          {.name = in_words(metric.name) + ", " + block.kind, .value = value, .within = within});
    }
    if (!block.file.empty())
      plot->series.push_back({.name = block.file.stem().string() + ", " + block.kind,
                              .curve = reference_curve(block),
                              .style = static_cast<int>(plot->series.size()),
                              .dots = true,
                              .line = false});
  }
  return plots;
}

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

/// The blocks of the run's own case.toml against its summary and history.
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
    write_plots(options.plot,
                reference_plots(blocks, data, folder.string(), common_keys_of(folder / "case.toml").probes));
    fmt::print("plot  {}\n", options.plot.string());
  }
  return code;
}

struct Limit {
  std::string metric;
  double part = 0;
};

Limit read_limit(const std::string& text) {
  const auto equals = text.find('=');
  Limit limit = {text.substr(0, equals), 0};
  const std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
  const char* last = number.data() + number.size();
  const auto [end, error] = std::from_chars(number.data(), last, limit.part);
  const auto& known = record_metrics();
  if (std::find(known.begin(), known.end(), limit.metric) == known.end()) {
    const std::string near = did_you_mean(limit.metric, known);
    throw Error(ExitCode::command_line, "--within " + text, "\"" + limit.metric + "\" is no metric",
                near.empty() ? fmt::format("one of {}", joined(known)) : "did you mean " + near + "?");
  }
  if (error != std::errc() || end != last || !(limit.part >= 0) || !std::isfinite(limit.part))
    throw Error(ExitCode::command_line, "--within " + text, "gives no limit",
                "METRIC=PART, e.g. --within first_peak=0.05 for 5 %");
  return limit;
}

/// The requested columns; without a request the probes and forces of every record, with `all` every column
/// but those that belong to another (p.mean, p.max).
std::vector<std::string> choose(const std::vector<RecordSource>& sources,
                                const std::vector<std::string>& asked, bool all) {
  if (!asked.empty()) return asked;
  std::vector<std::string> shared;
  const auto most = std::find_if(sources.begin(), sources.end(), [](const auto& s) { return s.is_run(); });
  const RecordSource& one = most == sources.end() ? sources.front() : *most;
  for (const std::string& name : all ? one.quantities() : one.telling_quantities()) {
    const auto dot = name.rfind('.');
    const std::string last = dot == std::string::npos ? "" : name.substr(dot + 1);
    if (last == "mean" || last == "min" || last == "max" || last == "impulse") continue;
    if (std::all_of(sources.begin(), sources.end(), [&](const auto& s) { return s.has(name); }))
      shared.push_back(name);
  }
  if (!shared.empty()) return shared;
  if (!all) return choose(sources, asked, true);
  std::string holds;
  for (const RecordSource& source : sources)
    holds += fmt::format("\n{} holds {}", source.name(), joined(source.quantities()));
  throw Error(ExitCode::command_line, "strake compare",
              "the records have no quantity of the same name" + holds,
              "choose with --probe NAME and FILE:COLUMN");
}

/// max |q| of a quantity over all records.
double largest_of(const std::vector<Record>& records) {
  double largest = 0;
  for (const Record& record : records)
    for (const double value : record.curve.value) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Whether a component is zero, or round-off of its largest sister (force.x beside force.y). A moment is
/// round-off where its lever arm [m] is.
bool is_still(const std::string& quantity, const std::vector<std::string>& all,
              const std::vector<RecordSource>& sources) {
  constexpr double smallest_part = 1e-9, smallest_arm = 1e-6;
  const auto family_of = [](const std::string& name) { return name.substr(0, name.rfind('.')); };
  const bool moment = family_of(quantity) == "moment";
  const std::string family = moment ? "force" : family_of(quantity);
  double own = 0, of_family = 0;
  for (const std::string& other : all) {
    if (family_of(other) != family && other != quantity) continue;
    std::vector<Record> records;
    for (const RecordSource& source : sources) records.push_back(source.record(other));
    const double largest = largest_of(records);
    if (family_of(other) == family) of_family = std::max(of_family, largest);
    if (other == quantity) own = largest;
  }
  return own <= (moment ? smallest_arm : smallest_part) * of_family;
}

/// What is compared. Without a request the components that are zero in all records go to `still`.
std::vector<std::string> choose_telling(const std::vector<RecordSource>& sources,
                                        const CompareOptions& options, std::vector<std::string>& still) {
  const std::vector<std::string> chosen = choose(sources, options.probes, options.all);
  if (!options.probes.empty() || options.all) return chosen;
  std::vector<std::string> quantities;
  for (const std::string& q : chosen) (is_still(q, chosen, sources) ? still : quantities).push_back(q);
  if (!quantities.empty()) return quantities;
  still.clear();
  return chosen;  // all are zero: that is what there is to say
}

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.6g}", *value) : "-";
}

std::string percent(double part) {
  return fmt::format("{:+.3g} %", 100 * part);
}

void print_table(const std::string& quantity, const std::vector<Record>& records, const Comparison& c) {
  fmt::print("{} [{}]   {:.6g} to {:.6g} s, times of peaks from {}\n", visible(quantity),
             visible(records.front().unit), c.from, c.to,
             c.after_contact ? "contact" : "the beginning of that span");
  fmt::print("  {:<18} {:>8}", "", "");
  for (std::size_t r = 0; r < records.size(); ++r) {
    const std::string place = fmt::format("({})", r + 1);
    fmt::print("  {:>12}{}", place, r == 0 ? "" : "             ");
  }
  fmt::print("\n");
  for (const MetricRow& row : c.rows) {
    fmt::print("  {:<18} {:>8}", row.name, "[" + visible(row.unit) + "]");
    const bool difference = row.name == "l2" || row.name == "dtw";
    for (std::size_t r = 0; r < records.size(); ++r) {
      if (r == 0) {
        fmt::print("  {:>12}", difference ? "" : number(row.value[r]));
        continue;
      }
      const std::string off = row.deviation[r] && !difference ? percent(*row.deviation[r]) : "";
      fmt::print("  {:>12} {:>12}", number(row.value[r]), off);
    }
    fmt::print("\n");
  }
}

/// All records at the times of all, linear between: a column for each.
void write_overlay(const std::filesystem::path& path, const std::vector<std::string>& quantities,
                   const std::vector<std::vector<Record>>& records, const std::vector<Comparison>& made) {
  std::vector<double> times;
  for (std::size_t q = 0; q < records.size(); ++q)
    for (const Record& r : records[q])
      for (const double t : r.curve.time)
        if (t >= made[q].from && t <= made[q].to) times.push_back(t);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::string text;
  for (std::size_t q = 0; q < records.size(); ++q)
    for (std::size_t r = 0; r < records[q].size(); ++r)
      text += fmt::format("# {}({}) is {} of {}\n", quantities[q], r + 1, quantities[q], records[q][r].name);
  text += "# resampled at the rows of all records, linear between\ntime [s]";
  for (std::size_t q = 0; q < records.size(); ++q)
    for (std::size_t r = 0; r < records[q].size(); ++r)
      text += fmt::format(",{}({}) [{}]", quantities[q], r + 1, records[q][r].unit);
  text += "\n";
  for (const double t : times) {
    text += fmt::format("{:.9g}", t);
    for (const auto& of_quantity : records)
      for (const Record& r : of_quantity) {
        const bool within = t >= r.curve.time.front() && t <= r.curve.time.back();
        text += within ? fmt::format(",{:.9g}", value_at(r.curve, t)) : ",";
      }
    text += "\n";
  }
  write_text(path, text);
}

std::string mark(bool pass, const Style& style) {
  return pass ? painted(style, "32", "pass") : painted(style, "31", "FAIL");
}

/// What is within its limit and what is not; true when all is.
bool judge(const std::vector<Limit>& limits, const std::string& quantity, const std::vector<Record>& records,
           const Comparison& c, const Style& style) {
  bool all = true;
  for (const Limit& limit : limits)
    for (const MetricRow& row : c.rows)
      for (std::size_t r = 1; row.name == limit.metric && r < records.size(); ++r) {
        const auto& off = row.deviation[r];
        const bool pass = off && std::abs(*off) <= limit.part;
        all = all && pass;
        fmt::print("{}  {} {} of ({}) {}: {} (within {:.3g} %)\n", mark(pass, style), visible(quantity),
                   row.name, r + 1, visible(records[r].name), off ? percent(*off) : "cannot be told",
                   100 * limit.part);
      }
  return all;
}

/// The quantity out of all sources, moved in time as the user asks; `said` tells by how much.
std::vector<Record> shifted_records(const std::vector<RecordSource>& sources, const std::string& quantity,
                                    const CompareOptions& options, std::string& said) {
  std::vector<Record> records;
  for (const RecordSource& source : sources) records.push_back(source.record(quantity));
  for (std::size_t r = 1; r < records.size() && !options.shifts.empty(); ++r) {
    const std::string& how = options.shifts.size() == 1 ? options.shifts.front() : options.shifts[r - 1];
    const double by = shift_onto(records.front(), records[r], how);
    records[r].shift(by);
    said += fmt::format("  ({}) by {:+.6g} s{}", r + 1, by,
                        how == "contact" || how == "peak" ? ", its " + how : "");
  }
  return records;
}

/// The span that is compared, on the clock of the first record.
ComparisonSpan span_of(const CompareOptions& options, const Record& first) {
  double origin = 0;
  if (options.after == "contact") {
    if (!first.contact)
      throw Error(ExitCode::command_line, first.name, "has no moment of contact",
                  "leave out --after contact and give --from and --to in s from the start");
    origin = *first.contact;
  }
  ComparisonSpan span;
  if (options.from) span.from = origin + *options.from;
  if (options.to) span.to = origin + *options.to;
  return span;
}

/// Two records or more against the first, metric by metric.
ExitCode compare_several(const CompareOptions& options) {
  if (!options.plot.empty()) kind_of_plot(options.plot);
  if (options.operands.size() < 2)
    throw Error(ExitCode::command_line, "strake compare", "these options are for two records or more",
                "name another run or CSV file, or give the run alone to see its case's references");
  std::vector<Limit> limits;
  for (const std::string& text : options.within) limits.push_back(read_limit(text));
  if (options.shifts.size() > 1 && options.shifts.size() + 1 != options.operands.size())
    throw Error(ExitCode::command_line, "--shift",
                fmt::format("{} shifts for {} records after the first", options.shifts.size(),
                            options.operands.size() - 1),
                "one for all of them, or one for each");
  std::vector<RecordSource> sources;
  for (const std::string& operand : options.operands) sources.emplace_back(operand);
  const Style style = style_of(stdout);

  for (std::size_t r = 0; r < sources.size(); ++r)
    fmt::print("({}) {}{}\n", r + 1, visible(sources[r].name()),
               r == 0 ? "   what the others are held against" : "");
  std::vector<std::string> still;
  const std::vector<std::string> quantities = choose_telling(sources, options, still);
  std::vector<std::vector<Record>> all;
  std::vector<Comparison> made;
  bool within = true;
  for (const std::string& quantity : quantities) {
    std::string shifts;
    std::vector<Record> records = shifted_records(sources, quantity, options, shifts);
    made.push_back(compare_records(records, quantity, span_of(options, records.front())));
    fmt::print("\n");
    print_table(quantity, records, made.back());
    if (!shifts.empty()) fmt::print("  shifted in time:{}\n", shifts);
    within = judge(limits, quantity, records, made.back(), style) && within;
    all.push_back(std::move(records));
  }
  std::size_t points = 0;
  for (const Comparison& c : made) points = std::max(points, c.points);
  fmt::print(
      "\nvalues between rows are linear; peaks of a run's probes are those of its solver's steps; l2 at the "
      "rows of both, dtw at {} equal steps; deviations are from (1)\n",
      points);
  if (!still.empty()) fmt::print("zero in all of them: {}\n", visible(joined(still)));
  if (options.probes.empty() && !options.all) fmt::print("all columns that they share: --all\n");
  if (!options.csv.empty()) {
    write_overlay(options.csv, quantities, all, made);
    fmt::print("overlay  {}\n", options.csv.string());
  }
  if (!options.plot.empty()) {
    std::vector<report::Plot> plots;
    for (std::size_t q = 0; q < all.size(); ++q)
      plots.push_back(overlay_plot(quantities[q], all[q], made[q]));
    write_plots(options.plot, plots);
    fmt::print("plot  {}\n", options.plot.string());
  }
  return within ? ExitCode::done : ExitCode::outside_tolerance;
}

}  // namespace

ExitCode compare(const CompareOptions& options) {
  const bool of_one_run = options.operands.size() == 1 && !options.from && !options.to &&
                          options.shifts.empty() && options.within.empty() && options.csv.empty();
  return of_one_run ? compare_run(options) : compare_several(options);
}

}  // namespace strake
