// Deviations from values about zero: a percentage of such a value says nothing.
#include "coupler/compare/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace strake {
namespace {

constexpr double small_part = 0.01;

std::string family_of(const std::string& quantity) {
  return quantity.substr(0, quantity.rfind('.'));
}

/// The metrics whose sizes can be held against those of another component.
bool has_size(const std::string& metric) {
  return is_value_of_curve(metric) || metric == "impulse" || metric == "rms";
}

bool is_small(const MetricRow& row, std::size_t record) {
  const auto &one = row.value.front(), &other = row.value[record];
  return one && other && std::abs(*one) < small_part * std::abs(*other);
}

std::string in_percent(double part) {
  return fmt::format("{:+.3g} %", 100 * part);
}

/// The component whose first value of metric m is the largest, among those of one name and unit.
LargestComponent largest_component(const std::vector<std::string>& quantities,
                                   const std::vector<Comparison>& made, std::size_t q, std::size_t m) {
  LargestComponent largest;
  for (std::size_t other = 0; other < made.size(); ++other) {
    const MetricRow& same = made[other].rows[m];
    const bool component = quantities[other].find('.') != std::string::npos &&
                           family_of(quantities[other]) == family_of(quantities[q]);
    if (!component || same.unit != made[q].rows[m].unit || !same.value.front()) continue;
    if (const double size = std::abs(*same.value.front()); size > largest.value)
      largest = {quantities[other], size};
  }
  return largest;
}

/// l2 = rms(q - q_1)/rms(q_1) and dtw = mean|q - q_1|/peak(q_1), with the largest component below the line.
void scale_differences(Comparison& c) {
  for (const auto& [scale, difference] : {std::pair("rms", "l2"), std::pair("peak", "dtw")})
    for (const MetricRow& size : c.rows)
      for (MetricRow& row : c.rows) {
        if (size.name != scale || row.name != difference || !size.beside) continue;
        row.beside = size.beside;
        for (std::size_t r = 1; r < row.value.size(); ++r)
          if (row.value[r])
            row.value[r] = row.deviation[r] =
                *row.value[r] * std::abs(*size.value.front()) / size.beside->value;
      }
}

}  // namespace

void find_small_components(const std::vector<std::string>& quantities, std::vector<Comparison>& made) {
  for (std::size_t q = 0; q < made.size(); ++q) {
    for (std::size_t m = 0; m < made[q].rows.size(); ++m) {
      MetricRow& row = made[q].rows[m];
      if (!has_size(row.name) || !row.value.front()) continue;
      const LargestComponent largest = largest_component(quantities, made, q, m);
      if (!(std::abs(*row.value.front()) < small_part * largest.value)) continue;
      row.beside = largest;
      // (q - q_1)/|Q_1|, with Q the largest component
      for (std::size_t r = 1; r < row.value.size(); ++r)
        if (row.value[r]) row.deviation[r] = (*row.value[r] - *row.value.front()) / largest.value;
    }
    scale_differences(made[q]);
  }
}

std::string deviation_text(const MetricRow& row, std::size_t record) {
  if (!row.beside && has_size(row.name) && is_small(row, record)) return "(1) small";
  if (!row.deviation[record]) return "";
  return in_percent(*row.deviation[record]) + (row.beside ? " *" : "");
}

std::vector<std::string> deviation_notes(const std::string& quantity, const Comparison& c) {
  std::vector<std::string> notes;
  const auto say = [&](std::string line) {
    if (std::find(notes.begin(), notes.end(), line) == notes.end()) notes.push_back(std::move(line));
  };
  for (const MetricRow& row : c.rows) {
    if (row.beside)
      say(fmt::format("*: small, {0} is below {1:g} % of {2} in (1); the difference is given in % of {2}",
                      quantity, 100 * small_part, row.beside->quantity));
    for (std::size_t r = 1; r < row.value.size() && !row.beside && has_size(row.name); ++r)
      if (is_small(row, r))
        say(fmt::format(
            "(1) small: the value of (1) is below {:g} % of the one beside it; a percentage of it says "
            "nothing",
            100 * small_part));
  }
  return notes;
}

}  // namespace strake
