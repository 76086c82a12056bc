#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"
#include "tests/proto/refusal.hpp"

namespace strake {
namespace key_range_test {

double read(const std::string& text, const NumberKey& key) {
  CaseFile file = CaseFile::parse("key = " + text);
  double value = 1;
  file.root().number("key", value, key);
  return value;
}

TEST(KeyRange, AMagnitudeThatNoQuantityHasIsRefused) {
  const NumberKey length{.unit = "m", .min = 0, .exclusive = true};
  EXPECT_EQ(read("1e6", length), 1e6);
  EXPECT_EQ(read("1e-9", length), 1e-9);
  for (const char* text : {"1e9", "1e300", "1e-300", "1e-10"})
    expect_refused([&] { read(text, length); }, "expected a number in m, 1e-9 to 1e6");
  expect_refused([&] { read("1e300", {.unit = "Pa", .min = 0}); }, "expected a number in Pa, 0 to 1e15");
  expect_refused([&] { read("-1e9", {.unit = "m/s"}); }, "expected a number in m/s, -1e5 to 1e5");
}

TEST(KeyRange, WhatAKeyDeclaresItselfIsSaidAsBefore) {
  expect_refused([] { read("0", {.unit = "m", .min = 0, .exclusive = true}); },
                 "expected a number in m, greater than 0\n");
  expect_refused([] { read("1.5", {.min = 0, .max = 1, .exclusive = true}); },
                 "expected a number, greater than 0, at most 1\n");
}

TEST(KeyRange, InfinityStaysWhereItMeansWithoutLimit) {
  EXPECT_TRUE(std::isinf(read("inf", {.unit = "m/s", .min = 0, .exclusive = true, .infinite = true})));
  expect_refused([] { read("-inf", {.unit = "m/s", .infinite = true}); }, "or inf");
  expect_refused([] { read("1e200", {.unit = "m/s", .min = 0, .infinite = true}); },
                 "expected a number in m/s, 0 to 1e5, or inf");
}

TEST(KeyRange, ComponentsOfVectorsBoxesAndPointsHaveTheMagnitudeOfTheirUnit) {
  CaseFile file =
      CaseFile::parse("at = [0, 1e300]\nbox = [[0, 0], [1, 1e9]]\ncorners = [[0, 0], [-1e9, 0], [1, 1]]");
  Eigen::Vector3d at;
  Box box;
  std::vector<Eigen::Vector3d> corners;
  const std::string words = "expected a number in m, -1e6 to 1e6";
  expect_refused([&] { file.root().vector("at", at, {.unit = "m"}); }, words);
  expect_refused([&] { file.root().box("box", box, {.unit = "m"}); }, words);
  expect_refused([&] { file.root().points("corners", corners, {.unit = "m"}); }, words);
}

TEST(KeyRange, AListThatIsComparedWithItselfHasAnEnd) {
  std::string points = "corners = [", tables;
  for (int i = 0; i < 2001; ++i) {
    points += "[0, 0],";
    tables += "[[box]]\n";
  }
  CaseFile file = CaseFile::parse(points + "]\n" + tables);
  std::vector<Eigen::Vector3d> corners;
  expect_refused([&] { file.root().points("corners", corners, {}); },
                 "at most 2000 points, this list has 2001");
  expect_refused([&] { file.root().tables("box"); }, "at most 2000 tables, this list has 2001");
}

TEST(KeyRange, AProbesNameIsShortAndPrintable) {
  const auto read = [](const std::string& name) {
    CaseFile file = CaseFile::parse("end_time = 1\n[[output.probe]]\nof = \"fluid\"\nat = [0, 0]\nname = \"" +
                                    name + "\"\n");
    read_common(file);
  };
  expect_refused([&] { read(std::string(101, 'a')); }, "at most 100 letters, not 101");
  expect_refused([&] { read("a\\u0007b"); }, "letters, digits");
}

TEST(KeyRange, TheReferenceShowsTheRange) {
  CaseFile file = CaseFile::declarations_only();
  double value = 1500;
  file.root().number("speed", value, {.unit = "m/s", .min = 0, .exclusive = true, .infinite = true});
  EXPECT_EQ(file.declared().front().range, "1e-9 to 1e5, or inf");
}

}  // namespace key_range_test
}  // namespace strake
