
#include "coupler/plot/html.hpp"
#include "coupler/plot/plot.hpp"
#include "coupler/plot/ticks.hpp"
#include "coupler/report/sections.hpp"
#include "proto/lookup.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake::report {
namespace {

std::string label_of(const StudyData::Run& run, const std::string& axis) {
  return at_or(run.labels, axis, "–");
}

std::optional<double> value_of(const StudyData::Run& run, const StudyData::QuantityOfRuns& column) {
  return at_or(run.values, column.probe.empty() ? column.metric : column.probe + ":" + column.metric);
}

std::string state_of(const StudyData::Run& run) {
  return badge(run.state == "done"     ? "good"
               : run.state == "failed" ? "bad"
                                       : "open",
               run.state.empty() ? "unknown" : run.state);
}

/// Two axes: the first down, the second across, one table per quantity.
std::string cross_table(const StudyData& study, const StudyData::QuantityOfRuns& column) {
  const StudyData::Axis &down = study.axes[0], &across = study.axes[1];
  HtmlTable table(fmt::format("{} {}", column.probe, in_words(column.metric)));
  std::vector<std::string> names = {down.name + " \\ " + across.name};
  names.insert(names.end(), across.labels.begin(), across.labels.end());
  std::vector<const StudyData::Reference*> references;
  for (const StudyData::Reference& r : study.references)
    if (r.axis == down.name && r.probe == column.probe && r.metric == column.metric) references.push_back(&r);
  for (const StudyData::Reference* r : references) names.push_back(fmt::format("{} ({})", r->title, r->kind));
  table.head(names);
  for (const std::string& row : down.labels) {
    std::vector<std::string> cells = {escape(row)};
    for (const std::string& label : across.labels) {
      std::string cell;
      for (const StudyData::Run& run : study.runs)
        if (label_of(run, down.name) == row && label_of(run, across.name) == label)
          cell += (cell.empty() ? "" : "<br>") +
                  (run.state == "done" ? quantity_cell(value_of(run, column), column.unit) : state_of(run));
      cells.push_back(cell.empty() ? "–" : cell);
    }
    for (const StudyData::Reference* r : references)
      cells.push_back(quantity_cell(at_or(r->values, row), column.unit));
    table.row(cells);
  }
  return table.html();
}

std::string list_table(const StudyData& study) {
  HtmlTable table("All runs of the study");
  std::vector<std::string> names = {"run"};
  for (const StudyData::Axis& axis : study.axes) names.push_back(axis.name);
  names.emplace_back("state");
  for (const auto& column : study.columns) names.push_back(column.probe + " " + in_words(column.metric));
  names.emplace_back("wall time");
  table.head(names);
  for (const StudyData::Run& run : study.runs) {
    std::vector<std::string> cells = {escape(run.name)};
    for (const StudyData::Axis& axis : study.axes) cells.push_back(escape(label_of(run, axis.name)));
    cells.push_back(state_of(run));
    for (const auto& column : study.columns)
      cells.push_back(quantity_cell(value_of(run, column), column.unit));
    cells.push_back("<span class=\"n\">" + duration(run.seconds) + "</span>");
    table.row(cells);
  }
  return table.html();
}

}  // namespace

std::string study_summary(const StudyData& study) {
  std::string body;
  if (study.axes.size() == 2)
    for (const auto& column : study.columns) body += cross_table(study, column);
  const std::string list = list_table(study);
  body += body.empty() ? list : "<details><summary>As one list</summary>\n" + list + "</details>\n";
  return section("summary", "Results of the study", body);
}

std::string study_histories(const StudyData& study, const RunsByName& runs) {
  std::string body;
  const auto group = [&](const std::string& heading, const auto& belongs) {
    std::vector<Recorded> members;
    for (const StudyData::Run& run : study.runs)
      if (const auto found = runs.find(run.name); belongs(run) && found != runs.end()) {
        members.push_back(found->second);
        std::string name;  // labels that distinguish it from the others of its group
        for (std::size_t a = 1; a < study.axes.size(); ++a)
          name += (name.empty() ? "" : ", ") + label_of(run, study.axes[a].name);
        members.back().name = name.empty() || heading.empty() ? run.name : name;
      }
    const std::string figures = members.empty() ? "" : history_figures(members, heading);
    if (!figures.empty()) body += (heading.empty() ? "" : "<h3>" + escape(heading) + "</h3>\n") + figures;
  };
  if (study.axes.size() < 2)
    group("", [](const StudyData::Run&) { return true; });
  else
    for (const std::string& label : study.axes[0].labels)
      group(study.axes[0].name + " " + label,
            [&](const StudyData::Run& run) { return label_of(run, study.axes[0].name) == label; });
  if (body.empty()) return {};
  return section(
      "histories", "Histories",
      "<p>A ring is the first peak as measured at every step; references are dashed.</p>\n" + body);
}

