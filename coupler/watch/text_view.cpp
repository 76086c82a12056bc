#include "coupler/watch/text_view.hpp"

#include "coupler/console/console.hpp"
#include "coupler/plot/ticks.hpp"
#include "coupler/watch/select_run.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>

namespace strake::watch {
namespace {

constexpr std::size_t most_columns = 5;  // of the table in a pipe, beside window and time
constexpr int least_side_by_side = 100;  // [characters] from which on curves stand in two columns

const char* colour_of(State state) {
  switch (state) {
    case State::running:
    case State::finished:
      return "32";
    case State::starting:
      return "36";
    case State::silent:
    case State::stopped:
    case State::away:
      return "33";
    case State::failed:
    case State::killed:
      return "31";
  }
  return "0";
}

std::string clocks_text(const RunStatus& g) {
  std::string text = duration_text(g.elapsed);
  if (g.left) text += fmt::format(", about {} left", duration_text(*g.left));
  return text;
}

std::string head_text(const RunStatus& g) {
  std::string text = fmt::format("window {}   t {}", grouped(g.window), value_text(g.time, "s"));
  if (g.end_time) text += " of " + value_text(*g.end_time, "s");
  return text + "   " + clocks_text(g);
}

std::string bar_text(double share, std::size_t width) {
  // Eighths of a block: U+2588 is whole, U+258F an eighth.
  const auto eighths = static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * static_cast<double>(8 * width));
  std::string bar;
  for (std::size_t k = 0; k < width; ++k) {
    const std::size_t filled = eighths > 8 * k ? std::min<std::size_t>(8, eighths - 8 * k) : 0;
    if (filled == 0)
      bar += "·";
    else
      bar += {static_cast<char>(0xE2), static_cast<char>(0x96), static_cast<char>(0x90 - filled)};
  }
  return bar;
}

/// A curve with its name, latest value and extremes above it.
std::vector<std::string> curve_block(const WatchedRun& run, std::size_t column, std::size_t width, int rows) {
  const TableTail& table = run.history();
  const Column& of = table.columns()[column];
  const auto& y = table.value()[column];
  const auto clock = table.find("time");
  const Extremes ends = extremes(table, column);
  const auto text = [&](double v) { return value_text(v, of.unit); };
  std::vector<std::string> block;
  std::string head = of.name + "  " + (y.empty() ? "no data yet" : text(y.back()));
  if (ends.any && ends.lo < ends.hi) {
    const bool low = std::abs(ends.lo) > std::abs(ends.hi);
    const std::string peak =
        fmt::format("   {} {} at {}", low ? "least" : "largest", text(low ? ends.lo : ends.hi),
                    value_text(low ? ends.time_lo : ends.time_hi, "s"));
    if (shown_width(head + peak) <= width) head += peak;
  }
  block.push_back(fitted(head, width));
  constexpr std::size_t edge = 11;  // [characters] of the scale
  const BraillePlot curve = braille_plot(clock ? table.value()[*clock] : y, y,
                                         static_cast<int>(width - edge - 2), rows, is_logarithmic(of.name));
  for (std::size_t r = 0; r < curve.lines.size(); ++r) {
    std::string scale;
    if (ends.any && r == 0) scale = text(curve.hi);
    if (ends.any && r + 1 == curve.lines.size() && curve.lines.size() > 1) scale = text(curve.lo);
    const std::size_t has = shown_width(scale);
    block.push_back((has < edge ? std::string(edge - has, ' ') + scale : fitted(scale, edge)) + " │" +
                    curve.lines[r]);
  }
  return block;
}

std::string processes_text(const RunStatus& g) {
  std::string text;
  for (const Process& process : g.processes)
    text += fmt::format("{}{} {} ({}, {:.0f} MB)", text.empty() ? "" : "   ", process.name,
                        words_for_state(process.state), duration_text(process.cpu_seconds),
                        1e-6 * process.memory_bytes);
  return text;
}

std::string stages_text(const WatchedRun& run) {
  const auto found = stages(run);
  double total = 0;
  for (const Stage& stage : found) total += stage.seconds;
  std::string text;
  for (std::size_t k = 0; k < std::min<std::size_t>(5, found.size()) && total > 0; ++k)
    text += fmt::format("{}{} {:.0f} %", k == 0 ? "" : "   ", found[k].name, 100 * found[k].seconds / total);
  return text;
}

/// Of the last window; empty where nothing is coupled.
std::string coupling_text(const TableTail& history) {
  const auto iterations = history.last("iterations"), gap = history.last("work_gap");
  if (!iterations) return {};
  const auto residual = history.find("residual");
  const std::string unit = residual ? history.columns()[*residual].unit : "1";
  return fmt::format("coupling   {:.0f} iterations   residual {:.1e}{}{}", *iterations,
                     history.last("residual").value_or(NAN), unit == "1" ? "" : " " + unit,
                     gap ? "   work gap " + value_text(*gap, "1") : "");  // none: no force crosses
}

void wrap(std::vector<std::string>& lines, const std::string& text, std::size_t width) {
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(fitted("  " + line, width));
}

}  // namespace

