#include "coupler/console/console.hpp"

#include "proto/text.hpp"
#include "tests/coupler/stream.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace strake {
namespace console_test {

RunHeader plate_header() {
  RunHeader header;
  header.title = "flat-plate entry";
  header.folder = "runs/plate_entry";
  header.blocks = {
      {"fluid", {"MPS-LES 2-D, improved   10 000 water particles   l0 10 mm   Re 2.5e6   Fr 3.2"}},
      {"structure", {"fem (deal.II 9.4.1)     512 cells   f1 dry 699 Hz", "second line"}},
      {"coupling", {"surface, nearest-projection, IQN-ILS   window 0.01 ms   3 000 windows"}}};
  header.columns = {
      {"mid.x", "m"}, {"mid.y", "m"}, {"p_mid", "Pa"}, {"cfl", "1"}, {"pressure_iterations", "1"}};
  ProbeKeys mid, p_mid;
  mid.name = "mid";
  p_mid.name = "p_mid";
  header.probes = {mid, p_mid};
  return header;
}

CommittedWindow plate_window(long number, bool output) {
  CommittedWindow window;
  window.number = number;
  window.time = 1e-5 * static_cast<double>(number);
  window.output = output;
  window.report.iterations = 4;
  window.report.residual = 3.1e-5;
  window.report.converged = true;
  window.report.work.fluid = 1.0;
  window.report.work.structure = 1.0 + 0x1p-52;
  window.report.structure = {{"mid.y", 1.93e-4}, {"mid.x", 0.0}};
  window.report.fluid = {{"p_mid", 2.5e4}, {"cfl", 0.18}, {"pressure_iterations", 41}};
  return window;
}

Verdict plate_verdict() {
  Verdict verdict;
  verdict.probe = "mid.y";
  verdict.metric = "first_peak";
  verdict.value = 1.6e-3;
  verdict.reference = 1.625e-3;
  verdict.tolerance = 0.15;
  verdict.result = Verdict::Result::pass;
  verdict.kind = "theory";
  verdict.source = "beam in water";
  return verdict;
}

TEST(ConsoleTable, LooksInAPipeAsTheDesignShowsIt) {
  TextStream stream;
  auto reporter = table_reporter(stream.file(), Style{});
  reporter->start(plate_header());
  Summary summary("plate_entry", "");
  for (const long number : {1L, 420L}) {
    const CommittedWindow window = plate_window(number, true);
    summary.add(window);
    reporter->window(
        {.window = &window, .force = {0, 1.84e5, 0}, .elapsed = 0.3 * static_cast<double>(number)});
  }
  summary.wall_seconds = 760;
  reporter->end({.summary = &summary,
                 .folder = "runs/plate_entry",
                 .fields = {"fluid.xdmf", "structure.xdmf"},
                 .stopped = {}});
  EXPECT_EQ(stream.text(), golden("console_table.txt"));
}

/// Texts of a case and of participants that would clear the screen of a terminal.
TEST(Console, ShowsControlCharactersOfAnyTextAsText) {
  const std::string bad =
      "\x1b[2J\x07\xc2\x9b"
      "2J";
  RunHeader header = plate_header();
  header.title = header.folder = "t" + bad;
  header.blocks = {{"fluid", {"l" + bad, "m" + bad}}};
  header.warnings = {"w" + bad};
  header.columns.push_back({"c" + bad, "u" + bad});
  Verdict verdict = plate_verdict();
  verdict.source = "s" + bad;
  Summary summary("case", "tag");
  summary.verdicts = {verdict};
  for (const auto& make : {table_reporter, quiet_reporter}) {
    TextStream stream;
    auto reporter = make(stream.file(), Style{});
    reporter->start(header);
    reporter->note("n" + bad);
    reporter->warning("a" + bad);
    reporter->verdict(verdict);
    const CommittedWindow window = plate_window(1, true);
    reporter->window({.window = &window, .force = {0, 0, 0}, .elapsed = 0.1});
    reporter->end(
        {.summary = &summary, .folder = header.folder, .fields = {"fluid.xdmf"}, .stopped = "stopped"});
    const std::string text = stream.text();
    EXPECT_EQ(text.find_first_of("\x1b\x07\xc2"), std::string::npos) << text;
    EXPECT_NE(text.find("a\\x1b[2J\\x07\\x9b2J"), std::string::npos) << text;
  }
  TextStream stream;
  auto reporter = json_reporter(stream.file());
  reporter->start(header);
  reporter->warning("a" + bad);
  EXPECT_EQ(stream.text().find_first_of("\x1b\x07\xc2"), std::string::npos) << stream.text();
  EXPECT_NE(stream.text().find("a\\u001b[2J\\u0007\\u009b2J"), std::string::npos) << stream.text();
}

TEST(Console, GoesOnWhenNobodyReadsItsLines) {
  std::FILE* full = std::fopen("/dev/full", "w");
  ASSERT_NE(full, nullptr);
  for (const auto& make : {table_reporter, quiet_reporter}) {
    auto reporter = make(full, Style{});
    reporter->start(plate_header());
    EXPECT_NO_THROW(for (int k = 0; k < 1000; ++k) reporter->warning("a line that is not written"));
  }
  std::fclose(full);
}

TEST(ConsoleTable, PrintsInAPipeOneLinePerFieldFrameAndOneEveryTenSeconds) {
  TextStream stream;
  auto reporter = table_reporter(stream.file(), Style{});
  reporter->start(plate_header());
  const std::size_t before = stream.text().size();
  std::fseek(stream.file(), 0, SEEK_END);
  for (long number = 2; number <= 100; ++number) {  // 1 s each, a frame at the 50th
    const CommittedWindow window = plate_window(number, number == 50);
    reporter->window({.window = &window, .force = {0, 0, 0}, .elapsed = static_cast<double>(number)});
  }
  const std::string rows = stream.text().substr(before);
  // 2, 12, 22, 32, 42, 50 (the frame), 60, 70, 80, 90, 100
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 11) << rows;
}

