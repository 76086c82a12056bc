#include "coupler/console.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "stream.hpp"

namespace strake {
namespace {

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
  window.report.work_fluid = 1.0;
  window.report.work_structure = 1.0 + 0x1p-52;
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

TEST(ConsoleTable, RenewsTheLastLineInPlaceOnATerminalAndKeepsItWithAFrame) {
  TextStream stream;
  auto reporter = table_reporter(stream.file(), Style{.terminal = true, .colour = false, .width = 0});
  reporter->start(plate_header());
  const std::size_t before = stream.text().size();
  std::fseek(stream.file(), 0, SEEK_END);
  for (long number = 2; number <= 5; ++number) {
    const CommittedWindow window = plate_window(number, number == 5);
    reporter->window({.window = &window, .force = {0, 0, 0}, .elapsed = static_cast<double>(number)});
  }
  const std::string rows = stream.text().substr(before);
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\r'), 4);
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 1);
  EXPECT_TRUE(rows.ends_with('\n'));
}

TEST(ConsoleTable, WritesNoEscapeSequenceWithoutColour) {
  TextStream stream;
  auto reporter = table_reporter(stream.file(), Style{.terminal = false, .colour = false, .width = 0});
  reporter->start(plate_header());
  CommittedWindow window = plate_window(1, true);
  window.report.converged = false;
  reporter->window({.window = &window, .force = {0, 0, 0}, .elapsed = 0});
  reporter->verdict(plate_verdict());
  EXPECT_EQ(stream.text().find('\033'), std::string::npos);
}

TEST(ConsoleTable, MarksAnUnconvergedWindowAndAFailureInColour) {
  TextStream stream;
  auto reporter = table_reporter(stream.file(), Style{.terminal = false, .colour = true, .width = 0});
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

TEST(JsonLines, AreOneObjectEachAndHoldTheWindow) {
  TextStream stream;
  auto reporter = json_reporter(stream.file());
  reporter->start(plate_header());
  const CommittedWindow window = plate_window(7, false);
  reporter->window({.window = &window, .force = {1, 2, 3}, .elapsed = 0.5});
  std::istringstream lines(stream.text());
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(nlohmann::json::parse(line)["event"], "start");
  std::getline(lines, line);
  const auto json = nlohmann::json::parse(line);
  EXPECT_EQ(json["window"], 7);
  EXPECT_EQ(json["monitor"]["mid.y"], 1.93e-4);
}

TEST(Numbers, AreGroupedInThreesAndDurationsReadAsAPersonSaysThem) {
  EXPECT_EQ(grouped(5), "5");
  EXPECT_EQ(grouped(3000), "3 000");
  EXPECT_EQ(grouped(-1234567), "-1 234 567");
  EXPECT_EQ(duration_text(0.31), "0.3 s");
  EXPECT_EQ(duration_text(760), "12 min 40 s");
  EXPECT_EQ(duration_text(7260), "2 h 01 min");
}

}  // namespace
}  // namespace strake
