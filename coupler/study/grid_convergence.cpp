#include "coupler/study/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace strake::study {
namespace {

constexpr double safety = 1.25;  // Roache's factor for three grids

constexpr double steepest = 20;  // orders above are round-off

/// ε32/ε21 of a result whose error goes with h^p.
double ratio_of(double p, double r21, double r32) {
  return std::pow(r21, p) * std::expm1(p * std::log(r32)) / std::expm1(p * std::log(r21));
}

/// The p > 0 that gives `ratio`; it grows with p from ln r32 / ln r21. None below that.
std::optional<double> observed_order(double ratio, double r21, double r32) {
  double low = 1e-9, high = steepest;
  if (ratio <= ratio_of(low, r21, r32) || ratio >= ratio_of(high, r21, r32)) return std::nullopt;
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (ratio_of(middle, r21, r32) < ratio ? low : high) = middle;
  }
  return low;
}

}  // namespace

GridConvergence grid_convergence(std::vector<double> along, std::vector<double> value) {
  GridConvergence result;
  result.along = std::move(along);
  result.value = std::move(value);
  const std::size_t n = result.value.size();
  if (n < 3) {
    result.remark = "fewer than three values: no order";
    return result;
  }
  const double h1 = result.along[n - 1], h2 = result.along[n - 2], h3 = result.along[n - 3];
  const double f1 = result.value[n - 1], f2 = result.value[n - 2], f3 = result.value[n - 3];
  const double e21 = f2 - f1, e32 = f3 - f2, r21 = h2 / h1, r32 = h3 / h2;
  const double scale = std::max({std::abs(f1), std::abs(f2), std::abs(f3)});
  constexpr double round_off = 1e-12;
  if (std::abs(e21) <= round_off * scale) {
    result.remark = "the two finest agree to round-off";
    return result;
  }
  if (e32 / e21 < 0) {
    // Alternating differences: half of the last one is what can be said.
    result.remark =
        f1 == 0 ? std::string("oscillates about 0")
                : fmt::format("oscillates: the last two differ by {:.2g} %", 100 * std::abs(e21 / f1));
    return result;
  }
  const auto p = observed_order(e32 / e21, r21, r32);
  if (!p) {
    const bool fast = e32 / e21 >= ratio_of(steepest, r21, r32);
    result.remark = fast ? "its differences fall faster than any order" : "does not converge";
    return result;
  }
  result.order = p;
  const double gain = std::pow(r21, *p) - 1;
  result.extrapolated = f1 - e21 / gain;
  result.gci = f1 != 0 ? std::optional(safety * std::abs(e21 / f1) / gain) : std::nullopt;
  result.remark = "converges";
  return result;
}

std::vector<GridConvergence> judge_convergence(const Results& results) {
  std::vector<GridConvergence> all;
  for (const Convergence& asked : results.plan->convergences) {
    std::vector<AxisValue> values = results.plan->axis(asked.axis).values;
    std::sort(values.begin(), values.end(), [](const auto& a, const auto& b) { return *a.at > *b.at; });
    std::set<std::map<std::string, std::string>> seen;
    for (const PlannedRun* run : results.runs(asked.where)) {
      Filter others(run->label.begin(), run->label.end());
      others.erase(asked.axis);
      if (!seen.insert(others).second) continue;
      std::vector<double> along, value;
      std::vector<std::string> names;
      for (const AxisValue& at : values) {
        Filter one = others;
        one[asked.axis] = at.label;
        for (const PlannedRun* found : results.runs(one))
          if (const auto q = results.value(*found, asked.quantity)) {
            along.push_back(*at.at);
            value.push_back(*q);
            names.push_back(found->name);
          }
      }
      GridConvergence judged = grid_convergence(std::move(along), std::move(value));
      std::string rest;
      for (const auto& [axis, label] : others)
        rest += fmt::format("{}{} {}", rest.empty() ? ": " : ", ", axis, label);
      judged.title = asked.title + rest;
      judged.axis = asked.axis;
      judged.probe = asked.quantity.probe;
      judged.metric = asked.quantity.metric;
      judged.runs = std::move(names);
      all.push_back(std::move(judged));
    }
  }
  return all;
}

}  // namespace strake::study
