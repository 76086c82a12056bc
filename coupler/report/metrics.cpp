// What the runs found: metrics against references, and checks.
#include "coupler/compare/comparison.hpp"
#include "coupler/compare/record.hpp"
#include "coupler/plot/html.hpp"
#include "coupler/plot/ticks.hpp"
#include "coupler/report/sections.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace strake::report {
namespace {

/// A reference with which some run was compared; its place in the list is its footnote.
struct Reference {
  std::string probe, metric, kind, source;
  double value = 0;
  std::optional<double> tolerance;  // relative; of a reference of 0 in its unit
  bool same(const study::CheckResult& judged) const {
    return probe == judged.probe && metric == judged.metric && kind == judged.kind &&
           source == judged.source && value == judged.reference && tolerance == judged.tolerance;
  }
};

std::vector<Reference> references_of(const std::vector<Recorded>& runs) {
  std::vector<Reference> references;
  for (const Recorded& run : runs)
    for (const study::CheckResult& judged : run.compare)
      if (std::none_of(references.begin(), references.end(),
                       [&](const Reference& r) { return r.same(judged); }))
        references.push_back({judged.probe, judged.metric, judged.kind, judged.source,
                              judged.reference.value_or(0), judged.tolerance});
  return references;
}

std::string unit_of(const std::vector<Recorded>& runs, const std::string& probe, const std::string& metric) {
  std::string unit = "1";
  for (const Recorded& run : runs)
    if (const ProbeResult* result = run.probe(probe); result != nullptr && !result->unit.empty())
      unit = result->unit;
  if (unit == "1")
    for (const Recorded& run : runs)
      for (const Column& column : run.history.columns)
        if (column.name == probe) unit = column.unit;
  return metric_unit(metric, unit);
}

/// "first_peak" → "first peak". A reference with a window of its own says so beside its value.
std::string words(const std::string& metric) {
  if (metric == "impulse") return "impulse of the first 300 µs after contact";
  return metric == "mean_peak_50us" ? "largest mean of 50 µs" : in_words(metric);
}

/// "± 15 %", of a reference of 0 "± 3 mm".
std::string allowed(const Reference& reference, const std::string& unit) {
  if (!reference.tolerance) return {};
  const double part = *reference.tolerance;
  const std::string text = reference.value == 0 ? quantity(part, unit) : fmt::format("{:.3g} %", 100 * part);
  return " " + number_cell(part, "± " + text);
}

/// Whether a time integral or a mean of 50 µs of this quantity tells anything: of loads, not of a deflection.
bool is_unit_of_load(const std::string& unit) {
  for (const char* load : {"Pa", "N", "N/m", "N m"})
    if (unit == load) return true;
  return false;
}

const study::CheckResult* judged_by(const Recorded& run, const Reference& reference) {
  for (const study::CheckResult& judged : run.compare)
    if (reference.same(judged)) return &judged;
  return nullptr;
}

std::string verdict(const study::CheckResult& judged) {
  const std::string kind = !judged.pass ? "open" : *judged.pass ? "good" : "bad";
  const std::string word = !judged.pass ? "not reached" : *judged.pass ? "pass" : "outside";
  return badge(kind, word);
}

/// Whether a block measures what the probe's own record tells: without a window or a divisor of its own.
bool is_of_record(const CompareBlock* block, const std::string& metric) {
  if (block == nullptr) return true;
  const bool own_window = block->window && !(metric == "impulse" && is_of_contact(*block->window));
  return block->divide_by == 1 && !own_window;
}

std::string off(const study::CheckResult& judged, const std::string& unit) {
  const auto off = judged.deviation;
  return number_cell(off, judged.reference == 0 ? quantity(off, unit) : percent(off));
}

/// The unit of a reference and what is measured beside it: what is divided by a number of the case has none
/// that Strake knows.
std::string unit_beside(const std::vector<Recorded>& runs, const Reference& reference,
                        const std::string& unit) {
  for (const Recorded& run : runs)
    if (const study::CheckResult* judged = judged_by(run, reference))
      if (const CompareBlock* block = run.block_of(*judged)) return block->divide_by == 1 ? unit : "1";
  return unit;
}

/// What a run measured of a metric, and its deviations from the references. Of a block with a window or a
/// divisor of its own its value stands there too.
std::string measured_cell(const Recorded& run, const std::vector<Reference>& references,
                          const std::string& probe, const std::string& metric, const std::string& unit) {
  const ProbeResult* result = run.probe(probe);
  std::optional<double> value = result == nullptr ? std::nullopt : result->metric(metric);
  std::string deviations;
  bool others = false;
  for (std::size_t i = 0; i < references.size(); ++i) {
    const Reference& reference = references[i];
    const study::CheckResult* judged = judged_by(run, reference);
    if (reference.probe != probe || reference.metric != metric || judged == nullptr) continue;
    const CompareBlock* block = run.block_of(*judged);
    const bool divided = block != nullptr && block->divide_by != 1, of_record = is_of_record(block, metric);
    const std::string beside = divided ? "1" : unit;
    if (of_record && !value) value = judged->value;
    others = others || !of_record;
    deviations += "<br>";
    if (!of_record)
      deviations += quantity_cell(judged->value, beside) +
                    fmt::format(" <span class=\"to\">{}{}:</span> ", block->window ? "in its window" : "",
                                divided ? fmt::format(" over {:g}", block->divide_by) : "");
    deviations +=
        fmt::format("{} <span class=\"to\">to [{}]</span> {}", off(*judged, beside), i + 1, verdict(*judged));
  }
  constexpr std::size_t line_break = 4;  // characters: no value stands before it
  return !value && others ? deviations.substr(line_break) : quantity_cell(value, unit) + deviations;
}

std::string metric_table(const std::vector<Recorded>& runs, const std::vector<Reference>& references,
                         const std::string& probe) {
  std::vector<std::string> metrics;
  for (const Recorded& run : runs)
    if (const ProbeResult* result = run.probe(probe))
      for (const auto& [metric, value] : result->metrics)
        if (std::find(metrics.begin(), metrics.end(), metric) == metrics.end()) metrics.push_back(metric);
  const bool load = is_unit_of_load(unit_of(runs, probe, "peak"));
  std::erase_if(metrics, [&](const std::string& metric) {  // metrics that no run has, or that mean nothing
    if (!load && (metric == "impulse" || metric == "mean_peak_50us")) return true;
    return std::none_of(runs.begin(), runs.end(), [&](const Recorded& run) {
      const ProbeResult* result = run.probe(probe);
      return result != nullptr && result->metric(metric);
    });
  });
  std::vector<std::string> kinds;  // of this probe's references: a column each
  for (const Reference& reference : references) {
    if (reference.probe != probe) continue;
    if (std::find(kinds.begin(), kinds.end(), reference.kind) == kinds.end()) kinds.push_back(reference.kind);
    if (std::find(metrics.begin(), metrics.end(), reference.metric) == metrics.end())
      metrics.push_back(reference.metric);
  }
  HtmlTable table(names_of(runs, probe).title);
  std::vector<std::string> names = head_of(runs, {"metric"});
  for (const std::string& kind : kinds) names.push_back("reference: " + kind);
  table.head(names);
  for (const std::string& metric : metrics) {
    const std::string unit = unit_of(runs, probe, metric);
    std::vector<std::string> cells = {escape(words(metric))};
    for (const Recorded& run : runs) {
      cells.push_back(measured_cell(run, references, probe, metric, unit));
    }
    for (const std::string& kind : kinds) {
      std::string cell;
      for (std::size_t i = 0; i < references.size(); ++i)
        if (references[i].probe == probe && references[i].metric == metric && references[i].kind == kind)
          cell += (cell.empty() ? "" : "<br>") +
                  quantity_cell(references[i].value, unit_beside(runs, references[i], unit)) +
                  allowed(references[i], unit_beside(runs, references[i], unit)) +
                  fmt::format(" <a href=\"#source-{0}\" aria-label=\"source {0}\">[{0}]</a>", i + 1);
      cells.push_back(cell.empty() ? "–" : cell);
    }
    table.row(cells);
  }
  return table.empty() ? std::string() : table.html();
}

const char* meaning(const std::string& kind) {
  if (kind == "theory") return "a formula or its numerical evaluation";
  if (kind == "experiment") return "measured";
  if (kind == "code") return "another program's result";
  if (kind == "calibration") return "a parameter was fitted to it, so that agreement there proves nothing";
  return "";
}

/// What a check of summary.json measures, and what it should be.
struct Check {
  const char *name, *words, *wanted;
};
constexpr Check known_checks[] = {
    {"work_gap",
     "Work that the fluid did on the interface against the work that the structure received, the "
     "worst window, as a share of the larger",
     "round-off, about 1e-12"},
    {"momentum_gap",
     "Momentum that no impulse on bodies, walls or by gravity accounts for, as a share of the "
     "scale of the impact",
     "small against 1; what faces and water at a body's contact line say of the pressure differs, in "
     "space with few spacings by ten per cent of the body's impulse and more"},
    {"structure_energy_drift",
     "Energy of the structure that neither loads nor damping account for, as a share "
     "of the largest energy",
     "round-off for finite elements, below a per cent for particles"},
    {"inner_fraction_min", "Smallest share of water particles taken as inside the water; the rest is surface",
     "close to its value at rest: holes in the water lower it"},
    {"voids",
     "Most water particles of any frame that were taken for surface though they lie deeper than five "
     "spacings: around shut-in air, or where water came apart",
     "0, unless waves shut in air"},
    {"openings", "Those of them around no shut-in air: the water came apart inside", "0"},
    {"penetrations", "Most water particles inside the structure's outline at any time", "0"},
    {"lost", "Water particles that left the domain", "0, unless a splash leaves an open tank"},
    {"volume_drift", "Change of the water's volume since the start, as a share", "a per cent or less"},
    {"air_mass", "Air under the body and what has left it, over that of the start, minus 1",
     "round-off, at most 1e-12"},
    {"air_energy",
     "Energy of that air over what work, outflow and friction leave it, as a share of what it was given",
     "below 0 by some per cent: what its shocks and its time steps dissipate"},
    {"largest_speed", "Largest speed of the water over the largest that body and gravity can give it",
     "below 0.77, which is what theory gives without the margin"},
    {"largest_pressure", "Largest pressure on a face over the largest that an impact can give",
     "below 0.77, likewise"},
};

std::string grade_badge(const Recorded& run, const std::string& check) {
  const auto found = run.grades.find(check);
  if (found == run.grades.end() || found->second.grade.empty()) return {};
  const CheckGrade& is = found->second;
  const char* look = is.grade == "good" ? "good" : is.grade == "poor" ? "open" : "bad";
  std::string bounds;
  if (is.good && is.poor)
    bounds = fmt::format(" <span class=\"words\">good to {:.3g}, bad from {:.3g}</span>", *is.good, *is.poor);
  return " " + badge(look, is.grade) + bounds;
}

}  // namespace

