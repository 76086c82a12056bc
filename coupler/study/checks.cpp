#include "coupler/compare/comparison.hpp"
#include "coupler/study/results.hpp"
#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace strake::study {
namespace {

/// What a rule makes of one group of runs.
struct Finding {
  bool known = false, holds = false;
  std::string words;
};

using Group = std::vector<const PlannedRun*>;

/// Runs that differ on `axis` only, in the order of its values; every combination of the others is a group.
std::vector<Group> groups_along(const Results& results, const std::string& axis, const Filter& where) {
  std::vector<Group> groups;
  std::set<Filter> seen;
  for (const PlannedRun* run : results.runs(where)) {
    Filter others(run->label.begin(), run->label.end());
    others.erase(axis);
    if (!seen.insert(others).second) continue;
    groups.push_back(results.runs(others));
  }
  return groups;
}

std::string others_of(const PlannedRun& run, const std::string& axis) {
  std::vector<std::string> labels;
  for (const auto& [name, label] : run.label)
    if (name != axis) labels.push_back(label);
  return labels.empty() ? "" : fmt::format("{}: ", joined(labels));
}

Finding along(const Results& results, const Claim& claim, const Group& group) {
  Finding finding;
  std::vector<double> values;
  std::vector<std::string> words;
  for (const PlannedRun* run : group)
    if (const auto q = results.value(*run, claim.quantity)) {
      values.push_back(std::abs(*q));
      words.push_back(fmt::format("{} {:.4g}", run->label.at(claim.axis), *q));
    }
  finding.known = values.size() == group.size() && values.size() >= 2;
  finding.words = others_of(*group.front(), claim.axis) + joined(words);
  if (!finding.known) return finding;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double middle = 0.5 * (*low + *high), spread = middle > 0 ? (*high - *low) / middle : 0;
  if (claim.rule == Claim::Rule::increases)
    finding.holds = std::is_sorted(values.begin(), values.end(), std::less_equal<>());
  else if (claim.rule == Claim::Rule::decreases)
    finding.holds = std::is_sorted(values.begin(), values.end(), std::greater_equal<>());
  else {
    finding.holds = spread <= claim.tolerance;
    finding.words += fmt::format(" (spread {:.3g} %)", 100 * spread);
  }
  return finding;
}

Finding agree(const Results& results, const Claim& claim, const Group& group) {
  Finding finding;
  const PlannedRun *one = nullptr, *two = nullptr;
  for (const PlannedRun* run : group) {
    if (run->label.at(claim.axis) == claim.of) one = run;
    if (run->label.at(claim.axis) == claim.against) two = run;
  }
  if (!one || !two) return finding;
  const auto a = results.value(*one, claim.quantity), b = results.value(*two, claim.quantity);
  finding.known = a && b && *b != 0;
  if (!finding.known) {
    finding.words = others_of(*group.front(), claim.axis) + "not measured";
    return finding;
  }
  const double off = (*a - *b) / std::abs(*b);
  finding.holds = (std::abs(off) <= claim.tolerance) == (claim.rule == Claim::Rule::agree);
  finding.words =
      fmt::format("{}{:.4g} against {:.4g} ({:+.3g} %)", others_of(*one, claim.axis), *a, *b, 100 * off);
  return finding;
}

Finding same_time(const Results& results, const Claim& claim, const PlannedRun& run) {
  Finding finding;
  const std::string metric = "time_of_" + claim.quantity.metric;
  const auto one = results.value(run, {claim.quantity.probe, metric});
  const auto two = results.value(run, {claim.other_probe, metric});
  finding.known = one && two;
  finding.words =
      run.name + ": " + (finding.known ? fmt::format("{:.4g} s and {:.4g} s", *one, *two) : "not measured");
  if (finding.known) finding.holds = std::abs(*one - *two) <= claim.tolerance;
  return finding;
}

/// |q| of one run against the limit.
Finding at_most(const Results& results, const Claim& claim, const PlannedRun& run) {
  const auto q = results.value(run, claim.quantity);
  return {.known = q.has_value(),
          .holds = q && std::abs(*q) <= claim.tolerance,
          .words = run.name + ": " + (q ? fmt::format("{:.3g}", *q) : "not measured")};
}

/// Rms over the last fifth of the record, over the largest of it.
Finding decays(const Results& results, const Claim& claim, const PlannedRun& run) {
  Finding finding;
  finding.words = run.name + ": not measured";
  if (!results.values.contains(run.name)) return finding;
  const RecordSource source(results.outcome.at(run.name).folder.string());
  if (!source.has(claim.quantity.probe)) return finding;
  const Record record = source.record(claim.quantity.probe);
  const auto largest = peak(record.curve);
  if (!largest || largest->value == 0) return finding;
  const double from = record.curve.time.front(), to = record.curve.time.back();
  constexpr double last = 0.2;
  const double left = rms(record.curve, to - last * (to - from), to) / std::abs(largest->value);
  finding.known = true;
  finding.holds = left <= claim.tolerance;
  finding.words =
      fmt::format("{}: {:.3g} % of its peak is left (rms of the last fifth)", run.name, 100 * left);
  return finding;
}

std::vector<Finding> findings(const Results& results, const Claim& claim) {
  std::vector<Finding> all;
  using Rule = Claim::Rule;
  if (claim.rule == Rule::same_time || claim.rule == Rule::decays || claim.rule == Rule::at_most) {
    for (const PlannedRun* run : results.runs(claim.where))
      all.push_back(claim.rule == Rule::decays      ? decays(results, claim, *run)
                    : claim.rule == Rule::same_time ? same_time(results, claim, *run)
                                                    : at_most(results, claim, *run));
    return all;
  }
  for (const Group& group : groups_along(results, claim.axis, claim.where))
    all.push_back(claim.rule == Rule::agree || claim.rule == Rule::differ ? agree(results, claim, group)
                                                                          : along(results, claim, group));
  return all;
}

ClaimResult judge(const Results& results, const Claim& claim) {
  ClaimResult result = {claim.claim, claim.source, "", "cannot be judged", claim.why};
  if (claim.rule == Claim::Rule::none) return result;
  bool all_known = true, all_hold = true;
  std::vector<std::string> words;
  for (const Finding& finding : findings(results, claim)) {
    if (!finding.words.empty()) words.push_back(finding.words);
    all_known = all_known && finding.known;
    all_hold = all_hold && finding.holds;
  }
  result.measured = fmt::format("{}: {}", claim.quantity.name(), joined(words, "; "));
  if (words.empty() || !all_known)
    result.why = "not all of its runs are done. " + claim.why;
  else
    result.verdict = all_hold ? "holds" : "does not hold";
  return result;
}

}  // namespace

std::vector<ClaimResult> judge_claims(const Results& results) {
  std::vector<ClaimResult> all;
  for (const Claim& claim : results.plan->claims) all.push_back(judge(results, claim));
  return all;
}

}  // namespace strake::study