std::string study_convergence(const StudyData& study) {
  if (study.convergence.empty()) return {};
  HtmlTable table("Observed order and grid convergence index");
  table.head({"study", "axis", "quantity", "finest value", "extrapolated", "observed order",
              "GCI of the finest", "remark"});
  std::string figures;
  for (const StudyData::Convergence& item : study.convergence) {
    Plot plot;
    plot.title = item.title;
    plot.x_name = item.axis;
    plot.x_unit = "1";
    plot.y_name = item.probe + " " + in_words(item.metric);
    plot.y_unit = item.unit.empty() ? "1" : item.unit;
    plot.logarithmic = true;
    Series size = {.name = "|value|", .curve = {}, .style = 0, .marker = std::nullopt, .dots = true};
    Series error = {
        .name = "|value − extrapolated|", .curve = {}, .style = 1, .marker = std::nullopt, .dots = true};
    std::optional<double> finest;
    double smallest = 1e300;
    for (std::size_t k = 0; k < std::min(item.along.size(), item.values.size()); ++k) {
      const double h = item.along[k], q = item.values[k];
      if (!std::isfinite(h) || !std::isfinite(q)) continue;
      size.curve.time.push_back(h);
      size.curve.value.push_back(std::abs(q));
      if (item.extrapolated && q != *item.extrapolated) {
        error.curve.time.push_back(h);
        error.curve.value.push_back(std::abs(q - *item.extrapolated));
      }
      if (h < smallest) {
        smallest = h;
        finest = q;
      }
    }
    plot.series.push_back(size);
    figures += picture::figure(plot);
    if (error.curve.size() > 1) {
      plot.title += ", distance from the extrapolated value";
      plot.y_name = "distance of " + item.probe + " " + in_words(item.metric);
      plot.series = {error};
      figures += picture::figure(plot);
    }
    table.row({escape(item.title), escape(item.axis), escape(item.probe + " " + in_words(item.metric)),
               quantity_cell(finest, plot.y_unit), quantity_cell(item.extrapolated, plot.y_unit),
               quantity_cell(item.order, "1"),
               number_cell(item.gci, item.gci ? fmt::format("{:.2f} %", 100 * *item.gci) : "–"),
               words_cell(item.remark)});
  }
  return section(
      "convergence", "Convergence",
      "<p>The grid convergence index bounds the error of the finest value by what the last refinements "
      "changed (safety factor 1.25), as a share; it means something only where the order is steady.</p>\n" +
          table.html() + (figures.empty() ? "" : "<div class=\"figures\">\n" + figures + "</div>\n"));
}

std::string study_checks(const StudyData& study) {
  if (study.checks.empty()) return {};
  HtmlTable table("Checks of the study");
  table.head({"check", "verdict", "run", "quantity", "value", "reference", "deviation", "allowed", "kind",
              "against"});
  for (const study::CheckResult& check : study.checks) {
    std::string unit = check.unit.empty() ? "1" : check.unit;
    for (const auto& column : study.columns)
      if (column.probe == check.probe && column.metric == check.metric) unit = column.unit;
    const std::string kind = !check.pass ? "open" : *check.pass ? "good" : "bad";
    const bool absolute = check.reference == 0;  // then deviation and tolerance are in the quantity's unit
    table.row(
        {escape(check.title),
         badge(kind, !check.pass       ? "not judged"
                     : *check.pass     ? "pass"
                     : check.deviation ? "outside"
                                       : "not measured"),
         escape(check.run), escape(check.probe + " " + in_words(check.metric)),
         quantity_cell(check.value, unit), quantity_cell(check.reference, unit),
         number_cell(check.deviation, absolute ? quantity(check.deviation, unit) : percent(check.deviation)),
         !check.tolerance ? std::string("stated only")
         : absolute       ? quantity(check.tolerance, unit)
                          : fmt::format("{:g} %", 100 * *check.tolerance),
         escape(check.kind),
         words_cell(!check.against.empty() ? check.against
                    : check.source.empty() ? "no source is stated"
                                           : check.source)});
  }
  return section("checks", "Checks", table.html());
}

std::string study_claims(const StudyData& study) {
  if (study.claims.empty()) return {};
  HtmlTable table("Claims, one by one");
  table.head({"claim", "verdict", "what was measured", "why", "where it is made"});
  for (const study::ClaimResult& claim : study.claims) {
    const std::string kind = claim.verdict == "holds"           ? "good"
                             : claim.verdict == "does not hold" ? "bad"
                                                                : "open";
    table.row({words_cell(claim.claim), badge(kind, claim.verdict.empty() ? "not judged" : claim.verdict),
               words_cell(claim.measured), words_cell(claim.why), escape(claim.source)});
  }
  return section("claims", "Claims", table.html());
}

std::string study_runs(const StudyData& study, const RunsByName& runs) {
  std::string body;
  if (!study.commands.empty()) {
    body += "<pre tabindex=\"0\" aria-label=\"commands\"><code>";
    for (const std::string& command : study.commands) body += escape(command) + "\n";
    body += "</code></pre>\n";
  }
  HtmlTable table("The runs behind it");
  table.head({"run", "folder", "state", "what it said"});
  for (const StudyData::Run& run : study.runs) {
    std::vector<std::string> said = {"its folder holds no run"};
    if (const auto found = runs.find(run.name); found != runs.end()) {
      said = found->second.problems;
      if (const std::string& error = found->second.origin.error; !error.empty()) said.push_back(error);
    }
    table.row({escape(run.name), "<code>" + escape(run.folder.generic_string()) + "</code>", state_of(run),
               words_cell(joined(said, "; "))});
  }
  return section("again", "How to run it again", body + table.html());
}

}  // namespace strake::report
