// Several bodies in one case: [[structures]].
#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace case_bodies_test {

const std::string two =
    "end_time = 1\n"
    "[fluid]\nspacing = 0.01\n"
    "[[structures]]\nname = \"left\"\nsolver = \"rigid\"\n[structures.plate]\nlength = 0.4\nthickness = "
    "0.02\n"
    "[[structures]]\nname = \"right\"\n[structures.plate]\nlength = 0.5\nthickness = 0.01\n";

std::string refusal(const std::string& text, const std::vector<std::string>& sets = {}) {
  try {
    CaseFile file = CaseFile::parse(text, "case.toml", sets);
    read_common(file);
  } catch (const Error& error) {
    return to_text(error);
  }
  return "";
}

TEST(Bodies, StandAsTheStructureOfTheirOwnCase) {
  const CaseFile file = CaseFile::parse(two, "case.toml", {"structures.right.plate.length=0.6"});
  EXPECT_EQ(file.bodies(), (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(file.of_body("left").numbers_at("structure.plate.length"), std::vector<double>{0.4});
  EXPECT_EQ(file.of_body("right").numbers_at("structure.plate.length"), std::vector<double>{0.6});
  EXPECT_EQ(file.of_body("right").hash(), file.hash());
  EXPECT_NE(CaseFile::parse(two).hash(), file.hash());
}

TEST(Bodies, HaveNamesInMessagesAndInTheEcho) {
  CaseFile file = CaseFile::parse(two).of_body("left");
  double length = 0;
  CaseTable plate = file.root().table("structure").table("plate");
  plate.number("length", length, {.unit = "m"});
  EXPECT_NE(std::string(plate.error("length", "a longer plate").where()).find("structures.left.plate.length"),
            std::string::npos);
  const std::string text = file.echo("structure");
  EXPECT_NE(text.find("[structures.plate]"), std::string::npos) << text;
  try {
    plate.number("length", length, {.unit = "m", .min = 1});
    ADD_FAILURE() << "0.4 is below 1";
  } catch (const Error& error) {
    EXPECT_NE(error.where().find("case.toml:8:10: structures.left.plate.length = 0.4"), std::string::npos);
  }
}

TEST(Bodies, AreReachedBySetUnderTheirNames) {
  CaseFile file = CaseFile::parse(two, "case.toml", {"structures.left.free=true"}).of_body("left");
  try {
    file.root().table("structure").table("free");
    ADD_FAILURE() << "a table is no flag";
  } catch (const Error& error) {
    EXPECT_EQ(
        to_text(error),
        "--set structures.left.free=true: expected a table\n"
        "  fix: --set structures.left.free.KEY=VALUE for a key of it  (strake explain structure.free)\n");
  }
}

TEST(Bodies, AreReadByEveryProgramAlike) {
  CaseFile whole = CaseFile::parse(two), own = whole.of_body("right");
  const CommonKeys of_all = read_common(whole), of_one = read_common(own);
  ASSERT_EQ(of_all.bodies.size(), 2U);
  EXPECT_EQ(of_all.bodies[0].solver, "rigid");
  EXPECT_EQ(of_one.structure_solver, "fem");
  EXPECT_EQ(of_all.window, of_one.window);
  EXPECT_EQ(of_one.body, "right");
  std::vector<std::string> probes, sides;
  for (const ProbeKeys& probe : of_one.probes) {
    probes.push_back(probe.name);
    sides.push_back(probe.of);
  }
  EXPECT_EQ(probes.front(), "right_middle");
  EXPECT_EQ(sides.front(), "structure");
  EXPECT_EQ(of_all.probes.front().of, "right");
}

TEST(Bodies, AreRefusedWithWords) {
  EXPECT_NE(refusal(two + "[structure]\n").find("one body or a list of them"), std::string::npos);
  EXPECT_NE(refusal(two, {"structure.solver=fem"}).find("structures.NAME."), std::string::npos);
  EXPECT_NE(refusal(two, {"structures.midle.solver=fem"}).find("the bodies left, right"), std::string::npos);
  EXPECT_NE(refusal(two, {"structures.right.name=left"}).find("no other body has"), std::string::npos);
  EXPECT_NE(refusal(two, {"structures.right.name=fluid"}).find("a name that is free"), std::string::npos);
  EXPECT_NE(refusal(two, {"structures.right.name=a b"}).find("letters, digits"), std::string::npos);
  EXPECT_NE(refusal(two, {"structures.right.solver=none"}).find("leave its [[structures]] out"),
            std::string::npos);
  EXPECT_NE(refusal("end_time = 1\n[[structures]]\nsolver = \"fem\"\n").find("structures[0].name is missing"),
            std::string::npos);
  EXPECT_NE(refusal("end_time = 1\nstructures = 3\n").find("tables [[structures]]"), std::string::npos);
  const std::string probe = "[[output.probe]]\nname = \"p\"\nat = [0, 0]\nof = ";
  EXPECT_EQ(refusal(two + probe + "\"left\"\n"), "");
  EXPECT_NE(refusal(two + probe + "\"structure\"\n").find("left"), std::string::npos);
}

}  // namespace case_bodies_test
}  // namespace strake
