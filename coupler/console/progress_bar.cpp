#include "coupler/console/progress_bar.hpp"

#include "coupler/console/console.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake {
namespace {

constexpr double shortest_look = 5, share_looked_at = 0.25;  // [s], part of the run
constexpr double least_known = 0.5;                          // [s] before anything is shown
constexpr std::size_t samples_kept = 200;
constexpr int shortest_bar = 8, longest_bar = 30;  // characters within the brackets

/// The code points of a UTF-8 text, one after another; a broken byte counts as one.
std::size_t length_at(const std::string& text, std::size_t at) {
  const auto byte = static_cast<unsigned char>(text[at]);
  const std::size_t length = byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : byte >= 0xC0 ? 2 : 1;
  return std::min(length, text.size() - at);
}

/// Scripts whose letters take two places begin with Hangul, U+1100: E1 84 80 in UTF-8. Block characters
/// (U+2500 and near) take one.
int width_at(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t k) {
    return at + k < text.size() ? static_cast<unsigned char>(text[at + k]) : 0;
  };
  if (byte(0) < 0xE1) return 1;
  if (byte(0) == 0xE2) return byte(1) >= 0xBA ? 2 : 1;
  return byte(0) == 0xE1 && byte(1) < 0x84 ? 1 : 2;
}

std::string bar(double part, int width, bool unicode) {
  const std::string full = unicode ? "█" : "#", empty = unicode ? "·" : "-";
  const int done = static_cast<int>(std::floor(part * width + 1e-9));
  std::string text = "[";
  for (int k = 0; k < width; ++k) text += k < done ? full : empty;
  return text + "]";
}

/// "12 700", "165", "3.21".
std::string rate_text(double rate) {
  if (rate >= 100) return grouped(std::llround(rate));
  return fmt::format("{:.3g}", rate);
}

}  // namespace

void RecentSpeed::add(double elapsed, double time, double steps) {
  if (samples_.empty()) begin_ = elapsed;
  const double look = std::max(shortest_look, share_looked_at * (elapsed - begin_));
  // The last sample is renewed until it is worth one of its own.
  const bool renew =
      samples_.size() > 1 && elapsed - samples_[samples_.size() - 2].elapsed < look / samples_kept;
  if (renew) samples_.pop_back();
  samples_.push_back({elapsed, time, steps});
  while (samples_.size() > 2 && samples_[1].elapsed < elapsed - look) samples_.pop_front();
}

std::optional<double> RecentSpeed::remaining(double end) const {
  if (samples_.size() < 2) return std::nullopt;
  const double seconds = samples_.back().elapsed - samples_.front().elapsed;
  const double gained = samples_.back().time - samples_.front().time;
  if (seconds < least_known || gained <= 0) return std::nullopt;
  return std::max(0.0, end - samples_.back().time) * seconds / gained;
}

std::optional<double> RecentSpeed::steps_per_second() const {
  if (samples_.size() < 2) return std::nullopt;
  const double seconds = samples_.back().elapsed - samples_.front().elapsed;
  const double steps = samples_.back().steps - samples_.front().steps;
  if (seconds < least_known || !std::isfinite(steps) || steps < 0) return std::nullopt;
  return steps / seconds;
}

int display_width(const std::string& text) {
  int width = 0;
  for (std::size_t at = 0; at < text.size(); at += length_at(text, at)) width += width_at(text, at);
  return width;
}

std::string cut_to_width(const std::string& text, int width) {
  int taken = 0;
  std::size_t at = 0;
  while (at < text.size() && taken + width_at(text, at) <= width) {
    taken += width_at(text, at);
    at += length_at(text, at);
  }
  return text.substr(0, at);
}

std::vector<std::string> progress_rows(const Progress& p, int width, bool unicode) {
  const int room = width - 1;
  if (room < 1) return {};
  const double part = p.end_time > 0 ? std::clamp(p.time / p.end_time, 0.0, 1.0) : 0;
  const std::string percent = fmt::format("{:3.0f} %", std::floor(100 * part + 1e-9));
  // In the order of their places on the line, which is that of their importance as well.
  std::vector<std::string> parts = {fmt::format("t {:.6f} of {:g} s", p.time, p.end_time)};
  if (p.remaining) parts.push_back(duration_text(*p.remaining) + " left");
  if (p.iterations > 0)
    parts.push_back(fmt::format("{} iteration{}", p.iterations, p.iterations == 1 ? "" : "s"));
  if (p.steps_per_second) parts.push_back(rate_text(*p.steps_per_second) + " steps/s");
  std::string tail;
  const int head = display_width(percent) + 1 + 2 + shortest_bar;
  int taken = head;
  for (const std::string& text : parts) {
    if (taken + 2 + display_width(text) > room) break;
    tail += "  " + text;
    taken += 2 + display_width(text);
  }
  const int bar_width = std::min(longest_bar, shortest_bar + room - taken);
  std::vector<std::string> rows;
  rows.push_back(cut_to_width(
      bar_width >= shortest_bar ? percent + " " + bar(part, bar_width, unicode) + tail : percent + tail,
      room));
  std::string second;
  if (!p.waiting.empty()) {
    second = cut_to_width("  " + p.waiting, room);
  } else {
    for (const std::string& probe : p.probes)
      if (display_width(second) + 3 + display_width(probe) <= room) second += "   " + probe;
  }
  if (!second.empty()) rows.push_back(second);
  return rows;
}

void LiveRows::show(const std::string& above, const std::vector<std::string>& rows, int width) {
  if (drawn_.empty() && above.empty() && rows.empty()) return;
  std::string text;
  int lines = 0;
  for (const int of_row : drawn_) lines += width > 0 ? std::max(1, (of_row + width - 1) / width) : 1;
  if (lines > 0) text += fmt::format("\r\033[{}A\033[J", lines);
  text += above;
  drawn_.clear();
  for (const std::string& row : rows) {
    text += row + "\n";
    drawn_.push_back(display_width(row));
  }
  put(stream_, text);
}

}  // namespace strake