std::string metrics(const std::vector<Recorded>& runs) {
  std::vector<std::string> probes;
  const auto references = references_of(runs);
  const auto list = [&](const std::string& probe) {
    if (std::find(probes.begin(), probes.end(), probe) == probes.end()) probes.push_back(probe);
  };
  for (const Reference& reference : references) list(reference.probe);  // what is judged comes first
  for (const Recorded& run : runs)
    for (const ProbeResult& result : run.probes) list(result.probe);
  const auto size = [&](const std::string& probe) {
    double most = 0;
    for (const Recorded& run : runs)
      if (const ProbeResult* result = run.probe(probe))
        most = std::max(most, std::abs(result->metric("peak").value_or(0)));
    return most;
  };
  std::map<std::string, double> largest;  // by vector
  for (const std::string& probe : probes)
    if (!is_moment(probe)) largest[vector_of(probe)] = std::max(largest[vector_of(probe)], size(probe));
  std::string body, folded;
  for (const std::string& probe : probes) {
    const bool judged = std::any_of(references.begin(), references.end(),
                                    [&](const Reference& r) { return r.probe == probe; });
    const bool noise = !judged && size(probe) <= round_off_share * largest[vector_of(probe)];
    (noise ? folded : body) += metric_table(runs, references, probe);
  }
  if (!folded.empty())
    body += "<details><summary>What stays at zero or at round-off</summary>\n" + folded + "</details>\n";
  if (!references.empty()) {
    body += "<h3>Sources of the references</h3>\n<ol class=\"sources\">\n";
    for (std::size_t i = 0; i < references.size(); ++i)
      body +=
          fmt::format("<li id=\"source-{}\"><strong>{}</strong> ({}): {}</li>\n", i + 1,
                      escape(references[i].kind), escape(meaning(references[i].kind)),
                      escape(references[i].source.empty() ? "no source is stated" : references[i].source));
    body += "</ol>\n";
  }
  if (body.empty()) return {};
  return section(
      "metrics", "What was measured",
      "<p>A deviation is (run − reference) / |reference|; “pass” means within the tolerance that the "
      "case states.</p>\n" +
          body);
}

