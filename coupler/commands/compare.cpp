// strake compare: records against the first of them. A run against its case's references: compare_run.cpp.
#include "coupler/compare/compare.hpp"

#include "coupler/commands/commands.hpp"
#include "coupler/commands/compare_plots.hpp"
#include "coupler/compare/comparison.hpp"
#include "coupler/console/console.hpp"
#include "proto/error.hpp"
#include "proto/files/result_file.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace strake {
namespace {

struct Limit {
  std::string metric;
  double part = 0;
};

Limit read_limit(const std::string& text) {
  const auto equals = text.find('=');
  const std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
  const Limit limit = {text.substr(0, equals), number_from<double>(number).value_or(-1)};
  const auto& known = record_metrics();
  if (std::find(known.begin(), known.end(), limit.metric) == known.end()) {
    const std::string near = did_you_mean(limit.metric, known);
    throw Error(ExitCode::command_line, "--within " + text, "\"" + limit.metric + "\" is no metric",
                near.empty() ? fmt::format("one of {}", joined(known)) : "did you mean " + near + "?");
  }
  if (!(limit.part >= 0) || !std::isfinite(limit.part))
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

/// Names the probes and forces that not all of the runs have, and says where no two have one in common.
void print_unshared(const std::vector<RecordSource>& sources, const CompareOptions& options) {
  if (!options.probes.empty() || options.all) return;
  std::vector<std::string> lines;
  bool shared = false;
  for (std::size_t r = 0; r < sources.size(); ++r) {
    if (!sources[r].is_run()) return;  // of a file each column counts
    std::vector<std::string> own;
    for (const std::string& name : sources[r].telling_quantities())
      if (std::all_of(sources.begin(), sources.end(), [&](const auto& s) { return s.has(name); }))
        shared = true;
      else
        own.push_back(name);
    if (!own.empty()) lines.push_back(fmt::format("({}) has {}", r + 1, visible(joined(own))));
  }
  if (!shared)
    fmt::print("no probe or force is in all of them, so every column that they share stands above\n");
  if (!lines.empty()) fmt::print("not in all of them: {}\n", joined(lines, "; "));
}

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.6g}", *value) : "-";
}

/// The value of a record in a row. Noise has no frequency, which is no value that is missing.
std::string value_of(const MetricRow& row, std::size_t record) {
  return row.name == "frequency" && !row.value[record] ? "none" : number(row.value[record]);
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
        fmt::print("  {:>12}", difference ? "" : value_of(row, r));
        continue;
      }
      const std::string off = !difference ? deviation_text(row, r) : row.beside ? "*" : "";
      fmt::print("  {:>12} {:>12}", value_of(row, r), off);
    }
    fmt::print("\n");
  }
  for (const std::string& note : deviation_notes(quantity, c)) fmt::print("  {}\n", visible(note));
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
        std::string text = off ? deviation_text(row, r) : "cannot be told";
        if (row.beside) text += " of " + visible(row.beside->quantity);
        fmt::print("{}  {} {} of ({}) {}: {} (within {:.3g} %)\n", mark(pass, style), visible(quantity),
                   row.name, r + 1, visible(records[r].name), text, 100 * limit.part);
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
  std::vector<std::string> shifts;
  bool within = true;
  for (const std::string& quantity : quantities) {
    all.push_back(shifted_records(sources, quantity, options, shifts.emplace_back()));
    made.push_back(compare_records(all.back(), quantity, span_of(options, all.back().front())));
  }
  if (options.probes.empty()) find_small_components(quantities, made);  // what is asked for is held to itself
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    fmt::print("\n");
    print_table(quantities[q], all[q], made[q]);
    if (!shifts[q].empty()) fmt::print("  shifted in time:{}\n", shifts[q]);
    within = judge(limits, quantities[q], all[q], made[q], style) && within;
  }
  std::size_t points = 0;
  for (const Comparison& c : made) points = std::max(points, c.points);
  fmt::print(
      "\nvalues between rows are linear, each row of a load is the mean of its window; peaks of a run's "
      "probes are those of its solver's steps; l2 at the "
      "rows of both, dtw at {} equal steps; deviations are from (1)\n",
      points);
  print_unshared(sources, options);
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
