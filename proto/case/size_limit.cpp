#include "proto/case/size_limit.hpp"

#include "proto/case/case_file.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unistd.h>

namespace strake {
namespace {

constexpr double most_items = 2147483647;  // items are numbered by int and std::int32_t
constexpr double share_of_memory = 0.8;    // the rest is the system's and the other programs'
constexpr double large_memory = 1e9;       // [bytes] a check builds no more
constexpr double large_seconds = 2.5;      // one side is set up several times in a check

double memory_of(const SizeEstimate& estimate) {
  return estimate.count * estimate.bytes_each;
}

/// "10 000", "3.2e12".
std::string count_text(double count) {
  return count < 1e9 ? grouped(std::llrint(count)) : fmt::format("{:.2g}", count);
}

/// `value` with two digits, rounded to the side on which it still fits.
double rounded(double value, bool up) {
  const double digit = std::pow(10, std::floor(std::log10(value)) - 1);
  return (up ? std::ceil(value / digit) : std::floor(value / digit)) * digit;
}

/// Values of the keys, each of which alone would divide the count by `excess`.
std::string remedies(const SizeEstimate& estimate, double excess) {
  std::string text;
  for (const SizeEstimate::Key& key : estimate.keys) {
    const bool up = key.power < 0;
    const double fits = key.value * std::pow(excess, -1 / key.power);
    if (!std::isfinite(fits) || !(fits > 0)) continue;
    text += fmt::format("{}{} = {:.3g} or {}", text.empty() ? "" : "\nor ", key.path, rounded(fits, up),
                        up ? "more" : "less");
  }
  if (!estimate.remedy.empty()) text += (text.empty() ? "" : "\nor ") + estimate.remedy;
  return text;
}

/// The key to show: one that --set gave, else one that the case gave, else the first.
std::string shown_key(const CaseFile& file, const SizeEstimate& estimate) {
  for (const char* origin : {"--set", "case"})
    for (const SizeEstimate::Key& key : estimate.keys)
      for (const KeyInfo& declared : file.declared())
        if (declared.path == key.path && declared.origin == origin) return key.path;
  return estimate.keys.front().path;
}

[[noreturn]] void refuse(const CaseFile& file, const SizeEstimate& estimate, const std::string& expected,
                         double excess) {
  CaseFile reader = file;  // a view of the same document
  if (estimate.keys.empty())
    throw Error(ExitCode::case_file, file.path().string(), expected, "a smaller case");
  throw reader.root().error(shown_key(file, estimate), expected, remedies(estimate, excess));
}

}  // namespace

std::string memory_text(double bytes) {
  if (bytes < 1e9) return fmt::format("{:.0f} MB", std::max(1.0, 1e-6 * bytes));
  return fmt::format("{:.2g} GB", 1e-9 * bytes);
}

double memory_of(const SizeEstimates& estimates) {
  double bytes = 0;
  for (const SizeEstimate& estimate : estimates) bytes += memory_of(estimate);
  return bytes;
}

double seconds_of(const SizeEstimates& estimates) {
  double seconds = 0;
  for (const SizeEstimate& estimate : estimates) seconds += estimate.count * estimate.seconds_each;
  return seconds;
}

double usable_memory() {
  return share_of_memory * static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
         static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

bool is_large(const SizeEstimates& estimates, double times) {
  return memory_of(estimates) > large_memory || times * seconds_of(estimates) > large_seconds;
}

std::string remedy_of(const SizeEstimates& estimates) {
  const auto largest = std::max_element(
      estimates.begin(), estimates.end(),
      [](const SizeEstimate& a, const SizeEstimate& b) { return memory_of(a) < memory_of(b); });
  return largest == estimates.end() ? std::string() : largest->remedy;
}

std::string size_text(const SizeEstimates& estimates) {
  std::string text;
  for (const SizeEstimate& estimate : estimates)
    if (estimate.count >= 1)
      text +=
          fmt::format("{}{} {}", text.empty() ? "about " : ", ", count_text(estimate.count), estimate.what);
  return text.empty() ? text : text + ": " + memory_text(memory_of(estimates));
}

void refuse_oversized(const CaseFile& file, const SizeEstimates& estimates, double most) {
  for (const SizeEstimate& estimate : estimates)
    if (!(estimate.count <= most_items))
      refuse(
          file, estimate,
          fmt::format("at most {:.2g} {}, these would be {:.2g}", most_items, estimate.what, estimate.count),
          estimate.count / std::min(most_items, 0.9 * most / std::max(1.0, estimate.bytes_each)));
  const double all = memory_of(estimates);
  if (all <= most) return;
  const SizeEstimate& largest = *std::max_element(
      estimates.begin(), estimates.end(),
      [](const SizeEstimate& a, const SizeEstimate& b) { return memory_of(a) < memory_of(b); });
  // What the largest may keep of the memory beside all others, which mostly shrink with it.
  const double left = std::max(most - (all - memory_of(largest)), 0.1 * most);
  refuse(file, largest,
         fmt::format("a case of at most {}: {} {} and what goes with them would take about {}",
                     memory_text(most), count_text(largest.count), largest.what, memory_text(all)),
         memory_of(largest) / left);
}

}  // namespace strake
