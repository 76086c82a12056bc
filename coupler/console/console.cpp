#include "coupler/console/console.hpp"

#include "coupler/timing/profile.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <fcntl.h>
#include <string_view>
#include <sys/ioctl.h>
#include <unistd.h>

// What every way of telling a run shares, and the quiet one.

namespace strake {

namespace {

class QuietReporter final : public Reporter {
 public:
  QuietReporter(std::FILE* stream, const Style& style) : stream_(stream), style_(style) {}
  void start(const RunHeader& header) override {
    for (const std::string& line : header.warnings) warning(line);
  }
  void window(const RunRow&) override {}
  void verdict(const Verdict&) override {}  // all at the end, also those that were not reached
  void note(const std::string&) override {}
  void alarm(const std::string& line) override {
    put(stream_, fmt::format("{}  {}\n", painted(style_, "31", "alarm"), visible(line)));
  }
  void warning(const std::string& line) override {
    put(stream_, fmt::format("{}  {}\n", painted(style_, "33", "warning"), visible(line)));
  }
  void end(const RunEnd& end) override {
    const Summary& summary = *end.summary;
    if (summary.unconverged() > 0)
      warning(fmt::format("{} of {} windows accepted unconverged", grouped(summary.unconverged()),
                          grouped(summary.windows())));
    std::string text;
    for (const Verdict& verdict : summary.verdicts) text += verdict_text(verdict, style_) + "\n";
    if (end.profile != nullptr)
      for (const std::string& line : end.profile->lines()) text += visible(line) + "\n";
    put(stream_, text);
  }

 private:
  std::FILE* stream_;
  Style style_;
};

int failure = 0;  // errno of the first write that failed

/// What the environment says of the characters: the first of these that is set decides (POSIX).
bool is_utf8() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    const std::string_view text = value;
    return text.find("UTF-8") != std::string_view::npos || text.find("utf8") != std::string_view::npos;
  }
  return false;
}

}  // namespace

Style style_of(std::FILE* stream) {
  Style style;
  const char* kind = std::getenv("TERM");
  const bool moves = kind != nullptr && *kind != '\0' && std::string_view(kind) != "dumb";
  style.terminal = moves && ::isatty(::fileno(stream)) != 0;
  const char* no_colour = std::getenv("NO_COLOR");
  style.colour = style.terminal && (no_colour == nullptr || *no_colour == '\0');
  style.unicode = is_utf8();
  if (style.terminal) style.width = width_of(stream, style);
  return style;
}

void put(std::FILE* stream, const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stream) == text.size() && std::fflush(stream) == 0) return;
  if (stream == stdout && failure == 0) failure = errno;
}

int console_failure() {
  return failure;
}

void hold_streams() {
  for (const int stream : {0, 1, 2})
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", stream == 1 ? O_RDONLY : O_RDWR);
}

int width_of(std::FILE* stream, const Style& style) {
  constexpr int usual = 80;
  winsize size{};
  const int number = ::fileno(stream);
  if (number >= 0 && ::ioctl(number, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return style.width > 0 ? style.width : usual;
}

std::unique_ptr<Reporter> quiet_reporter(std::FILE* stream, const Style& style) {
  return std::make_unique<QuietReporter>(stream, style);
}

std::vector<Column> telling_columns(const RunHeader& header, std::size_t most) {
  std::vector<Column> columns;
  const auto add = [&](const Column& column) {
    const auto same = [&](const Column& other) { return other.name == column.name; };
    if (columns.size() < most && std::none_of(columns.begin(), columns.end(), same))
      columns.push_back(column);
  };
  for (const char* frequency : {"f1", "f2", "f3"})  // of a modal analysis, which has no motion to show
    for (const Column& column : header.columns)
      if (column.name == frequency) add(column);
  if (!columns.empty()) return columns;
  const auto is_judged = [&](const std::string& name) {
    return std::find(header.judged.begin(), header.judged.end(), name) != header.judged.end();
  };
  for (const ProbeKeys& probe : header.probes) {
    const std::array<std::string, 3> parts = {probe.name + ".x", probe.name + ".y", probe.name + ".z"};
    const bool judged = std::any_of(parts.begin(), parts.end(), is_judged);
    for (const Column& column : header.columns) {
      const bool is_part = std::find(parts.begin(), parts.end(), column.name) != parts.end();
      const bool shown = judged ? is_judged(column.name) : column.name.back() == header.thin_axis;
      if (column.name == probe.name || (is_part && shown)) add(column);
    }
  }
  const auto of_probe = [&](const Column& column) {
    return std::any_of(header.probes.begin(), header.probes.end(),
                       [&](const ProbeKeys& probe) { return column.name.starts_with(probe.name + "."); });
  };
  if (!header.coupled)
    for (const Column& column : header.columns)
      if (column.name != "cfl" && column.name != "pressure_iterations" && !of_probe(column)) add(column);
  return columns;
}

std::string block_text(const std::string& name, const std::vector<std::string>& lines) {
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i)
    text += fmt::format("  {:<11}{}\n", i == 0 ? name : "", visible(lines[i]));
  return text;
}

std::string painted(const Style& style, const char* code, const std::string& text) {
  return style.colour ? fmt::format("\033[{}m{}\033[0m", code, text) : text;
}

std::string verdict_text(const Verdict& verdict, const Style& style) {
  const std::string line = visible(verdict.line());
  if (verdict.result == Verdict::Result::not_reached) return line;
  const auto end = line.find(' ');
  const char* code = verdict.result == Verdict::Result::pass ? "32" : "31";
  return painted(style, code, line.substr(0, end)) + line.substr(end);
}

std::string duration_text(double seconds) {
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  constexpr double longest = 1e15;  // beyond it seconds do not fit a whole number
  const auto whole = static_cast<long>(std::lround(std::min(seconds, longest)));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace strake
