#include "coupler/console.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "coupler/profile.hpp"

namespace strake {

namespace {

constexpr double pipe_interval = 10;       // [s] longest silence in a pipe
constexpr double terminal_interval = 0.1;  // [s] between renewals of the last line
constexpr std::size_t most_columns = 4;    // of the participants, beside CFL and iterations

/// One column of the table.
struct TableColumn {
  std::string title;
  int width = 0;
  std::function<std::string(const RunRow&)> text;
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
  for (const auto* monitor : {&row.window->report.fluid, &row.window->report.structure}) {
    const auto found = monitor->find(name);
    if (found != monitor->end()) return found->second;
  }
  return std::nan("");
}

/// Small SI values read better with a prefix: metres as millimetres, pascals as kilopascals.
TableColumn participant_column(const Column& column) {
  double factor = 1;
  std::string unit = column.unit;
  if (unit == "m") {
    unit = "mm";
    factor = 1e3;
  } else if (unit == "Pa") {
    unit = "kPa";
    factor = 1e-3;
  }
  const std::string title =
      unit.empty() || unit == "1" ? column.name : fmt::format("{} [{}]", column.name, unit);
  return {title, std::max(10, static_cast<int>(title.size())),
          [name = column.name, factor](const RunRow& row) { return digits(factor * monitor_of(row, name)); }};
}

/// What a specialist asks first of a run; what is not known is left out.
std::string checks_text(const Summary& summary) {
  const nlohmann::ordered_json json = summary.json(), &checks = json["checks"];
  std::string text;
  const auto add = [&](const char* key, auto&& words) {
    if (checks[key].is_number()) text += "  " + words(checks[key].get<double>());
  };
  add("work_gap", [](double x) { return fmt::format("work gap {:.1e}", x); });
  add("momentum_gap", [](double x) { return fmt::format("momentum gap {:.1e}", x); });
  add("structure_energy_drift", [](double x) { return fmt::format("energy drift {:.1e}", x); });
  add("volume_drift", [](double x) { return fmt::format("volume {:+.2f} %", 100 * x); });
  add("inner_fraction_min",
      [](double x) { return fmt::format("inner particles at least {:.1f} %", 100 * x); });
  for (const char* count : {"voids", "openings", "penetrations", "lost"})
    add(count, [count](double x) { return fmt::format("{} {:.0f}", count, x); });
  return text;
}

/// The columns worth a place: the y component of each probe (the whole of a scalar), then what else there is.
std::vector<Column> chosen(const RunHeader& header) {
  std::vector<Column> columns;
  const auto add = [&](const Column& column) {
    const auto same = [&](const Column& other) { return other.name == column.name; };
    if (columns.size() < most_columns && std::none_of(columns.begin(), columns.end(), same))
      columns.push_back(column);
  };
  for (const char* frequency : {"f1", "f2", "f3"})  // of a modal analysis, which has no motion to show
    for (const Column& column : header.columns)
      if (column.name == frequency) add(column);
  if (!columns.empty()) return columns;
  for (const ProbeKeys& probe : header.probes)
    for (const Column& column : header.columns)
      if (column.name == probe.name || column.name == probe.name + ".y") add(column);
  const auto of_probe = [&](const Column& column) {
    return std::any_of(header.probes.begin(), header.probes.end(),
                       [&](const ProbeKeys& probe) { return column.name.starts_with(probe.name + "."); });
  };
  if (!header.coupled)
    for (const Column& column : header.columns)
      if (column.name != "cfl" && column.name != "pressure_iterations" && !of_probe(column)) add(column);
  return columns;
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
    table.push_back({"residual", 8,
                     [](const RunRow& row) { return fmt::format("{:.1e}", row.window->report.residual); }});
    table.push_back({header.dimension == 2 ? "force y [N/m]" : "force y [N]", 13,
                     [](const RunRow& row) { return fmt::format("{:.2e}", row.force.y()); }});
  }
  for (const Column& column : chosen(header)) table.push_back(participant_column(column));
  if (has(header, "cfl"))
    table.push_back({"CFL", 5, [](const RunRow& row) { return fixed(monitor_of(row, "cfl"), 2); }});
  if (has(header, "pressure_iterations"))
    table.push_back(
        {"p-it", 4, [](const RunRow& row) { return fixed(monitor_of(row, "pressure_iterations"), 0); }});
  if (header.coupled)
    table.push_back({"work gap", 8,
                     [](const RunRow& row) { return fmt::format("{:.1e}", row.window->report.work_gap()); }});
  table.push_back({"wall", 8, [](const RunRow& row) { return duration_text(row.elapsed); }});
  return table;
}

class TableReporter final : public Reporter {
 public:
  TableReporter(std::FILE* stream, const Style& style) : stream_(stream), style_(style) {}
  ~TableReporter() override { keep_line(); }