/// A terminal that understands the control sequences of the bar; it returns the screen after a text.
std::string screen_after(const std::string& text) {
  std::vector<std::string> rows(1);
  std::size_t row = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '\n') {
      if (++row == rows.size()) rows.emplace_back();
    } else if (text[at] == '\033') {
      const std::size_t end = text.find_first_of("AJm", at);
      if (text[end] == 'A') row -= static_cast<std::size_t>(std::stoi(text.substr(at + 2)));
      if (text[end] == 'J') {
        rows.resize(row + 1);
        rows[row].clear();
      }
      at = end;
    } else if (text[at] != '\r') {
      rows[row] += text[at];
    }
  }
  std::string screen;
  for (const std::string& line : rows) screen += line + "\n";
  return screen;
}

Style terminal(int width) {
  return {.terminal = true, .colour = false, .width = width};
}

TEST(ConsoleTable, DrawsOnATerminalABarBelowTheLinesAndTakesItAwayAtTheEnd) {
  TextStream stream;
  RunHeader header = plate_header();
  header.end_time = 1e-3;
  auto reporter = table_reporter(stream.file(), terminal(80));
  reporter->start(header);
  Summary summary("plate_entry", "");
  const auto go = [&](long number) {
    CommittedWindow window = plate_window(number, number % 10 == 0);
    summary.add(window);
    reporter->window({.window = &window, .force = {0, 0, 0}, .elapsed = 0.25 * static_cast<double>(number)});
  };
  for (long number = 1; number <= 45; ++number) go(number);
  std::string screen = screen_after(stream.text());
  EXPECT_EQ(screen.find(" 45 % ["), screen.rfind(" % [") - 3) << screen;
  EXPECT_NE(screen.find("4 iterations"), std::string::npos) << screen;
  EXPECT_NE(screen.find("mid.y 0.193 mm"), std::string::npos) << screen;
  EXPECT_NE(screen.find("13.7 s left"), std::string::npos) << screen;  // 55 windows of 0.25 s
  EXPECT_LT(screen.find("\n     40 "), screen.find(" 45 % [")) << screen;
  std::fseek(stream.file(), 0, SEEK_END);
  reporter->warning("the water is cold");
  for (long number = 46; number <= 47; ++number) go(number);
  screen = screen_after(stream.text());
  EXPECT_LT(screen.find("the water is cold"), screen.find(" 47 % [")) << screen;
  std::fseek(stream.file(), 0, SEEK_END);
  reporter->end({.summary = &summary, .folder = "runs/plate_entry"});
  screen = screen_after(stream.text());
  EXPECT_EQ(screen.find(" % ["), std::string::npos) << screen;
  EXPECT_NE(screen.find("done  47 windows to t = 0.00047 s"), std::string::npos) << screen;
  EXPECT_NE(screen.find("the water is cold"), std::string::npos) << screen;
}

