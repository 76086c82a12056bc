#include "structure/body/mechanism.hpp"

#include "tests/structure/body/boxes.hpp"

#include <gtest/gtest.h>

#include <string>

namespace strake::structure {
namespace mechanism_test {

/// What two supports of a beam from (0, 0) to (2, 0.1) m leave; in space it reaches from z = 0 to 1.
std::string left_by(Support left, Support right, int dimension = 2, Support back = Support::free) {
  SolidBox beam = box("beam", {0, 0, 0}, {2, 0.1, 1});
  beam.support = {left, right, Support::free, Support::free, back, Support::free};
  return motions_left(solid_of_boxes(dimension, {beam}));
}

std::string motions(int count, const std::string& words) {
  return std::to_string(count) +
         (count == 1 ? " motion of the whole body that strains" : " motions of the whole body that strain") +
         " nothing: it " + words;
}

TEST(Mechanism, TellsTheMotionsThatTheSupportsOfABeamLeave) {
  EXPECT_EQ(left_by(Support::clamped, Support::free), "");
  EXPECT_EQ(left_by(Support::pinned, Support::pinned), "");
  EXPECT_EQ(left_by(Support::pinned, Support::roller), "");
  EXPECT_EQ(left_by(Support::free, Support::free), "") << "a body without supports says so elsewhere";
  EXPECT_EQ(left_by(Support::pinned, Support::free), motions(1, "turns about (0, 0.05) m"));
  EXPECT_EQ(left_by(Support::free, Support::pinned), motions(1, "turns about (2, 0.05) m"));
  EXPECT_EQ(left_by(Support::roller, Support::roller), motions(1, "moves along x"));
  EXPECT_EQ(left_by(Support::roller, Support::free), motions(2, "moves along x and turns about z"));
  EXPECT_EQ(left_by(Support::symmetry, Support::free), motions(1, "moves along y"));
}

TEST(Mechanism, TellsThemInSpace) {
  EXPECT_EQ(left_by(Support::clamped, Support::free, 3), "");
  EXPECT_EQ(left_by(Support::pinned, Support::pinned, 3), "");
  EXPECT_EQ(left_by(Support::pinned, Support::free, 3), motions(1, "turns about z"));
  EXPECT_EQ(left_by(Support::symmetry, Support::symmetry, 3),
            motions(3, "moves along y and z and turns about x"));
  EXPECT_EQ(left_by(Support::symmetry, Support::free, 3, Support::symmetry), motions(1, "moves along y"));
}

TEST(Mechanism, APartThatIsHeldLeavesNone) {
  SolidBox foot = box("foot", {0, 0, 0}, {0.1, 0.1, 1}), beam = box("beam", {0.1, 0, 0}, {2, 0.1, 1});
  foot.constrained = true;
  EXPECT_EQ(motions_left(solid_of_boxes(2, {foot, beam})), "");
}

}  // namespace mechanism_test
}  // namespace strake::structure
