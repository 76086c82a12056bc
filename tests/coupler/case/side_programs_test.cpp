// Which of our programs a check asks for a body.
#include "coupler/case/side_programs.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace strake {
namespace side_programs_test {

using Names = std::vector<std::string>;

SideView body_of(const std::string& solver, const std::string& name = "structure", bool several = false) {
  SideView body{.side = name, .solver = solver, .program = {}, .lines = {}, .echo = {}};
  body.is_body = several;
  return body;
}

TEST(SidePrograms, AFormOfRigidBodiesAloneIsAskedOfNoOther) {
  CaseView view;
  const Names all = {"fem", "particle", "rigid"}, one = {"rigid"};
  view.value = {{"structure.plate.length", "0.4"}, {"structure.solver", "rigid"}};
  EXPECT_EQ(discretisations(view, body_of("rigid")), all);
  for (const std::string key : {"structure.wedge.deadrise", "structure.outline", "structure.offsets"}) {
    CaseView wedge = view;
    wedge.value[key] = "25";
    EXPECT_EQ(discretisations(wedge, body_of("rigid")), one) << key;
    EXPECT_EQ(discretisations(wedge, body_of("fem")), all) << "its own program refuses it";
  }
  view.value = {{"structures.left.sphere.radius", "1"}, {"structures.right.box[0].min", "[0, 0]"}};
  EXPECT_EQ(discretisations(view, body_of("rigid", "left", true)), one);
  EXPECT_EQ(discretisations(view, body_of("rigid", "right", true)), all);
}

}  // namespace side_programs_test
}  // namespace strake
