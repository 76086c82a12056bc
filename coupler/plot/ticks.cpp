#include "coupler/plot/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace strake {

std::vector<double> round_ticks(double lo, double hi, int wanted) {
  if (!(hi > lo) || !std::isfinite(hi - lo)) return {};
  const double raw = (hi - lo) / wanted, power = std::pow(10, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double m : {5.0, 2.0, 1.0})
    if (m * power >= raw * (1 - 1e-9)) step = m * power;
  std::vector<double> ticks;
  const double first = std::ceil(lo / step - 1e-9);
  for (double k = first; k * step <= hi + 1e-9 * step && ticks.size() < 100; ++k)
    ticks.push_back(k == 0 ? 0 : k * step);
  return ticks;
}

std::vector<std::pair<double, std::string>> text_ticks(double lo, double hi, double wanted) {
  std::vector<double> round;
  for (int more = 0; round.size() < 2 && more < 4; ++more)
    round = round_ticks(lo, hi, std::max(2, static_cast<int>(wanted)) + more);
  std::vector<std::pair<double, std::string>> ticks;
  for (const double t : round)
    ticks.emplace_back(t, tick_text(t, round.size() > 1 ? round[1] - round[0] : 0));
  return ticks;
}

Prefix prefix_for(double largest, const std::string& unit) {
  // Powers of a unit ("m^2") and pure numbers are written as they are.
  const bool plain = unit.empty() || unit == "1" || unit.find('^') != std::string::npos || unit == "kg" ||
                     unit == "deg" || unit == "rad";
  const double size = std::abs(largest);
  if (plain || size == 0 || !std::isfinite(size)) return {};
  constexpr std::array<std::pair<int, const char*>, 7> known = {
      {{9, "G"}, {6, "M"}, {3, "k"}, {0, ""}, {-3, "m"}, {-6, "µ"}, {-9, "n"}}};
  for (const auto& [exponent, text] : known)
    if (size >= 0.9999 * std::pow(10, exponent)) return {std::pow(10, -exponent), text};
  return {};  // below a thousand-millionth: round-off, which the plain unit shows as what it is
}

std::string with_prefix(const Prefix& prefix, const std::string& unit) {
  return unit == "1" ? std::string() : prefix.text + unit;
}

std::string tick_text(double value, double distance) {
  const double size = std::max(std::abs(value), std::abs(distance));
  if (size >= 1e6 || (size > 0 && size < 1e-4)) return fmt::format("{:.3g}", value);
  const int places =
      distance > 0 ? std::max(0, static_cast<int>(std::ceil(-std::log10(distance) - 1e-9))) : 0;
  return fmt::format("{:.{}f}", value, std::min(places, 9));
}

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

}  // namespace strake