std::string checks(const std::vector<Recorded>& runs) {
  std::vector<std::string> names;
  for (const Recorded& run : runs)
    for (const auto& [name, value] : run.checks)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  if (names.empty()) return {};
  HtmlTable table("Conservation and health");
  std::vector<std::string> head = head_of(runs, {"check"});
  head.insert(head.end(), {"what it says", "should be"});
  table.head(head);
  for (const std::string& name : names) {
    std::vector<std::string> cells = {"<code>" + escape(name) + "</code>"};
    bool any = false;  // a structure alone has no water to lose
    for (const Recorded& run : runs) {
      std::optional<double> value;
      for (const auto& [own, number] : run.checks)
        if (own == name) value = number;
      cells.push_back(quantity_cell(value, "1") + grade_badge(run, name));
      any = any || value;
    }
    if (!any) continue;
    const auto known = std::find_if(std::begin(known_checks), std::end(known_checks),
                                    [&](const Check& c) { return name == c.name; });
    for (const auto text : {&Check::words, &Check::wanted})
      cells.push_back(known == std::end(known_checks) ? "" : words_cell(known->*text));
    table.row(cells);
  }
  return table.empty() ? std::string() : section("checks", "Conservation checks", table.html());
}

std::string alarms(const std::vector<Recorded>& runs) {
  std::string list;
  for (const Recorded& run : runs)
    for (const std::string& line : run.alarms)
      list += "<li>" + badge("bad", "alarm") + " " + escape(runs.size() > 1 ? run.name + ": " + line : line) +
              "</li>\n";
  if (list.empty()) return {};
  return section("alarms", "Alarms",
                 "<p>These values cannot come from the case. Do not trust what follows them.</p>\n<ul>\n" +
                     list + "</ul>\n");
}

std::string resolution(const std::vector<Recorded>& runs) {
  std::set<std::string> spacings;
  std::string list;
  const std::string one_spacing = "one spacing:";
  for (const Recorded& run : runs) {
    if (const std::string spacing = run.setting("fluid.spacing"); !spacing.empty()) spacings.insert(spacing);
    for (const std::string& line : run.resolution)
      if (!line.starts_with(one_spacing))
        list += "<li>" + escape(runs.size() > 1 ? run.name + ": " + line : line) + "</li>\n";
  }
  if (spacings.empty()) return {};
  const std::string all = joined(std::vector<std::string>(spacings.begin(), spacings.end()));
  list += "<li>" +
          escape(spacings.size() == 1 ? "not checked against a second spacing (all runs have " + all + " m)"
                                      : "the runs have the spacings " + all + " m: compare them") +
          "</li>\n";
  return section("resolution", "Resolution", "<ul>\n" + list + "</ul>\n");
}

}  // namespace strake::report