std::string value_text(double value, const std::string& unit) {
  if (!std::isfinite(value)) return "–";
  const Prefix prefix = prefix_for(value, unit);
  const double shown = prefix.factor * value;
  const std::string name = with_prefix(prefix, unit);
  const std::string number = shown != 0 && (std::abs(shown) >= 1e5 || std::abs(shown) < 1e-3)
                                 ? fmt::format("{:.2e}", shown)
                                 : fmt::format("{:.4g}", shown);
  return name.empty() ? number : number + " " + name;
}

std::vector<std::string> screen_lines(const WatchedRun& run, const Screen& screen) {
  const RunStatus& g = run.last();
  const auto width = static_cast<std::size_t>(std::clamp(screen.width, 40, 400));
  const auto height = static_cast<std::size_t>(std::max(screen.height, 8));
  std::vector<std::string> lines;
  const std::string folder = visible(run.folder().string(), ""), title = visible(run.title(), "");
  const std::size_t room = width > shown_width(folder) + 2 ? width - shown_width(folder) - 2 : 0;
  lines.push_back(room > 12 ? painted({.colour = screen.colour}, "1", fitted(title, room)) + "  " + folder
                            : fitted(title, width));
  const std::string state =
      fitted(g.words.starts_with(name_of(g.state)) ? g.words : name_of(g.state) + ": " + g.words, width);
  lines.push_back(painted({.colour = screen.colour}, colour_of(g.state), state));
  lines.push_back(fitted(head_text(g), width));
  if (g.end_time && *g.end_time > 0) {
    const double share = g.time / *g.end_time;
    lines.push_back(bar_text(share, width - 8) + fmt::format(" {:5.1f} %", 100 * std::min(share, 1.0)));
  }
  if (!g.error.empty()) wrap(lines, g.error, width);

  std::vector<std::string> foot;
  if (const std::string text = coupling_text(run.history()); !text.empty())
    foot.push_back(fitted(text, width));
  if (const std::string text = processes_text(g); !text.empty())
    foot.push_back(fitted("processes  " + text, width));
  if (const std::string text = stages_text(run); !text.empty())
    foot.push_back(fitted("time       " + text, width));

  if (run.history().rows() == 0) {
    lines.emplace_back();
    lines.push_back(fitted(open(g.state) ? "no window is done yet: curves begin with the first one"
                                         : "no window was done: there are no curves",
                           width));
  } else {
    const bool pairs = screen.width >= least_side_by_side;
    const std::size_t taken = lines.size() + foot.size() + 2;
    const std::size_t free = height > taken ? height - taken : 0;
    constexpr std::size_t least = 4;  // lines of a block: a head, two of curve, a gap
    const std::size_t columns = pairs ? 2 : 1;
    const auto chosen = chosen_columns(run, std::min<std::size_t>(8, columns * (free / least)));
    const std::size_t bands = (chosen.size() + columns - 1) / columns;
    const int rows = bands == 0 ? 0 : static_cast<int>(std::min<std::size_t>(8, free / bands - 2));
    const std::size_t each = pairs ? (width - 3) / 2 : width;
    for (std::size_t k = 0; k < chosen.size(); k += columns) {
      lines.emplace_back();
      const auto left = curve_block(run, chosen[k], each, rows);
      const auto right = pairs && k + 1 < chosen.size() ? curve_block(run, chosen[k + 1], each, rows)
                                                        : std::vector<std::string>(left.size());
      for (std::size_t r = 0; r < left.size(); ++r)
        lines.push_back(right[r].empty() ? left[r] : left[r] + "   " + right[r]);
    }
  }
  lines.emplace_back();
  lines.insert(lines.end(), foot.begin(), foot.end());
  if (lines.size() > height) lines.resize(height);
  return lines;
}