TEST(ConsoleTable, DrawsTheBarAtMostFiveTimesASecondAndLosesNoLine) {
  TextStream stream;
  RunHeader header = plate_header();
  header.end_time = 1e-2;
  auto reporter = table_reporter(stream.file(), terminal(80));
  reporter->start(header);
  Summary summary("plate_entry", "");
  for (long number = 1; number <= 1000; ++number) {  // in 2 s, a frame every 10 ms
    CommittedWindow window = plate_window(number, number % 5 == 0);
    summary.add(window);
    reporter->window({.window = &window, .force = {0, 0, 0}, .elapsed = 0.002 * static_cast<double>(number)});
  }
  reporter->end({.summary = &summary, .folder = "runs/plate_entry"});
  const std::string text = stream.text(), mark = " % [";
  int drawn = 0;
  for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1)) ++drawn;
  EXPECT_GE(drawn, 9);
  EXPECT_LE(drawn, 11);
  const std::string screen = screen_after(text);
  const auto lines = std::count(screen.begin(), screen.end(), '\n');
  EXPECT_GE(lines, 201 + 7) << "200 frames, the first window, the header";
  for (const long number : {1L, 5L, 500L, 1000L})
    EXPECT_NE(screen.find(fmt::format("\n{:>7}  0.0", number)), std::string::npos) << number;
}

TEST(ConsoleTable, SaysInTheBarForWhomItWaitsAndWhatThatOneDoes) {
  TextStream stream;
  RunHeader header = plate_header();
  header.end_time = 1e-3;
  auto reporter = table_reporter(stream.file(), terminal(100));
  reporter->start(header);
  Awaited whom = {.name = "structure",
                  .asked = "Advance",
                  .doing = "CalculiX computes all 300 windows to 0.003 s",
                  .part = 0.34,
                  .waited = 0.5};
  reporter->wait(whom, 0.5);
  EXPECT_EQ(stream.text().find("CalculiX"), std::string::npos) << "half a second is no wait";
  std::fseek(stream.file(), 0, SEEK_END);
  whom.waited = 25;
  reporter->wait(whom, 25);
  EXPECT_NE(screen_after(stream.text())
                .find("structure: CalculiX computes all 300 windows to 0.003 s (34 %), 25.0 s"),
            std::string::npos)
      << stream.text();
}

TEST(ConsoleTable, WritesNoEscapeSequenceWithoutColour) {
  TextStream stream;
  auto reporter = table_reporter(stream.file(), Style{});
  reporter->start(plate_header());
  CommittedWindow window = plate_window(1, true);
  window.report.converged = false;
  reporter->window({.window = &window, .force = {0, 0, 0}, .elapsed = 0});
  reporter->verdict(plate_verdict());
  EXPECT_EQ(stream.text().find('\033'), std::string::npos);
}

TEST(ConsoleTable, MarksAnUnconvergedWindowAndAFailureInColour) {
  TextStream stream;
  auto reporter = table_reporter(stream.file(), Style{.terminal = false, .colour = true});
  reporter->start(plate_header());
  CommittedWindow window = plate_window(1, true);
  window.report.converged = false;
  reporter->window({.window = &window, .force = {0, 0, 0}, .elapsed = 0});
  Verdict verdict = plate_verdict();
  verdict.result = Verdict::Result::fail;
  reporter->verdict(verdict);
  EXPECT_NE(stream.text().find("\033[33m"), std::string::npos);
  EXPECT_NE(stream.text().find("\033[31m"), std::string::npos);
}

TEST(ConsoleTable, OfOneParticipantHasNoCouplingColumns) {
  TextStream stream;
  auto reporter = table_reporter(stream.file(), Style{});
  RunHeader header = plate_header();
  header.coupled = false;
  header.probes.clear();
  header.columns = {{"floor.y", "N/m"}, {"cfl", "1"}};
  reporter->start(header);
  EXPECT_EQ(stream.text().find("residual"), std::string::npos);
  EXPECT_NE(stream.text().find("floor.y [N/m]"), std::string::npos);
}

TEST(ConsoleTable, OfARunWithoutForceHasNoColumnsOfIt) {
  TextStream stream;
  auto reporter = table_reporter(stream.file(), Style{});
  RunHeader header = plate_header();
  header.mechanical = false;
  reporter->start(header);
  EXPECT_NE(stream.text().find("residual"), std::string::npos);
  EXPECT_EQ(stream.text().find("force y"), std::string::npos);
  EXPECT_EQ(stream.text().find("work gap"), std::string::npos);
}

