#include "coupler/summary/comparison_status.hpp"

#include <cmath>

namespace strake {

namespace {

/// A metric below this share of its reference is noise before the event of its block. It is then judged at
/// the end of the run. The share is the 5 % of the first peak in cases/VALIDATION.md, "Definitions".
constexpr double too_early = 0.05;

}  // namespace

ComparisonStatus::ComparisonStatus(const CaseView& view) {
  const CaseLookup lookup = lookup_in(view.value);
  for (const CompareBlock& block : view.blocks)
    if (applies(block, lookup)) blocks_.push_back(block);
  settled_.assign(blocks_.size(), false);
}

std::vector<Verdict> ComparisonStatus::settle(const RunData& now) {
  std::vector<Verdict> news;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (settled_[i]) continue;
    const std::vector<Verdict> verdicts = judge(blocks_[i], now);
    bool known = !verdicts.empty();
    for (const Verdict& verdict : verdicts)
      known = known && verdict.result != Verdict::Result::not_reached &&
              std::abs(verdict.value.value_or(0)) >= too_early * std::abs(verdict.reference);
    if (!known) continue;
    settled_[i] = true;
    news.insert(news.end(), verdicts.begin(), verdicts.end());
  }
  return news;
}

std::vector<Verdict> ComparisonStatus::all(const RunData& data) const {
  std::vector<Verdict> verdicts;
  for (const CompareBlock& block : blocks_)
    for (Verdict& verdict : judge(block, data)) verdicts.push_back(std::move(verdict));
  return verdicts;
}

}  // namespace strake