void PlainLines::put(const std::string& line) {
  strake::put(stream_, visible(line) + "\n");
}

void PlainLines::say_state(const WatchedRun& run) {
  const RunStatus& g = run.last();
  if (name_of(g.state) == said_) return;
  said_ = name_of(g.state);
  put("  " + (g.words.starts_with(said_) ? g.words : said_ + ": " + g.words));
}

void PlainLines::begin(const WatchedRun& run) {
  put(fmt::format("{:<42}  {}", run.title(), run.folder().string()));
  say_state(run);
}

void PlainLines::more(const WatchedRun& run) {
  say_state(run);
  const TableTail& table = run.history();
  if (table.rows() > 0 && (columns_.empty() || table.generation() != generation_)) {
    generation_ = table.generation();
    columns_.clear();
    for (const char* name : {"iterations", "residual"})
      if (const auto column = table.find(name)) columns_.push_back(*column);
    for (const std::size_t column : chosen_columns(run, most_columns))
      if (std::find(columns_.begin(), columns_.end(), column) == columns_.end()) columns_.push_back(column);
    std::string titles = fmt::format("\n{:>8}  {:>10}", "window", "t [s]");
    widths_.clear();
    for (const std::size_t column : columns_) {
      const Column& of = table.columns()[column];
      const std::string title = of.unit == "1" ? of.name : fmt::format("{} [{}]", of.name, of.unit);
      widths_.push_back(std::max<std::size_t>(11, shown_width(title)));
      titles += fmt::format("  {:>{}}", title, widths_.back());
    }
    put(titles);
  }
  if (table.rows() > 0 && run.last().window != window_) {
    window_ = run.last().window;
    std::string line = fmt::format("{:>8}  {:>10.6f}", window_, run.last().time);
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const double value = table.value()[columns_[k]].back();
      line += fmt::format("  {:>{}}", std::isfinite(value) ? fmt::format("{:.5g}", value) : "-", widths_[k]);
    }
    put(line);
  }
}

void PlainLines::end(const WatchedRun& run) {
  more(run);
  const RunStatus& g = run.last();
  put("\n" + name_of(g.state) + "  " + head_text(g));
  if (!g.error.empty()) {
    std::istringstream stream(g.error);
    for (std::string line; std::getline(stream, line);) put("  " + line);
  }
  for (const std::string& probe : run.probes())
    for (const std::string& name : {probe, probe + ".y"})
      if (const auto column = run.history().find(name)) {
        const Extremes ends = extremes(run.history(), *column);
        const std::string& unit = run.history().columns()[*column].unit;
        if (ends.any)
          put(fmt::format("  {:<16}least {} at {}   largest {} at {}", name, value_text(ends.lo, unit),
                          value_text(ends.time_lo, "s"), value_text(ends.hi, unit),
                          value_text(ends.time_hi, "s")));
      }
}

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
