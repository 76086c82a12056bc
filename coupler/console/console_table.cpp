#include "coupler/console/console.hpp"
#include "coupler/console/progress_bar.hpp"
#include "proto/lookup.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

// The table that a person reads, and the bar below it.

namespace strake {

namespace {

constexpr double pipe_interval = 10;       // [s] longest silence in a pipe
constexpr double terminal_interval = 0.2;  // [s] between two drawings of the bar
constexpr double wait_told_after = 1;      // [s] until the bar says for whom a run waits
constexpr std::size_t columns_of_table = 4, columns_of_bar = 12;  // of the participants, at most

/// One column of the table.
struct TableColumn {
  std::string title;
  int width = 0;
  std::function<std::string(const RunRow&)> text;
  int needed = 2;  // on a terminal too narrow for all: 0 goes first, 2 last
};

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  if (std::abs(value) >= 1e5) return fmt::format("{:.2e}", value);
  return fmt::format("{:.{}f}", value, decimals);
}

// Four significant digits: a deflection of micrometres is not 0.000.
std::string digits(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "-";
}

double monitor_of(const RunRow& row, const std::string& name) {
  const WindowReport& report = row.window->report;
  return at_or(report.fluid, name,
               at_or(report.structure, name, at_or(report.attachments, name, std::nan(""))));
}

/// Small SI values read better with a prefix: metres as millimetres, pascals as kilopascals.
std::pair<double, std::string> shown_unit(const std::string& unit) {
  if (unit == "m") return {1e3, "mm"};
  if (unit == "Pa") return {1e-3, "kPa"};
  return {1, unit == "1" ? "" : unit};
}

TableColumn participant_column(const Column& column) {
  const auto [factor, unit] = shown_unit(column.unit);
  const std::string title =
      visible(unit.empty() ? column.name : fmt::format("{} [{}]", column.name, unit), "");
  return {title, std::max(10, static_cast<int>(title.size())),
          [name = column.name, scale = factor](const RunRow& row) {
            return digits(scale * monitor_of(row, name));
          }};
}

bool has(const RunHeader& header, const std::string& name) {
  return std::any_of(header.columns.begin(), header.columns.end(),
                     [&](const Column& column) { return column.name == name; });
}

std::vector<TableColumn> table_of(const RunHeader& header) {
  std::vector<TableColumn> table;
  table.push_back({"window", 6, [](const RunRow& row) { return std::to_string(row.window->number); }});
  table.push_back({"t [s]", 8, [](const RunRow& row) { return fmt::format("{:.6f}", row.window->time); }});
  if (header.coupled) {
    table.push_back(
        {"it", 2, [](const RunRow& row) { return std::to_string(row.window->report.iterations); }});
    table.push_back({header.mechanical ? "residual [m]" : "residual", header.mechanical ? 12 : 8,
                     [](const RunRow& row) { return fmt::format("{:.1e}", row.window->report.residual); }});
  }
  const bool mechanical = header.coupled && header.mechanical;
  if (mechanical)
    table.push_back({header.dimension == 2 ? "force y [N/m]" : "force y [N]", 13,
                     [](const RunRow& row) { return fmt::format("{:.2e}", row.force.y()); }});
  for (const Column& column : telling_columns(header, columns_of_table))
    table.push_back(participant_column(column));
  if (has(header, "cfl"))
    table.push_back({"CFL", 5, [](const RunRow& row) { return fixed(monitor_of(row, "cfl"), 2); }, 0});
  if (has(header, "pressure_iterations"))
    table.push_back(
        {"p-it", 4, [](const RunRow& row) { return fixed(monitor_of(row, "pressure_iterations"), 0); }, 0});
  if (mechanical)
    table.push_back({"work gap", 8,
                     [](const RunRow& row) { return fmt::format("{:.1e}", row.window->report.work.gap()); },
                     0});
  table.push_back({"wall", 8, [](const RunRow& row) { return duration_text(row.elapsed); }, 1});
  return table;
}

/// Removes columns until a line of the table has at most so many characters. The least needed go first, of
/// these the last.
void fit(std::vector<TableColumn>& table, int room) {
  const auto taken = [&] {
    int width = 0;
    for (const TableColumn& column : table) width += column.width + 2;
    return width - 1;
  };
  for (int needed = 0; needed <= 2; ++needed)
    for (std::size_t k = table.size(); k-- > 2 && taken() > room;)  // window and time stay
      if (table[k].needed == needed) table.erase(table.begin() + static_cast<std::ptrdiff_t>(k));
}

/// "structure: CalculiX computes all 300 windows to 0.003 s (34 %), 25.3 s".
std::string waiting_text(const Awaited& whom) {
  std::string text = whom.name + ": ";
  if (whom.doing.empty())
    text += whom.asked.empty() ? "starting" : "computing (" + whom.asked + ")";
  else
    text += fmt::format("{} ({:.0f} %)", whom.doing, 100 * whom.part);
  return visible(text, "") + ", " + duration_text(whom.waited);
}

class TableReporter final : public Reporter {
 public:
  TableReporter(std::FILE* stream, const Style& style) : stream_(stream), style_(style), bar_(stream) {}
  ~TableReporter() override { take_bar_away(); }

