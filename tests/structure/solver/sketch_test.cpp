#include "structure/solver/sketch.hpp"

#include "structure/participant.hpp"
#include "structure/rigid/rigid.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace strake::structure {
namespace sketch_test {

/// A floor and a post on it, the floor's left end clamped.
Parameters floor_and_post() {
  SolidBox floor, post;
  floor.name = "floor";
  floor.max << 1, 0.1, 0;
  floor.support[0] = Support::clamped;
  post.name = "post";
  post.min << 0.4, 0.1, 0;
  post.max << 0.5, 0.4, 0;
  Parameters p;
  p.kind = "rigid";
  p.shape.kind = ShapeKind::solid;
  p.solid = solid_of_boxes(2, {floor, post});
  p.shape.corner = outer_polygons(p.solid).front();
  p.surface_spacing = 0.1;
  return p;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(Picture, ShowsPartsSupportsAndEachWetPoint) {
  const Parameters p = floor_and_post();
  const Rigid solver(p);
  const std::string svg = picture(solver, p);
  EXPECT_EQ(svg.rfind("<svg ", 0), 0U);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
  EXPECT_NE(svg.find("floor.left: clamped"), std::string::npos);
  EXPECT_EQ(count(svg, "<circle"), static_cast<std::size_t>(solver.interface().position.cols()));
  EXPECT_EQ(count(svg, "nan") + count(svg, "inf"), 0U);
}

TEST(Properties, OfABodyOfPartsAreThoseOfItsMass) {
  Rigid solver(floor_and_post());
  const Properties body = solver.properties();
  EXPECT_NEAR(body.mass, 7800 * (0.1 + 0.03), 1e-9);
  const std::string line = properties_line("rigid", body);
  EXPECT_NE(line.find("1014"), std::string::npos) << line;
  EXPECT_EQ(properties_line("none", {}), "");
}

}  // namespace sketch_test
}  // namespace strake::structure
