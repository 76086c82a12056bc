#include "coupler/commands/compare_plots.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace compare_plots_test {

TEST(ComparePlots, TheTitleNamesQuantityAndProbeOnce) {
  Table history;
  history.columns = {{"time", "s"}, {"front", "m"}, {"mid.y", "m"}};
  history.value = {{0, 1}, {0.1, 0.2}, {0, -1e-3}};
  const RunData data{.monitor = {}, .history = &history, .time = 1, .finished = true};
  const std::vector<ProbeKeys> probes = {
      {.name = "front", .of = "fluid", .at = {}, .quantity = "front"},
      {.name = "mid", .of = "structure", .at = {}, .quantity = "deflection"}};
  const auto plots = run_plots({}, data, "run", probes, {"front", "mid.y"});
  ASSERT_EQ(plots.size(), 2U);
  EXPECT_EQ(plots[0].title, "front");
  EXPECT_EQ(plots[1].title, "deflection mid.y");
}

}  // namespace compare_plots_test
}  // namespace strake
