#include "coupler/watch/braille_plot.hpp"

#include "proto/visible.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace strake::watch {
namespace {

/// The bit of the dot in column c and row r of 2×4. U+2800 has dots 1 to 8 as bits (Unicode, "Braille
/// Patterns").
constexpr std::array<std::array<std::uint8_t, 4>, 2> dot = {
    {{0x01, 0x02, 0x04, 0x40}, {0x08, 0x10, 0x20, 0x80}}};

std::string braille(std::uint8_t dots) {
  return {static_cast<char>(0xE2), static_cast<char>(0xA0 | (dots >> 6)),
          static_cast<char>(0x80 | (dots & 0x3F))};
}

bool begins_character(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
}

}  // namespace

BraillePlot braille_plot(const std::vector<double>& x, const std::vector<double>& y, int columns, int rows,
                         bool logarithmic) {
  const auto shown = [&](double v) { return logarithmic ? (v > 0 ? std::log10(v) : std::nan("")) : v; };
  BraillePlot curve;
  double x0 = INFINITY, x1 = -INFINITY, lo = INFINITY, hi = -INFINITY;
  const std::size_t n = std::min(x.size(), y.size());
  for (std::size_t i = 0; i < n; ++i) {
    const double v = shown(y[i]);
    if (!std::isfinite(x[i]) || !std::isfinite(v)) continue;
    x0 = std::min(x0, x[i]);
    x1 = std::max(x1, x[i]);
    lo = std::min(lo, v);
    hi = std::max(hi, v);
  }
  const auto width = static_cast<std::size_t>(columns), height = static_cast<std::size_t>(rows);
  if (!(lo <= hi) || columns < 1 || rows < 1) {
    curve.lines.assign(height, std::string(width, ' '));
    return curve;
  }
  curve.lo = logarithmic ? std::pow(10, lo) : lo;
  curve.hi = logarithmic ? std::pow(10, hi) : hi;
  std::vector<std::uint8_t> cell(width * height, 0);
  const int across = 2 * columns, up = 4 * rows;
  const auto place = [](double v, double from, double to, int dots) {
    if (!(to > from)) return dots / 2;
    return std::clamp(static_cast<int>((v - from) / (to - from) * (dots - 1) + 0.5), 0, dots - 1);
  };
  const auto set = [&](int c, int r) {  // r counts from below
    const int down = up - 1 - r;
    cell[static_cast<std::size_t>(down / 4) * width + static_cast<std::size_t>(c / 2)] |=
        dot[static_cast<std::size_t>(c % 2)][static_cast<std::size_t>(down % 4)];
  };
  struct Point {
    int c, r;
  };
  std::optional<Point> before;
  for (std::size_t i = 0; i < n; ++i) {
    const double v = shown(y[i]);
    if (!std::isfinite(x[i]) || !std::isfinite(v)) {
      before.reset();
      continue;
    }
    const Point p = {place(x[i], x0, x1, across), place(v, lo, hi, up)};
    const Point from = before.value_or(p);
    const int steps = std::max({1, std::abs(p.c - from.c), std::abs(p.r - from.r)});
    for (int s = 0; s <= steps; ++s)
      set(from.c + static_cast<int>(std::lround(static_cast<double>(s) * (p.c - from.c) / steps)),
          from.r + static_cast<int>(std::lround(static_cast<double>(s) * (p.r - from.r) / steps)));
    before = p;
  }
  for (std::size_t r = 0; r < height; ++r) {
    std::string line;
    for (std::size_t c = 0; c < width; ++c) line += braille(cell[r * width + c]);
    curve.lines.push_back(std::move(line));
  }
  return curve;
}

std::size_t shown_width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), begins_character));
}

std::string fitted(const std::string& given, std::size_t width) {
  const std::string text = visible(given, "");
  const std::size_t has = shown_width(text);
  if (has <= width) return text + std::string(width - has, ' ');
  if (width == 0) return {};
  std::string cut;
  std::size_t taken = 0;
  for (const char c : text) {
    if (begins_character(c) && ++taken == width) break;
    cut += c;
  }
  return cut + "…";
}

}  // namespace strake::watch