  void start(const RunHeader& header) override {
    const std::string title = header.title.empty() ? header.folder.filename().string() : header.title;
    put(fmt::format("{:<44}{}\n", title, header.folder.string()));
    for (const auto& [name, lines] : header.blocks) put(block_text(name, lines));
    for (const std::string& warning : header.warnings)
      put("  " + paint("33", "warning") + "    " + warning + "\n");
    columns_ = table_of(header);
    std::string titles;
    for (const TableColumn& column : columns_) titles += fmt::format(" {:>{}} ", column.title, column.width);
    while (titles.ends_with(' ')) titles.pop_back();
    put("\n" + titles + "\n");
    std::fflush(stream_);
  }

  void window(const RunRow& row) override {
    const bool keep = row.window->output || row.window->last || row.window->number == 1;
    const double interval = style_.terminal ? terminal_interval : pipe_interval;
    const bool due = row.elapsed >= last_shown_ + interval;
    if (!keep && !due) return;
    last_shown_ = row.elapsed;
    std::string line;
    for (const TableColumn& column : columns_)
      line += fmt::format(" {:>{}} ", column.text(row), column.width);
    while (line.ends_with(' ')) line.pop_back();
    if (style_.terminal && style_.width > 1)
      line = line.substr(0, static_cast<std::size_t>(style_.width) - 1);
    if (!row.window->report.converged) line = paint("33", line);
    if (style_.terminal) {
      std::fputs(("\r" + line + "\033[K").c_str(), stream_);
      open_line_ = true;
      if (keep) keep_line();
    } else {
      put(line + "\n");
    }
    std::fflush(stream_);
  }

  void verdict(const Verdict& verdict) override { put(verdict_text(verdict, style_) + "\n"); }
  void note(const std::string& line) override { put("  " + line + "\n"); }

  void end(const RunEnd& end) override {
    const Summary& summary = *end.summary;
    std::string line = fmt::format("\n{}  {} window{}", end.stopped.empty() ? "done" : end.stopped,
                                   grouped(summary.windows()), summary.windows() == 1 ? "" : "s");
    if (summary.coupled()) line += fmt::format(", mean {:.1f} iterations", summary.mean_iterations());
    put(line + ", " + duration_text(summary.wall_seconds) + "\n");
    if (summary.unconverged() > 0)
      put("  " +
          paint("33", fmt::format("{} window{} accepted unconverged", grouped(summary.unconverged()),
                                  summary.unconverged() == 1 ? "" : "s")) +
          "\n");
    if (summary.taken_back() > 0)
      put("  " +
          paint("33", fmt::format("{} window{} taken back for shorter ones", grouped(summary.taken_back()),
                                  summary.taken_back() == 1 ? "" : "s")) +
          "\n");
    for (const Verdict& verdict : summary.verdicts) put("  " + verdict_text(verdict, style_) + "\n");
    if (const std::string checks = checks_text(summary); !checks.empty()) put("  checks" + checks + "\n");
    if (end.profile != nullptr)
      for (const std::string& text : end.profile->lines()) put("  " + text + "\n");
    put(fmt::format("  curves  {}\n", (end.folder / "history.csv").string()));
    if (!end.fields.empty()) {
      std::string fields = (end.folder / end.fields.front()).string();
      for (std::size_t i = 1; i < end.fields.size(); ++i) fields += "  " + end.fields[i];
      put(fmt::format("  fields  {}   (open in ParaView)\n", fields));
    }
    if (end.stopped == "interrupted")
      put("  next    the same command with --resume\n");
    else
      put(fmt::format("  next    strake compare {}\n", end.folder.string()));
  }

 private:
  void keep_line() {
    if (open_line_) std::fputs("\n", stream_);
    open_line_ = false;
  }
  void put(const std::string& text) {
    keep_line();
    std::fputs(text.c_str(), stream_);
    std::fflush(stream_);
  }
  std::string paint(const char* code, const std::string& text) const {
    return style_.colour ? fmt::format("\033[{}m{}\033[0m", code, text) : text;
  }

