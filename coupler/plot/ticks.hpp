#pragma once

#include <string>
#include <utility>
#include <vector>

namespace strake {

/// Round numbers (1, 2 or 5 times a power of ten apart) within [lo, hi], about `wanted` of them.
std::vector<double> round_ticks(double lo, double hi, int wanted);
/// About so many round numbers, but two at least where there are, since one tick tells no scale; each with
/// its text.
std::vector<std::pair<double, std::string>> text_ticks(double lo, double hi, double wanted);
/// A power of ten that units are given in (kPa, mm): factor 1e-3 and prefix "k" for values of thousands.
struct Prefix {
  double factor = 1;  // shown = factor · value
  std::string text;   // before the unit: "k", "M", "m", "µ" …
};
/// The prefix that shows `largest` as a number from 1 to 1000. None for a unit without prefixes ("1", "m^2").
Prefix prefix_for(double largest, const std::string& unit);
/// "MPa" of "Pa" with its prefix; "–" words for the unit "1".
std::string with_prefix(const Prefix&, const std::string& unit);
/// The value as a tick of that distance, with as many decimals as distinguish neighbours.
std::string tick_text(double value, double distance);

/// A name as words: "first_peak" → "first peak".
std::string in_words(std::string name);

}  // namespace strake