  void start(const RunHeader& header) override {
    take_bar_away();
    header_ = header;
    const std::string title = header.title.empty() ? header.folder.filename().string() : header.title;
    put(visible(fmt::format("{:<42}  {}", title, header.folder.string())));
    for (const auto& [name, lines] : header.blocks) {
      std::string text = block_text(name, lines);
      if (text.empty()) continue;  // a participant that says nothing of itself
      text.pop_back();
      put(text);
    }
    for (const std::string& line : header.warnings) warning(line);
    columns_ = table_of(header);
    if (style_.terminal) fit(columns_, width_of(stream_, style_) - 1);
    for (const Column& column : telling_columns(header, columns_of_bar)) shown_.push_back(column);
    std::string titles;
    for (const TableColumn& column : columns_) titles += fmt::format(" {:>{}} ", column.title, column.width);
    while (titles.ends_with(' ')) titles.pop_back();
    put("\n" + titles);
    progress_.time = header.from.time;
    progress_.end_time = header.end_time;
    started_ = true;
  }

  void window(const RunRow& row) override {
    const CommittedWindow& window = *row.window;
    const bool keep = window.output || window.last || window.number == 1;
    if (keep || (!style_.terminal && row.elapsed >= last_line_ + pipe_interval)) {
      last_line_ = row.elapsed;
      put(line_of(row));
    }
    if (!style_.terminal) return;
    progress_.time = window.time;
    progress_.iterations = header_.coupled ? window.report.iterations : 0;
    progress_.waiting.clear();
    if (row.elapsed < last_drawn_ + terminal_interval) return;
    double steps = monitor_of(row, "count.steps");  // the fluid's where there is one
    pace_.add(row.elapsed, window.time, steps);
    progress_.remaining = pace_.remaining(progress_.end_time);
    progress_.steps_per_second = pace_.steps_per_second();
    progress_.probes.clear();
    for (const Column& column : shown_) {
      const auto [factor, unit] = shown_unit(column.unit);
      progress_.probes.push_back(
          visible(fmt::format("{} {}{}", column.name, digits(factor * monitor_of(row, column.name)),
                              unit.empty() ? "" : " " + unit)));
    }
    draw(row.elapsed);
  }

  void wait(const Awaited& whom, double elapsed) override {
    if (!style_.terminal || elapsed < last_drawn_ + terminal_interval) return;
    if (whom.waited >= wait_told_after) progress_.waiting = waiting_text(whom);
    if (pending_.empty() && progress_.waiting.empty()) return;
    draw(elapsed);
  }

  void verdict(const Verdict& verdict) override { put(verdict_text(verdict, style_)); }
  void note(const std::string& line) override { put("  " + visible(line)); }
  void alarm(const std::string& line) override {
    put("  " + painted(style_, "31", "alarm") + "      " + visible(line));
  }
  void warning(const std::string& line) override {
    put("  " + painted(style_, "33", "warning") + "    " + visible(line));
  }

  void end(const RunEnd& end) override {
    take_bar_away();
    for (const std::string& line : closing_lines(end, header_, style_)) put(line);
  }

 private:
  std::string line_of(const RunRow& row) const {
    std::string line;
    for (const TableColumn& column : columns_)
      line += fmt::format(" {:>{}} ", column.text(row), column.width);
    while (line.ends_with(' ')) line.pop_back();
    if (style_.terminal) line = cut_to_width(line, width_of(stream_, style_) - 1);
    return row.window->report.converged ? line : painted(style_, "33", line);
  }
  /// Delays lines of a run under way until the bar is drawn again, which is soon. So the bar neither flickers
  /// nor stands between the lines.
  void put(const std::string& line) {
    if (!bar_.empty()) {
      pending_ += line + "\n";
      return;
    }
    strake::put(stream_, line + "\n");
  }
  void draw(double elapsed) {
    last_drawn_ = elapsed;
    const int width = width_of(stream_, style_);
    std::vector<std::string> rows;
    if (started_)
      rows = progress_rows(progress_, width, style_.unicode);
    else
      rows = {cut_to_width("  " + progress_.waiting, width - 1)};
    bar_.show(pending_, rows, width);
    pending_.clear();
  }
  void take_bar_away() {
    bar_.show(pending_, {}, width_of(stream_, style_));
    pending_.clear();
  }

  std::FILE* stream_;
  Style style_;
  RunHeader header_;
  std::vector<TableColumn> columns_;
  std::vector<Column> shown_;  // in the bar
  LiveRows bar_;
  RecentSpeed pace_;
  Progress progress_;
  std::string pending_;                          // lines to stand above the bar
  double last_line_ = -1e9, last_drawn_ = -1e9;  // [s] elapsed
  bool started_ = false;
};

}  // namespace

std::unique_ptr<Reporter> table_reporter(std::FILE* stream, const Style& style) {
  return std::make_unique<TableReporter>(stream, style);
}

}  // namespace strake
