#include "coupler/commands/commands.hpp"
#include "coupler/plot/html.hpp"
#include "coupler/report/sections.hpp"
#include "proto/files/result_file.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace strake {
namespace {

using report::Recorded;

/// "4 of 5 references within tolerance, 1 not reached. 1 of 2 is not finished."
std::string verdict_sentence(const std::vector<Recorded>& runs) {
  int judged = 0, passed = 0, open = 0, unfinished = 0;
  for (const Recorded& run : runs) {
    unfinished += run.finished() ? 0 : 1;
    for (const study::CheckResult& one : run.compare) {
      ++judged;
      passed += one.pass.value_or(false) ? 1 : 0;
      open += one.pass ? 0 : 1;
    }
  }
  std::string text = judged == 0 ? std::string("No reference of the case applies.")
                                 : fmt::format("{} of {} references within tolerance{}.", passed, judged,
                                               open > 0 ? fmt::format(", {} not reached", open) : "");
  if (unfinished > 0)
    text +=
        fmt::format(" {} of {} {} not finished.", unfinished, runs.size(), unfinished == 1 ? "is" : "are");
  return text;
}

std::string page_of_runs(const std::vector<Recorded>& runs, const std::vector<double>& at) {
  std::set<std::string> titles;
  for (const Recorded& run : runs) titles.insert(run.title.empty() ? run.name : run.title);
  std::string title = joined(std::vector<std::string>(titles.begin(), titles.end()));
  if (runs.size() > 1) title += fmt::format(": {} runs", runs.size());
  const std::string lead = "<p>" + report::escape(verdict_sentence(runs)) + "</p>\n";
  return report::page(title, lead,
                      report::what_was_run(runs) + report::alarms(runs) + report::drawing_of_case(runs) +
                          report::metrics(runs) + report::failures(runs) + report::histories(runs) +
                          report::pictures(runs, at) + report::checks(runs) + report::resolution(runs) +
                          report::limits(runs) + report::settings(runs) + report::how_to_run_again(runs));
}

std::vector<Recorded> recorded_runs(const report::StudyData& study, const report::RunsByName& runs) {
  std::vector<Recorded> all;
  for (const report::StudyData::Run& run : study.runs)
    if (const auto found = runs.find(run.name); found != runs.end()) all.push_back(found->second);
  return all;
}

/// One run for each label of the first axis: enough to see what the study is about.
std::vector<Recorded> shown(const report::StudyData& study, const report::RunsByName& runs) {
  std::vector<Recorded> chosen;
  std::set<std::string> labels;
  for (const report::StudyData::Run& run : study.runs) {
    const auto found = runs.find(run.name);
    if (run.state != "done" || found == runs.end()) continue;
    const auto label = study.axes.empty() ? run.labels.end() : run.labels.find(study.axes[0].name);
    if (label != run.labels.end() && !labels.insert(label->second).second) continue;
    chosen.push_back(found->second);
  }
  return chosen;
}

std::string page_of_study(const std::filesystem::path& folder, const std::vector<double>& at) {
  const report::StudyData study = report::read_study(folder);
  report::RunsByName runs;
  for (const report::StudyData::Run& run : study.runs) try {
      if (run.folder.empty()) continue;
      Recorded recorded = report::read_run(run.folder);
      recorded.name = run.name;
      runs.emplace(run.name, std::move(recorded));
    } catch (const Error&) {  // missing: the table of runs says so
    }
  const auto done = std::count_if(study.runs.begin(), study.runs.end(),
                                  [](const auto& run) { return run.state == "done"; });
  const auto passed = std::count_if(study.checks.begin(), study.checks.end(),
                                    [](const auto& check) { return check.pass.value_or(false); });
  const auto judged = std::count_if(study.checks.begin(), study.checks.end(),
                                    [](const auto& check) { return check.pass.has_value(); });
  std::string lead = fmt::format("<p>{} of {} runs done", done, study.runs.size());
  if (judged > 0) lead += fmt::format("; {} of {} checks pass", passed, judged);
  if (study.seconds) lead += fmt::format("; {} of wall time", report::duration(study.seconds));
  lead += ".";
  if (!study.of_case.empty()) lead += " Case: <code>" + report::escape(study.of_case) + "</code>.";
  if (!study.file.empty()) lead += " Study: <code>" + report::escape(study.file) + "</code>.";
  lead += "</p>\n";
  const std::vector<Recorded> drawn = shown(study, runs);
  const std::string title = study.title.empty() ? study.name.empty() ? "study" : study.name : study.title;
  return report::page(title, lead,
                      report::study_summary(study) + report::study_claims(study) +
                          report::study_checks(study) + report::alarms(recorded_runs(study, runs)) +
                          report::failures(recorded_runs(study, runs)) + report::drawing_of_case(drawn) +
                          report::study_histories(study, runs) + report::study_convergence(study) +
                          report::pictures(drawn, at) + report::limits(drawn) +
                          report::study_runs(study, runs));
}

}  // namespace

ExitCode write_report(const ReportOptions& options) {
  const std::filesystem::path& first = options.what.front();
  std::error_code none;
  const bool study = std::filesystem::exists(first / "study.json", none);
  if (study && options.what.size() > 1)
    throw Error(ExitCode::command_line, "strake report", "a study is reported alone",
                "strake report " + first.string());
  std::string page;
  if (study) {
    page = page_of_study(first, options.at);
  } else {
    std::vector<Recorded> runs;
    for (const std::filesystem::path& folder : options.what) {
      runs.push_back(report::read_run(folder));
      // Runs of one name from two folders are named by their whole paths.
      for (std::size_t i = 0; i + 1 < runs.size(); ++i)
        if (runs[i].name == runs.back().name) runs.back().name = folder.string();
    }
    page = page_of_runs(runs, options.at);
  }
  const std::filesystem::path out = options.out.empty() ? first / "report.html" : options.out;
  write_text(out, page);
  fmt::print("{}: {:.1f} MB, opens in any browser\n", out.string(), 1e-6 * static_cast<double>(page.size()));
  return ExitCode::done;
}

}  // namespace strake
