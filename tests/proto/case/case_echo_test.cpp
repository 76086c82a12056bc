// What a case shows of itself: its values as they were read, and the keys that may be given.

#include "proto/case/case_document.hpp"
#include "proto/case/case_file.hpp"
#include "tests/proto/plate_case.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace strake {
namespace case_echo_test {

TEST(CaseTable, ReadsAListOfPointsAndEchoesIt) {
  CaseFile file = CaseFile::parse("outline = [[0, 0], [1, 0], [0.5, 1]]\nshort = [[0, 0], [1, 0]]\n");
  std::vector<Eigen::Vector3d> outline, absent, short_one;
  file.root().points("outline", outline, {.unit = "m"});
  file.root().points("absent", absent, {.unit = "m"});
  ASSERT_EQ(outline.size(), 3u);
  EXPECT_EQ(outline[2], Eigen::Vector3d(0.5, 1, 0));
  EXPECT_TRUE(absent.empty());
  EXPECT_THROW(file.root().points("short", short_one, {.unit = "m"}), Error);
  CaseFile again = CaseFile::parse(file.echo());
  std::vector<Eigen::Vector3d> back;
  again.root().points("outline", back, {.unit = "m"});
  EXPECT_EQ(back, outline);
  EXPECT_FALSE(again.root().has("absent"));
}

TEST(CaseFile, EchoReadsBackToTheSameValues) {
  const TemporaryFolder folder;
  put(folder / "curve \"1\".csv", "x [m]\n");
  put(folder / "solver", "");
  put(folder / "case.toml",
      "title = \"a \\\"quoted\\\" \\\\ tab\\t é\\u0001\"\n" + head.substr(head.find('\n') + 1) + R"(
sound_speed = inf
[structure]
solver = "./solver"
parts = []
[[output.probe]]
name = "mid"
of = "fluid"
at = [0.1, 1e-300]
[[compare]]
probe = "mid"
reference = "curve \"1\".csv"
when = { "structure.solver" = ["fem"], "fluid.sound_speed" = [inf, 0.1] }
value = { first_peak = -1e22 }
[[compare]]
probe = "p"
[[compare]]
probe = "q"
value = { final = 0.1 }
)");
  CaseFile file = CaseFile::load(folder / "case.toml", {"preset=paper", "structure.fem.degree=2"});
  read_plate(file);
  const TemporaryFolder elsewhere;
  put(elsewhere / "case.toml", file.echo());
  CaseFile again = CaseFile::load(elsewhere / "case.toml");
  read_plate(again);
  again.refuse_unknown();
  ASSERT_EQ(again.declared().size(), file.declared().size());
  for (const KeyInfo& key : file.declared()) EXPECT_EQ(info(again, key.path).value, key.value) << key.path;
  EXPECT_EQ(info(again, "structure.solver").value, std::filesystem::absolute(folder / "solver").string());
}

TEST(CaseFile, EchoNamesUnitAndOriginOfEachKeyBelowAPrefix) {
  CaseFile file = CaseFile::parse(head, "case.toml", {"fluid.scheme.cfl=0.25"});
  read_plate(file);
  EXPECT_EQ(file.echo("fluid"),
            "[fluid]\n"
            "solver = \"mps\"  # default\n"
            "spacing = 0.01  # m, case\n"
            "sound_speed = 1500  # m/s, default\n"
            "gravity = [0, -9.81, 0]  # m/s^2, default\n"
            "# tank is not given\n"
            "\n"
            "[fluid.scheme]\n"
            "cfl = 0.25  # --set\n"
            "negative_pressure = true  # default\n");
}

TEST(CaseFile, DeclaringAKeyAgainChangesNothing) {
  CaseFile file = CaseFile::parse(head);
  read_plate(file);
  const std::size_t n = file.declared().size();
  const std::string echo = file.echo();
  EXPECT_EQ(read_plate(file).spacing, 0.01);
  EXPECT_EQ(file.declared().size(), n);
  EXPECT_EQ(file.echo(), echo);
}

TEST(CaseFile, DeclarationsNeedNoFile) {
  CaseFile file = CaseFile::declarations_only();
  EXPECT_TRUE(file.only_declares());
  read_plate(file);
  file.refuse_unknown();
  const KeyInfo& spacing = info(file, "fluid.spacing");
  EXPECT_EQ(spacing.type, "number");
  EXPECT_EQ(spacing.unit, "m");
  EXPECT_EQ(spacing.range, "1e-9 to 1e6");
  EXPECT_EQ(spacing.default_value, "");
  EXPECT_EQ(info(file, "fluid.scheme.cfl").paper_value, "0.1");
  EXPECT_EQ(info(file, "output.probe[].name").type, "text");
  EXPECT_EQ(info(file, "compare").type, "table");
  EXPECT_EQ(info(file, "structure.mesh").type, "not built");
  EXPECT_EQ(info(file, "structure.material.model").choices,
            (std::vector<std::string>{"linear", "saint_venant_kirchhoff"}));
}

TEST(CaseFile, DeclarationsGoThroughJsonAndBack) {
  CaseFile file = CaseFile::declarations_only();
  read_plate(file);
  const std::vector<KeyInfo> back = keys_from_json(to_json(file.declared()));
  ASSERT_EQ(back.size(), file.declared().size());
  EXPECT_EQ(to_json(back), to_json(file.declared()));
  const auto at = [&](const std::string& path) {
    return *std::find_if(back.begin(), back.end(), [&](const KeyInfo& key) { return key.path == path; });
  };
  const KeyLimits cfl = at("fluid.scheme.cfl").limits, spacing = at("fluid.spacing").limits;
  EXPECT_EQ(cfl.max, 1) << "as declared";
  EXPECT_FALSE(cfl.required);
  EXPECT_EQ(spacing.min, 1e-9) << "the smallest length";
  EXPECT_TRUE(spacing.required);
  EXPECT_THROW(keys_from_json("{"), Error);
  EXPECT_THROW(keys_from_json("[{\"path\": 3}]"), Error);
}

TEST(Toml, NumbersAreShortAndReadBack) {
  EXPECT_EQ(to_toml(2.1e11), "2.1e11");
  EXPECT_EQ(to_toml(1e-5), "1e-5");
  EXPECT_EQ(to_toml(1500.0), "1500");
  EXPECT_EQ(to_toml(-0.1), "-0.1");
  EXPECT_EQ(to_toml(std::numeric_limits<double>::infinity()), "inf");
  for (const double x : {0.1 + 0.2, 1e100, 5e-324, -1.7976931348623157e308, 1e5, 123456789.0})
    EXPECT_EQ(toml::parse("x = " + to_toml(x))["x"].value<double>(), x);
}

/// A case with a structure of the user's in a folder of its own, and what goes on in its table.
class UsersStructure {
 public:
  explicit UsersStructure(const std::string& keys) {
    put(folder / "case.toml", "[structure]\nsolver = \"./spring.py\"\n" + keys);
  }
  CaseFile load() const { return CaseFile::load(folder / "case.toml"); }
  std::string place() const { return std::filesystem::absolute(folder.path()).lexically_normal().string(); }
  const TemporaryFolder folder;
};

TEST(CaseEcho, PathsAreAbsoluteSoThatACopyElsewhereReadsTheSame) {
  const UsersStructure users(R"(folder = "work"
surface = "../skin.msh"
title = "work"
[structure.replay]
run = "runs/earlier"
[structure.precice]
command = ["./bin/flap", "./input"]
config = "/etc/precice.xml"
)");
  CaseFile file = users.load();
  std::string run;
  file.root().table("structure").table("replay").text("run", run, {.path = true});
  const std::string place = users.place();
  EXPECT_EQ(run, place + "/runs/earlier");
  EXPECT_NE(file.echo("structure").find("run = \"" + run + "\""), std::string::npos)
      << file.echo("structure");
  const std::string given = file.as_given("structure", "/opt/spring.py");
  const std::string above = std::filesystem::path(place).parent_path().string();
  const std::vector<std::string> lines = {
      "folder = '" + place + "/work'", "surface = '" + above + "/skin.msh'", "title = 'work'",
      "command = [ '" + place + "/bin/flap', './input' ]", "config = '/etc/precice.xml'"};
  for (const std::string& line : lines)
    EXPECT_NE(given.find(line), std::string::npos) << line << "\n" << given;
}

TEST(CaseEcho, FilesOfAUsersProgramAreAbsoluteWhereTheyExist) {
  const UsersStructure users(R"(arguments = ["law.csv"]
law = "law.csv"
grids = ["./data.d/grid.msh", "other.msh"]
kind = "soft"
folders = "data.d"
version = "1.2"
[structure.own]
deck = "flap.inp"
[structure.precice]
command = ["./bin/flap", "flap.inp"]
)");
  std::filesystem::create_directories(users.folder / "data.d");
  for (const char* name : {"law.csv", "data.d/grid.msh", "soft", "flap.inp"}) put(users.folder / name, "1");
  const std::string given = users.load().as_given("structure", "/opt/spring.py"), place = users.place();
  for (const std::string& line :
       {"law = '" + place + "/law.csv'", "grids = [ '" + place + "/data.d/grid.msh', 'other.msh' ]",
        "deck = '" + place + "/flap.inp'", std::string("arguments = [ 'law.csv' ]"),
        std::string("kind = 'soft'"), std::string("folders = 'data.d'"), std::string("version = '1.2'"),
        "'" + place + "/bin/flap', 'flap.inp'"})
    EXPECT_NE(given.find(line), std::string::npos) << line << "\n" << given;
}

TEST(CaseEcho, TheTableOfAProgramStaysWithItsBody) {
  const std::string body = "solver = \"./spring.py\"\n[structures.spring]\nmass = ",
                    below = "[structures.spring.law]\nk = 2\n";
  const CaseFile file = CaseFile::parse("[[structures]]\nname = \"left\"\n" + body + "1\n" + below +
                                            "[[structures]]\nname = \"right\"\n" + body + "3\n",
                                        "case.toml", {});
  std::string whole;
  for (const std::string& name : file.bodies())
    whole += file.of_body(name).as_given("structure", "/opt/spring.py");
  EXPECT_EQ(whole.find("[structure."), std::string::npos) << whole;
  EXPECT_NE(whole.find("[structures.spring.law]"), std::string::npos) << whole;
  const CaseFile again = CaseFile::parse(whole, "case.toml", {});
  EXPECT_EQ(again.bodies(), (std::vector<std::string>{"left", "right"}));
  EXPECT_NE(again.of_body("right").as_given("structure", "/opt/spring.py").find("mass = 3"),
            std::string::npos);
}

}  // namespace case_echo_test
}  // namespace strake
