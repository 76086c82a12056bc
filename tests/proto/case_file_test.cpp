#include "proto/case_file.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <fstream>

#include "proto/case_document.hpp"
#include "tests/proto/plate_case.hpp"
#include "tests/proto/temporary_folder.hpp"

namespace strake {
namespace {

const std::string head =
    "title = \"plate\"\n"
    "end_time = 0.03\n"
    "[fluid]\n"
    "spacing = 0.01\n";

PlateCase read(const std::string& text, const std::vector<std::string>& sets = {}) {
  CaseFile file = CaseFile::parse(text, "case.toml", sets);
  PlateCase c = read_plate(file);
  file.refuse_unknown();
  return c;
}

const KeyInfo& info(const CaseFile& file, const std::string& path) {
  const auto& keys = file.declared();
  const auto key = std::find_if(keys.begin(), keys.end(), [&](const KeyInfo& k) { return k.path == path; });
  if (key == keys.end()) throw std::runtime_error("not declared: " + path);
  return *key;
}

TEST(CaseFile, ReadsEveryKindOfValue) {
  const TemporaryFolder folder;
  put(folder / "curve.csv", "time [s]\n");
  std::filesystem::create_directories(folder / "runs/earlier");
  put(folder / "case.toml", head + R"(sound_speed = inf
gravity = [0, -9.81]                       # two components, integers
tank = [[-1.0, -0.5, 0.0], [1.0, 0.5, 0.0]]
scheme.cfl = 1
[structure]
parts = ["bottom", "rib"]
replay.run = "runs/earlier"
[structure.material]
young = 70_000_000_000
model = "linear"
[[output.probe]]
name = "mid"
of = "structure"
at = [0.0, 0.012]
[[compare]]
probe = "mid.y"
reference = "curve.csv"
when = { "structure.solver" = ["fem", "rigid"], "fluid.sound_speed" = inf, "structure.fem.degree" = 2, "fluid.scheme.negative_pressure" = true }
value = { first_peak = 1.625e-3, impulse = 3 }
[[compare]]
probe = "p_mid"
)");
  CaseFile file = CaseFile::load(folder / "case.toml");
  const PlateCase c = read_plate(file);
  file.refuse_unknown();
  EXPECT_EQ(c.common.title, "plate");
  EXPECT_TRUE(std::isinf(c.sound_speed));
  EXPECT_EQ(c.gravity, Eigen::Vector3d(0, -9.81, 0));
  EXPECT_EQ(c.tank.max, Eigen::Vector3d(1, 0.5, 0));
  EXPECT_EQ(c.cfl, 1);
  EXPECT_EQ(c.young, 7e10);
  EXPECT_EQ(c.material, PlateCase::Material::linear);
  EXPECT_EQ(c.parts, (std::vector<std::string>{"bottom", "rib"}));
  EXPECT_EQ(c.reference, std::filesystem::absolute(folder / "curve.csv"));
  EXPECT_EQ(c.run, std::filesystem::absolute(folder / "runs/earlier"));
  ASSERT_EQ(c.common.probes.size(), 1u);
  EXPECT_EQ(c.common.probes[0].quantity, "deflection");  // the structure's default
  ASSERT_EQ(c.compare.size(), 2u);
  using When = std::vector<std::pair<std::string, std::vector<std::string>>>;
  EXPECT_EQ(c.compare[0].when, (When{{"structure.solver", {"fem", "rigid"}},
                                     {"fluid.sound_speed", {"inf"}},
                                     {"structure.fem.degree", {"2"}},
                                     {"fluid.scheme.negative_pressure", {"true"}}}));
  EXPECT_EQ(c.compare[0].value[1], (std::pair<std::string, double>{"impulse", 3}));
}

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

TEST(CaseFile, LeavesDefaultsWhereNothingIsGiven) {
  const PlateCase c = read(head);
  EXPECT_EQ(c.sound_speed, 1500);
  EXPECT_EQ(c.degree, 2);
  EXPECT_EQ(c.common.preset, "improved");
  EXPECT_EQ(c.common.window, 1e-5);
  EXPECT_EQ(c.common.fluid_solver, "mps");
  EXPECT_EQ(c.common.structure_solver, "fem");
}

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
  EXPECT_EQ(spacing.range, "greater than 0");
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
  EXPECT_THROW(keys_from_json("{"), Error);
  EXPECT_THROW(keys_from_json("[{\"path\": 3}]"), Error);
}

TEST(CaseFile, HashChangesWithTheFileTheSetsAndTheFilesItNames) {
  const TemporaryFolder folder;
  put(folder / "case.toml", head + "[[compare]]\nprobe = \"p\"\nreference = \"curve.csv\"\n");
  const auto hash = [&](const std::vector<std::string>& sets = {}) {
    return CaseFile::load(folder / "case.toml", sets).hash();
  };
  const auto without_curve = hash();
  EXPECT_EQ(hash(), without_curve);
  put(folder / "curve.csv", "1");
  const auto with_curve = hash();
  EXPECT_NE(with_curve, without_curve);
  put(folder / "curve.csv", "2");
  EXPECT_NE(hash(), with_curve);
  EXPECT_NE(hash({"a=1", "b=2"}), hash({"b=2", "a=1"}));
  EXPECT_NE(hash({"a=1"}), hash());
  put(folder / "case.toml", content(folder / "case.toml") + "#\n");
  put(folder / "curve.csv", "1");
  EXPECT_NE(hash(), with_curve);
}

TEST(CaseFile, HashOfOnePartIsTheDigestOfItsLengthAndItsBytes) {
  // SHA-256 of eight zero bytes, the length of an empty file; from `head -c 8 /dev/zero | sha256sum`.
  const auto hash = CaseFile::parse("").hash();
  EXPECT_EQ(hash[0], 0xaf);
  EXPECT_EQ(hash[1], 0x55);
  EXPECT_EQ(hash[2], 0x70);
  EXPECT_EQ(hash[3], 0xf5);
}

TEST(CaseTable, AUsersOwnTableIsAcceptedUnread) {
  const std::string text = head + "[structure.flap]\nanything = { at = [\"all\"] }\n";
  CaseFile file = CaseFile::parse(text);
  read_plate(file);
  EXPECT_THROW(file.refuse_unknown(), Error);
  file.root().table("structure").table("flap").accept_all();
  file.refuse_unknown();
}

TEST(CaseTable, RefusesUnknownKeysOnlyBelowThePrefix) {
  CaseFile file = CaseFile::parse(head + "[coupling]\nwindw = 1\n");
  read_plate(file);
  file.refuse_unknown("fluid");
  file.refuse_unknown("not_there");
  EXPECT_THROW(file.refuse_unknown("coupling"), Error);
}

TEST(CaseTable, TellsWhatIsGivenAndWhere) {
  CaseFile file = CaseFile::parse(head, "case.toml", {"structure.fem.degree=1"});
  CaseTable fluid = file.root().table("fluid");
  EXPECT_TRUE(fluid.present());
  EXPECT_FALSE(file.root().table("output").present());
  EXPECT_TRUE(fluid.has("spacing"));
  EXPECT_FALSE(fluid.has("gravity"));
  EXPECT_TRUE(file.root().has("structure.fem.degree"));
  EXPECT_EQ(fluid.keys(), std::vector<std::string>{"spacing"});
  EXPECT_EQ(fluid.where("spacing"), "case.toml:4:11: fluid.spacing = 0.01");
  EXPECT_EQ(file.root().where("structure.fem.degree"), "--set structure.fem.degree=1");
  read_plate(file);
  EXPECT_EQ(fluid.where("sound_speed"), "case.toml: fluid.sound_speed = 1500 (default)");
}

TEST(CaseTable, WordsTheErrorOfACheckAcrossKeys) {
  CaseFile file = CaseFile::parse(head);
  const Error error =
      file.root().table("fluid").error("spacing", "a whole part of the tank", "spacing = 0.02");
  EXPECT_EQ(to_text(error),
            "case.toml:4:11: fluid.spacing = 0.01\n"
            "    4 | spacing = 0.01\n"
            "      |           ^ expected a whole part of the tank\n"
            "  fix: spacing = 0.02\n");
}

TEST(CaseFile, KnowsItsFolder) {
  const TemporaryFolder folder;
  put(folder / "case.toml", head);
  const CaseFile file = CaseFile::load(folder / "case.toml");
  EXPECT_EQ(file.folder(), std::filesystem::absolute(folder.path()));
  EXPECT_EQ(file.path(), folder / "case.toml");
}

TEST(CaseFile, SaysWhyAFileCannotBeRead) {
  const TemporaryFolder folder;
  const auto text = [](const std::filesystem::path& path) {
    try {
      CaseFile::load(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::case_file);
      return to_text(error);
    }
    return std::string("no error");
  };
  EXPECT_TRUE(text(folder / "no.toml").starts_with((folder / "no.toml").string() + ": no such file\n"));
  EXPECT_TRUE(text(folder.path()).starts_with(folder.path().string() + ": is a folder, not a file\n"));
  put(folder / "locked.toml", head);
  std::filesystem::permissions(folder / "locked.toml", std::filesystem::perms::none);
  if (std::ifstream(folder / "locked.toml")) return;  // the superuser reads it all the same
  EXPECT_NE(text(folder / "locked.toml").find("cannot be read: Permission denied"), std::string::npos);
}

TEST(CaseFile, WithDamagedBytesIsReadOrRefusedButNeverCrashes) {
  const std::string text = head + "tank = [[-1.0, -0.5], [1.0, 0.5]] # box\n[structure]\nsolver = \"fem\"\n" +
                           "[[compare]]\nprobe = \"mid\"\nwhen = { \"a.b\" = [1, inf] }\n";
  const std::string damage = std::string("\"'[]{}=.,#\n\r\t x0-\\\xff\xc3", 20) + '\0';
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (std::size_t j = i % 3; j < damage.size() + 1; j += 3) {
      std::string damaged = text;
      if (j < damage.size())
        damaged[i] = damage[j];
      else
        damaged.erase(i, 1);
      try {
        CaseFile file = CaseFile::parse(damaged);
        read_plate(file);
        file.echo();
        file.refuse_unknown();
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::case_file) << damaged;
        EXPECT_FALSE(error.fix().empty()) << to_text(error);
      }
    }
  }
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

TEST(Path, SplitsIntoKeysAndIndices) {
  const auto steps = split_path("compare[12].when.\"structure.solver\"");
  ASSERT_EQ(steps.size(), 4u);
  EXPECT_EQ(steps[1].index, 12);
  EXPECT_EQ(steps[3].key, "structure.solver");
  for (const char* bad : {"", ".", "a..b", "a.", "a[", "a[x]", "[0]", "a b", "\"a", "a\"b\"", "a[0]b"})
    EXPECT_TRUE(split_path(bad).empty()) << bad;
  EXPECT_EQ(parent_and_name("a[0].\"b.c\""), (std::pair<std::string, std::string>{"a[0]", "b.c"}));
}

// What is not UTF-8 could be stored in the resolved case, which nobody could read again.
TEST(CaseFile, ASetThatIsNoTextIsRefused) {
  EXPECT_THROW(CaseFile::parse("end_time = 1", "case.toml", {"title=\xc9\xc9"}), Error);
  EXPECT_NO_THROW(CaseFile::parse("end_time = 1", "case.toml", {"title=Zürich"}));
}

}  // namespace
}  // namespace strake