TEST(ConsoleTable, LeavesOutAPartThatHasNothingToSay) {
  TextStream stream;
  auto reporter = table_reporter(stream.file(), Style{});
  RunHeader header = plate_header();
  header.blocks = {{"fluid", {}}, {"structure", {"spring   m 200 kg/m"}}};
  reporter->start(header);
  EXPECT_EQ(stream.text().find("  fluid"), std::string::npos);
  EXPECT_NE(stream.text().find("  structure  spring   m 200 kg/m\n"), std::string::npos) << stream.text();
}

TEST(ConsoleTable, KeepsALongTitleOffTheFolder) {
  for (const std::size_t length : {10, 43, 55}) {
    TextStream stream;
    auto reporter = table_reporter(stream.file(), Style{});
    RunHeader header = plate_header();
    header.title = std::string(length, 'x');
    header.folder = "runs/tube";
    reporter->start(header);
    EXPECT_NE(stream.text().find("x  "), std::string::npos);
    EXPECT_NE(stream.text().find("  runs/tube\n"), std::string::npos) << stream.text();
  }
}

TEST(JsonLines, AreOneObjectEachWithItsKindAndHoldTheRowsOfFieldFrames) {
  TextStream stream;
  auto reporter = json_reporter(stream.file());
  RunHeader header = plate_header();
  header.warnings = {"thin ice"};
  header.history = {{"window", "1"}, {"mid.y", "m"}, {"p_mid", "Pa"}};
  reporter->start(header);
  Summary summary("plate_entry", "");
  Table history{.columns = header.history, .value = {{}, {}, {}}};
  for (long number = 7; number <= 9; ++number) {  // a frame at the 8th
    const CommittedWindow window = plate_window(number, number == 8);
    summary.add(window);
    history.value[0].push_back(static_cast<double>(number));
    history.value[1].push_back(0.1 * static_cast<double>(number));
    history.value[2].push_back(std::nan(""));
    reporter->window({.window = &window, .force = {1, 2, 3}, .elapsed = 0.5, .history = &history});
  }
  reporter->verdict(plate_verdict());
  reporter->error(Error(ExitCode::solver_fault, "fluid", "is gone", "drink less"));
  summary.exit_code = ExitCode::solver_fault;
  reporter->end({.summary = &summary, .folder = "runs/plate_entry", .stopped = "stopped"});

  std::istringstream lines(stream.text());
  std::vector<nlohmann::json> said;
  for (std::string line; std::getline(lines, line);) said.push_back(nlohmann::json::parse(line));
  std::vector<std::string> kinds;
  for (const auto& json : said) kinds.push_back(json["kind"]);
  ASSERT_EQ(kinds, (std::vector<std::string>{"start", "warning", "window", "verdict", "error", "end"}));
  EXPECT_EQ(said[0]["columns"][1]["unit"], "m");
  EXPECT_EQ(said[1]["text"], "thin ice");
  EXPECT_EQ(said[2]["window"], 8);
  EXPECT_EQ(said[2]["values"]["mid.y"], 0.1 * 8);
  EXPECT_TRUE(said[2]["values"]["p_mid"].is_null());
  EXPECT_EQ(said[3]["verdict"]["metric"], "first_peak");
  EXPECT_EQ(said[4]["fix"], "drink less");
  EXPECT_EQ(said[5]["exit_code"], 4);
  EXPECT_EQ(said[5]["summary"]["windows"], 3);
}

TEST(QuietRun, PrintsWarningsAndVerdictsAlone) {
  TextStream stream;
  auto reporter = quiet_reporter(stream.file(), Style{});
  RunHeader header = plate_header();
  header.warnings = {"thin ice"};
  reporter->start(header);
  Summary summary("plate_entry", "");
  CommittedWindow window = plate_window(1, true);
  window.report.converged = false;
  summary.add(window);
  reporter->window({.window = &window, .force = {1, 2, 3}, .elapsed = 0.5});
  reporter->note("a crack opens");
  summary.verdicts = {plate_verdict()};
  reporter->end({.summary = &summary, .folder = "runs/plate_entry"});
  EXPECT_EQ(stream.text(), "warning  thin ice\nwarning  1 of 1 windows accepted unconverged\n" +
                               plate_verdict().line() + "\n");
}

TEST(Numbers, AreGroupedInThreesAndDurationsReadAsAPersonSaysThem) {
  EXPECT_EQ(grouped(5), "5");
  EXPECT_EQ(grouped(3000), "3 000");
  EXPECT_EQ(grouped(-1234567), "-1 234 567");
  EXPECT_EQ(duration_text(0.31), "0.3 s");
  EXPECT_EQ(duration_text(760), "12 min 40 s");
  EXPECT_EQ(duration_text(7260), "2 h 01 min");
}

}  // namespace console_test
}  // namespace strake
