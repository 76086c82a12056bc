#include "proto/error.hpp"

#include "proto/interface.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace error_test {

TEST(Error, PrintsPlaceAndProblemThenDetailsThenTheFix) {
  const Error error(ExitCode::solver_fault, "fluid, window 420 (t = 0.0042 s)",
                    "pressure did not converge\n500 iterations, residual 3.2e-04",
                    "lower fluid.scheme.cfl (0.2)");
  EXPECT_EQ(to_text(error),
            "fluid, window 420 (t = 0.0042 s): pressure did not converge\n"
            "  500 iterations, residual 3.2e-04\n"
            "  fix: lower fluid.scheme.cfl (0.2)\n");
  EXPECT_STREQ(error.what(), to_text(error).c_str());
}

TEST(Error, WithoutPlaceDetailsOrFixPrintsNoneOfThem) {
  EXPECT_EQ(to_text(Error(ExitCode::our_bug, "", "lost")), "lost\n");
  EXPECT_EQ(to_text(Error(ExitCode::our_bug, "here", "")), "here\n");
}

TEST(Error, KeepsTheIndentationOfAShownLine) {
  EXPECT_EQ(to_text(Error(ExitCode::case_file, "a:1:1", "\n    1 | x = 2\n      | ^ expected 3")),
            "a:1:1\n    1 | x = 2\n      | ^ expected 3\n");
}

TEST(Error, AlignsTheLinesOfALongFix) {
  EXPECT_EQ(to_text(Error(ExitCode::case_file, "a", "b", "this\nor that")),
            "a: b\n  fix: this\n       or that\n");
}

TEST(DidYouMean, FindsOneSlip) {
  const std::vector<std::string> known{"spacing", "density", "gravity", "tank"};
  EXPECT_EQ(did_you_mean("spacng", known), "spacing");
  EXPECT_EQ(did_you_mean("spaicng", known), "spacing");
  EXPECT_EQ(did_you_mean("tanks", known), "tank");
  EXPECT_EQ(did_you_mean("gravity", known), "gravity");
}

TEST(DidYouMean, StaysSilentAboutAnotherWord) {
  EXPECT_EQ(did_you_mean("colour", {"spacing", "density", "at", "of"}), "");
  EXPECT_EQ(did_you_mean("x", {"y", "of"}), "");
  EXPECT_EQ(did_you_mean("", {"of"}), "");
  EXPECT_EQ(did_you_mean("of", {}), "");
}

TEST(DidYouMean, TakesTheNearestOfSeveral) {
  EXPECT_EQ(did_you_mean("radus", {"raduis_of", "radius", "radios"}), "radius");
}

TEST(Find, ReturnsTheFieldOfAQuantityOrNothing) {
  const std::vector<Field> fields{{"displacement", "m", false, {}}, {"force", "N", true, {}}};
  ASSERT_NE(find(fields, "force"), nullptr);
  EXPECT_EQ(find(fields, "force")->unit, "N");
  EXPECT_EQ(find(fields, "velocity"), nullptr);
}

}  // namespace error_test
}  // namespace strake
