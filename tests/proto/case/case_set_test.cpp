// What wins: the default, the preset, the case or --set; and what --set may say.

#include "proto/case/case_file.hpp"
#include "tests/proto/plate_case.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake {
namespace case_set_test {

TEST(CaseFile, TakesDefaultThenPresetThenCaseThenSet) {
  const std::string text = "preset = \"paper\"\n" + head + "scheme.cfl = 0.3\n";
  EXPECT_EQ(read(head).cfl, 0.2);
  EXPECT_EQ(read("preset = \"paper\"\n" + head).cfl, 0.1);
  EXPECT_EQ(read(text).cfl, 0.3);
  EXPECT_EQ(read(text, {"fluid.scheme.cfl=0.4"}).cfl, 0.4);
  const PlateCase paper = read(text);
  EXPECT_TRUE(std::isinf(paper.sound_speed));
  EXPECT_FALSE(paper.negative_pressure);
  EXPECT_EQ(paper.degree, 1);
  EXPECT_EQ(paper.material, PlateCase::Material::linear);

  CaseFile file = CaseFile::parse(text, "case.toml", {"structure.fem.degree=2"});
  read_plate(file);
  EXPECT_EQ(info(file, "fluid.gravity").origin, "default");
  EXPECT_EQ(info(file, "fluid.sound_speed").origin, "preset");
  EXPECT_EQ(info(file, "fluid.scheme.cfl").origin, "case");
  EXPECT_EQ(info(file, "structure.fem.degree").origin, "--set");
}

TEST(CaseFile, SetChoosesThePresetToo) {
  CaseFile file = CaseFile::parse("preset = \"improved\"\n" + head, "case.toml", {"preset=paper"});
  EXPECT_EQ(file.preset(), "paper");
  EXPECT_EQ(read_plate(file).cfl, 0.1);
}

TEST(Set, IsReadAsTomlElseAsTextAndTheDeclarationDecides) {
  const PlateCase c = read(head, {"structure.solver=rigid", "fluid.gravity=[0, -1]", "title=2024",
                                  "fluid.spacing=.5", "fluid.sound_speed=inf", "structure.parts=hull",
                                  "structure.material.model=\"linear\"", "output.every = 1e-3"});
  EXPECT_EQ(c.common.structure_solver, "rigid");
  EXPECT_EQ(c.gravity.y(), -1);
  EXPECT_EQ(c.common.title, "2024");
  EXPECT_EQ(c.spacing, 0.5);
  EXPECT_TRUE(std::isinf(c.sound_speed));
  EXPECT_EQ(c.parts, std::vector<std::string>{"hull"});
  EXPECT_EQ(c.material, PlateCase::Material::linear);
  EXPECT_EQ(c.common.output_every, 1e-3);
}

TEST(Set, OfATableIsAnsweredWithTheSetOfItsKeys) {
  const auto refused = [](const std::string& set) {
    try {
      read(head, {set});
    } catch (const Error& error) {
      return to_text(error);
    }
    return std::string("nothing was refused");
  };
  EXPECT_EQ(refused("fluid.scheme=true"),
            "--set fluid.scheme=true: expected a table\n"
            "  fix: --set fluid.scheme.KEY=VALUE for a key of it  (strake explain fluid.scheme)\n");
  EXPECT_EQ(refused("output.probe=3"),
            "--set output.probe=3: expected a list of tables\n"
            "  fix: --set output.probe[0].KEY=VALUE for a key of it  (strake explain output.probe)\n");
}

TEST(Set, OfOneKeyCannotBringAnother) {
  EXPECT_EQ(read(head, {"title=1\nend_time = 7"}).common.end_time, 0.03);
}

TEST(Set, ReachesIntoAListOfTablesAndAddsAnElement) {
  const std::string probe = "[[output.probe]]\nname = \"a\"\nof = \"fluid\"\nat = [0, 0]\n";
  const PlateCase c = read(head + probe, {"output.probe[0].diameter=0.5", "output.probe[1].name=b",
                                          "output.probe[1].of=structure", "output.probe[1].at=[1,2]"});
  ASSERT_EQ(c.common.probes.size(), 2u);
  EXPECT_EQ(c.common.probes[0].diameter, 0.5);
  EXPECT_EQ(c.common.probes[1].name, "b");
  EXPECT_EQ(c.common.probes[1].at.y(), 2);
}

TEST(Set, LaterWinsOverEarlier) {
  EXPECT_EQ(read(head, {"fluid.spacing=1", "fluid.spacing=2"}).spacing, 2);
  EXPECT_EQ(read(head, {"fluid.scheme.cfl=0.9", "fluid.scheme={negative_pressure=false}"}).cfl, 0.2);
}

// What is not UTF-8 could be stored in the resolved case, which could then not be read again.
TEST(CaseFile, ASetThatIsNoTextIsRefused) {
  EXPECT_THROW(CaseFile::parse("end_time = 1", "case.toml", {"title=\xc9\xc9"}), Error);
  EXPECT_NO_THROW(CaseFile::parse("end_time = 1", "case.toml", {"title=Zürich"}));
}

}  // namespace case_set_test
}  // namespace strake
