#include "proto/case/size_limit.hpp"

#include "proto/case/case_file.hpp"
#include "tests/proto/refusal.hpp"

namespace strake {
namespace size_limit_test {

CaseFile tank(const std::string& spacing, const std::vector<std::string>& sets = {}) {
  CaseFile file = CaseFile::parse("[fluid]\nspacing = " + spacing + "\n", "case.toml", sets);
  double value = 0;
  file.root().table("fluid").number("spacing", value, {.unit = "m"});
  return file;
}

/// Water of a square metre.
SizeEstimates water(double spacing) {
  return {{.what = "water particles",
           .count = 1 / (spacing * spacing),
           .bytes_each = 1000,
           .seconds_each = 1e-6,
           .keys = {{"fluid.spacing", spacing, -2}}}};
}

TEST(SizeLimit, ACaseThatFitsPasses) {
  EXPECT_NO_THROW(refuse_oversized(tank("0.01"), water(0.01), 1e9));
  EXPECT_EQ(size_text(water(0.01)), "about 10 000 water particles: 10 MB");
  EXPECT_FALSE(is_large(water(0.01)));
}

TEST(SizeLimit, MoreMemoryThanThereIsIsRefusedWithAValueThatFits) {
  // 1e6 particles of 1000 bytes fit into 1 GB: 1e-3, rounded up to two digits.
  const std::string text =
      text_of_error([] { refuse_oversized(tank("1e-4"), water(1e-4), 1e9); }, ExitCode::case_file);
  EXPECT_NE(text.find("case.toml:2:11: fluid.spacing = 1e-4"), std::string::npos) << text;
  EXPECT_NE(text.find("expected a case of at most 1 GB: 100 000 000 water particles"), std::string::npos)
      << text;
  EXPECT_NE(text.find("about 1e+02 GB"), std::string::npos) << text;
  EXPECT_NE(text.find("fix: fluid.spacing = 0.001 or more"), std::string::npos) << text;
  EXPECT_NO_THROW(refuse_oversized(tank("1e-3"), water(1.001e-3), 1e9));
}

TEST(SizeLimit, MoreThanAnIndexCanCountIsRefusedWhateverTheMemory) {
  const std::string text =
      text_of_error([] { refuse_oversized(tank("1e-9"), water(1e-9), 1e30); }, ExitCode::case_file);
  EXPECT_NE(text.find("at most 2.1e+09 water particles, these would be 1e+18"), std::string::npos) << text;
  EXPECT_NE(text.find("fluid.spacing = 2.2e-05 or more"), std::string::npos) << text;
}

TEST(SizeLimit, ACountThatIsNoNumberIsRefused) {
  expect_refused([] { refuse_oversized(tank("0.01"), water(0), 1e9); }, "fluid.spacing");
  expect_refused([] { refuse_oversized(tank("0.01"), water(std::nan("")), 1e9); }, "fluid.spacing");
}

TEST(SizeLimit, TheKeyThatSetGaveIsTheOneShown) {
  SizeEstimates cells = water(1e-4);
  cells[0].keys.insert(cells[0].keys.begin(), {"fluid.length", 3, 1});
  const std::string text = text_of_error(
      [&] { refuse_oversized(tank("0.01", {"fluid.spacing=1e-4"}), cells, 1e9); }, ExitCode::case_file);
  EXPECT_TRUE(text.starts_with("--set fluid.spacing=1e-4: expected")) << text;
  EXPECT_NE(text.find("fix: fluid.length = 0.03 or less\n       or fluid.spacing = 0.001 or more"),
            std::string::npos)
      << text;
}

TEST(SizeLimit, ALegalCaseIsLargeByItsMemoryOrItsTime) {
  EXPECT_TRUE(is_large(water(0.9e-3)));  // 1.2 GB
  SizeEstimates slow = water(0.01);
  slow[0].seconds_each = 1e-3;
  EXPECT_TRUE(is_large(slow));
}

TEST(SizeLimit, TheRemedyIsThatOfWhatTakesMostMemory) {
  EXPECT_EQ(remedy_of({}), "");
  EXPECT_EQ(remedy_of(water(0.01)), "");
  SizeEstimates two = water(0.01);
  two.push_back({.what = "unknowns", .count = 100, .bytes_each = 10, .remedy = "few"});
  EXPECT_EQ(remedy_of(two), "");
  two.back().count = 1e9;
  EXPECT_EQ(remedy_of(two), "few");
}

}  // namespace size_limit_test
}  // namespace strake