  std::FILE* stream_;
  Style style_;
  std::vector<TableColumn> columns_;
  double last_shown_ = -1e9;  // [s]
  bool open_line_ = false;    // the last line may still be renewed
};

class JsonReporter final : public Reporter {
 public:
  explicit JsonReporter(std::FILE* stream) : stream_(stream) {}
  void start(const RunHeader& header) override {
    nlohmann::ordered_json blocks;
    for (const auto& [name, lines] : header.blocks) blocks[name] = lines;
    put({{"event", "start"},
         {"title", header.title},
         {"folder", header.folder.string()},
         {"understood", blocks},
         {"warnings", header.warnings}});
  }
  void window(const RunRow& row) override {
    const WindowReport& report = row.window->report;
    nlohmann::ordered_json line = {{"event", "window"},
                                   {"window", row.window->number},
                                   {"time", row.window->time},
                                   {"iterations", report.iterations},
                                   {"residual", report.residual},
                                   {"converged", report.converged},
                                   {"force", {row.force.x(), row.force.y(), row.force.z()}},
                                   {"work_gap", report.work_gap()},
                                   {"elapsed", row.elapsed}};
    for (const auto& [name, value] : report.monitor()) line["monitor"][name] = value;
    put(line);
  }
  void verdict(const Verdict& verdict) override { put({{"event", "verdict"}, {"line", verdict.line()}}); }
  void note(const std::string& line) override { put({{"event", "note"}, {"line", line}}); }
  void end(const RunEnd& end) override {
    if (end.profile != nullptr) put({{"event", "profile"}, {"seconds", end.profile->json()}});
    put({{"event", "end"}, {"folder", end.folder.string()}, {"summary", end.summary->json()}});
  }

 private:
  void put(const nlohmann::ordered_json& line) {
    std::fputs((line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n").c_str(),
               stream_);
    std::fflush(stream_);
  }
  std::FILE* stream_;
};

class QuietReporter final : public Reporter {
 public:
  QuietReporter(std::FILE* stream, const Style& style) : stream_(stream), style_(style) {}
  void start(const RunHeader&) override {}
  void window(const RunRow&) override {}
  void verdict(const Verdict&) override {}
  void note(const std::string&) override {}
  void end(const RunEnd& end) override {
    for (const Verdict& verdict : end.summary->verdicts)
      if (verdict.result == Verdict::Result::fail) fmt::print(stream_, "{}\n", verdict_text(verdict, style_));
    if (end.profile != nullptr)
      for (const std::string& text : end.profile->lines()) fmt::print(stream_, "{}\n", text);
    std::fflush(stream_);
  }

 private:
  std::FILE* stream_;
  Style style_;
};

}  // namespace

Style style_of(std::FILE* stream) {
  Style style;
  style.terminal = ::isatty(::fileno(stream)) != 0;
  const char* no_colour = std::getenv("NO_COLOR");
  style.colour = style.terminal && (no_colour == nullptr || *no_colour == '\0');
  winsize size{};
  if (style.terminal && ::ioctl(::fileno(stream), TIOCGWINSZ, &size) == 0) style.width = size.ws_col;
  return style;
}

std::unique_ptr<Reporter> table_reporter(std::FILE* stream, const Style& style) {
  return std::make_unique<TableReporter>(stream, style);
}
std::unique_ptr<Reporter> json_reporter(std::FILE* stream) {
  return std::make_unique<JsonReporter>(stream);
}
std::unique_ptr<Reporter> quiet_reporter(std::FILE* stream, const Style& style) {
  return std::make_unique<QuietReporter>(stream, style);
}

std::string block_text(const std::string& name, const std::vector<std::string>& lines) {
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i)
    text += fmt::format("  {:<11}{}\n", i == 0 ? name : "", lines[i]);
  return text;
}

std::string verdict_text(const Verdict& verdict, const Style& style) {
  std::string line = verdict.line();
  if (!style.colour || verdict.result == Verdict::Result::not_reached) return line;
  const auto end = line.find(' ');
  const char* code = verdict.result == Verdict::Result::pass ? "32" : "31";
  return fmt::format("\033[{}m{}\033[0m{}", code, line.substr(0, end), line.substr(end));
}

std::string grouped(long long number) {
  std::string digits = std::to_string(number < 0 ? -number : number);
  for (auto place = static_cast<std::ptrdiff_t>(digits.size()) - 3; place > 0; place -= 3)
    digits.insert(static_cast<std::size_t>(place), " ");
  return (number < 0 ? "-" : "") + digits;
}

std::string duration_text(double seconds) {
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<long>(std::lround(seconds));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace strake
