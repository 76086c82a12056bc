#include "proto/case/case_file.hpp"

#include "proto/case/case_document.hpp"
#include "tests/proto/plate_case.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace strake {
namespace case_file_test {

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

TEST(CaseFile, LeavesDefaultsWhereNothingIsGiven) {
  const PlateCase c = read(head);
  EXPECT_EQ(c.sound_speed, 1500);
  EXPECT_EQ(c.degree, 2);
  EXPECT_EQ(c.common.preset, "improved");
  EXPECT_EQ(c.common.window, 1e-5);
  EXPECT_EQ(c.common.fluid_solver, "mps");
  EXPECT_EQ(c.common.structure_solver, "fem");
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

TEST(CaseFile, ReadToItsEndSaysEverythingThatIsWrong) {
  CaseFile file = CaseFile::parse("spacing = -1\nchoice = \"c\"\nflag = 3\n[m]\nE = 1\nnu = 0.7\nrho = 2\n");
  double spacing = 0.1, young = 1, poisson = 0.3, density = 1;
  bool flag = false, behind_the_choice = false;
  std::string choice = "a";
  const auto read = [&] {
    file.root().number("spacing", spacing, {.min = 0});
    file.root().flag("flag", flag, {});
    CaseTable m = file.root().table("m");
    m.number("young", young, {.unit = "Pa"});
    m.number("poisson", poisson, {});
    m.number("density", density, {});
    if (spacing < 0) throw file.root().error("spacing", "a check across keys that nobody hears");
  };
  const std::string all = text_of_error(
      [&] {
        file.read_all([&] {
          read();
          file.refuse_unknown();
        });
      },
      ExitCode::case_file);
  for (const char* words :
       {"case.toml:1:11: spacing = -1", "case.toml:3:8: flag = 3", "did you mean young?",
        "m.nu is not a key; did you mean poisson?", "m.rho is not a key; did you mean density?"})
    EXPECT_NE(all.find(words), std::string::npos) << words << "\n" << all;
  EXPECT_EQ(spacing, 0.1) << "read on with the default";
  // A choice decides what is read next: what was wrong before it is said with it.
  const std::string some = text_of_error(
      [&] {
        file.read_all([&] {
          file.root().number("spacing", spacing, {.min = 0});
          file.root().choice("choice", choice, {"a", "b"}, {});
          behind_the_choice = true;
        });
      },
      ExitCode::case_file);
  EXPECT_FALSE(behind_the_choice);
  EXPECT_NE(some.find("spacing = -1"), std::string::npos);
  EXPECT_NE(some.find("\ncase.toml:2:10: choice"), std::string::npos) << some;
  // Without read_all the first error ends the reading, as ever.
  EXPECT_EQ(text_of_error(read, ExitCode::case_file).find("flag"), std::string::npos);
}

TEST(CaseFile, AMissingKeyDoesNotEndTheReading) {
  CaseFile file = CaseFile::parse("flag = 3\n");
  const std::string all = text_of_error(
      [&] {
        file.read_all([&] {
          double length = 0, width = 0;
          Eigen::Vector3d at = Eigen::Vector3d::Zero();
          Box box;
          std::string name;
          bool flag = false;
          CaseTable root = file.root();
          root.number("length", length, {.unit = "m", .min = 0, .exclusive = true, .required = true});
          root.vector("at", at, {.required = true});
          root.box("tank", box, {.required = true});
          root.text("name", name, {.required = true});
          root.number("width", width, {.unit = "m", .min = 0, .exclusive = true, .required = true});
          EXPECT_GT(width, 0) << "any value of the range, to read on";
          EXPECT_LT(box.min.x(), box.max.x());
          root.flag("flag", flag, {});
        });
      },
      ExitCode::case_file);
  for (const char* words : {"length is missing", "at is missing", "tank is missing", "name is missing",
                            "width is missing", "flag = 3"})
    EXPECT_NE(all.find(words), std::string::npos) << words << "\n" << all;
}

TEST(CaseFile, AFaultOfValuesThatStandInIsNotTold) {
  CaseFile file = CaseFile::parse("flag = 3\n");
  const std::string all = text_of_error(
      [&] {
        file.read_all([&] {
          bool flag = false;
          file.root().flag("flag", flag, {});
          throw std::out_of_range("of a vector");
        });
      },
      ExitCode::case_file);
  EXPECT_NE(all.find("flag = 3"), std::string::npos) << all;
  EXPECT_THROW(file.read_all([] { throw std::out_of_range("of a vector"); }), std::out_of_range);
}

TEST(CaseFile, AnotherNameOfAKeyFurtherDownIsUnderstood) {
  for (const auto& [word, meant] : {std::pair{"E", "structure.material.young"},
                                    {"nu", "structure.material.poisson"},
                                    {"rho", "structure.material.density"},
                                    {"density", "structure.material.density"}}) {
    CaseFile file = CaseFile::parse(std::string("[structure]\n") + word + " = 1.0\n");
    double number = 1;
    CaseTable m = file.root().table("structure").table("material");
    file.root().table("fluid").number("density", number, {});
    file.root().table("fluid").number("kinematic_viscosity", number, {});
    for (const char* key : {"density", "young", "poisson"}) m.number(key, number, {});
    const std::string text = text_of_error([&] { file.refuse_unknown(); }, ExitCode::case_file);
    EXPECT_NE(text.find(std::string("did you mean ") + meant + "?"), std::string::npos) << text;
  }
}

TEST(CaseFile, AKeyFurtherDownInATableOfAListIsNamed) {
  CaseFile file = CaseFile::parse("[[box]]\nleft = \"clamped\"\n");
  std::string text;
  for (CaseTable& box : file.root().tables("box")) box.table("supports").text("left", text, {});
  file.root().table("plate").table("supports").text("left", text, {});
  const std::string told = text_of_error([&] { file.refuse_unknown(); }, ExitCode::case_file);
  EXPECT_NE(told.find("did you mean box[0].supports.left?"), std::string::npos) << told;
}

TEST(CaseFile, NumbersCanBeLookedAtWithoutDeclaringThem) {
  CaseFile file =
      CaseFile::parse("a = 2\nb = [[-1, 0.5], [1.5, 3]]\nc = true\nd = [1, inf]\n", "case.toml", {"e.f=7"});
  EXPECT_EQ(file.numbers_at("a"), std::vector<double>{2});
  EXPECT_EQ(file.numbers_at("b"), (std::vector<double>{-1, 0.5, 1.5, 3}));
  EXPECT_TRUE(file.numbers_at("c").empty());
  EXPECT_EQ(file.numbers_at("d"), std::vector<double>{1});
  EXPECT_EQ(file.numbers_at("e.f"), std::vector<double>{7});
  EXPECT_TRUE(file.numbers_at("nothing.there").empty());
  EXPECT_TRUE(file.is_true("c"));
  EXPECT_FALSE(file.is_true("a"));
  EXPECT_TRUE(file.has("e"));
  EXPECT_TRUE(file.declared().empty());
}

TEST(Refusals, AreSaidOnceEach) {
  const Error one(ExitCode::case_file, "a.toml:1", "is wrong\n  1 | here", "write 2"),
      other(ExitCode::case_file, "b", "too");
  EXPECT_EQ(to_text(all_of({one})), to_text(one));
  const Error both(ExitCode::case_file, "", to_text(one) + to_text(other));  // as another program said them
  EXPECT_EQ(to_text(all_of({one, both})), to_text(one) + to_text(other));
  const Error again(ExitCode::case_file, "a.toml:1", "is wrong\n  1 | here", "write 3");  // another program's
  EXPECT_EQ(to_text(all_of({one, other, again})), to_text(one) + to_text(other));
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
    return text_of_error([&] { CaseFile::load(path); }, ExitCode::case_file);
  };
  EXPECT_TRUE(text(folder / "no.toml").starts_with((folder / "no.toml").string() + ": no such file\n"));
  EXPECT_TRUE(text(folder.path()).starts_with(folder.path().string() + ": is a folder, not a file\n"));
  put(folder / "locked.toml", head);
  std::filesystem::permissions(folder / "locked.toml", std::filesystem::perms::none);
  if (std::ifstream(folder / "locked.toml")) return;  // the superuser reads it all the same
  EXPECT_NE(text(folder / "locked.toml").find("cannot be read: Permission denied"), std::string::npos);
}

TEST(CaseFile, SaysWhatAnotherKindOfFileIs) {
  const TemporaryFolder folder;
  const auto text = [&](const std::string& name, const std::string& bytes) {
    put(folder / name, bytes);
    return text_of_error([&] { CaseFile::load(folder / name); }, ExitCode::case_file);
  };
  const auto says = [](const std::string& all, const std::string& part) {
    EXPECT_NE(all.find(part), std::string::npos) << all;
  };
  says(text("a.json", "{\"a\": 1}\n"), "a.json: is JSON, not a case file (TOML)\n");
  says(text("b.py", "import numpy as np\n"), "is a program in Python, not a case file");
  says(text("solver", "#!/usr/bin/python3\nimport strake\n"), "structure.solver = \"./solver\"");
  says(text("c.csv", "time [s],uy [m]\n0,1\n"), "is a table (CSV)");
  says(text("f.stl", "solid cube\n"), "strake new mesh");
  says(text("g.xml", "<?xml version=\"1.0\"?>\n<precice-configuration/>\n"), "strake import");
  says(text("h5.toml", std::string("\x89HDF\r\n\x1a\n", 8)), "is an HDF5 file");
  says(text("program.toml", std::string("\x7f\x45LF\x02\x01\x01\0\0", 9)), "is a compiled program");
  says(text("line.fmu", "PK\x03\x04"), "is a co-simulation unit (FMU)");
  says(text("wide.toml", std::string("\xff\xfet\0i\0", 6)), "save it as UTF-8");
  says(text("noise.toml", std::string(300, '\x01')), "is a binary file");
  says(text("empty.toml", ""), "is empty: it gives no key");
  says(text("comment.toml", "# title\n"), "is empty: it gives no key");
  says(text("slip.toml", "title = plate\n"), "slip.toml:1:9: not TOML");
  put(folder / "case.toml", head);
  says(text("summary.json", "{\"a\": 1}\n"), "the case of that run is " + (folder / "case.toml").string());
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

TEST(Path, SplitsIntoKeysAndIndices) {
  const auto steps = split_path("compare[12].when.\"structure.solver\"");
  ASSERT_EQ(steps.size(), 4u);
  EXPECT_EQ(steps[1].index, 12);
  EXPECT_EQ(steps[3].key, "structure.solver");
  for (const char* bad : {"", ".", "a..b", "a.", "a[", "a[x]", "[0]", "a b", "\"a", "a\"b\"", "a[0]b"})
    EXPECT_TRUE(split_path(bad).empty()) << bad;
  EXPECT_EQ(parent_and_name("a[0].\"b.c\""), (std::pair<std::string, std::string>{"a[0]", "b.c"}));
}

}  // namespace case_file_test
}  // namespace strake
