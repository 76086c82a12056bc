// Ship sections from a table of offsets: structure.offsets and structure.station.
#include "proto/case/case_file.hpp"
#include "proto/error.hpp"
#include "structure/body/mass.hpp"
#include "structure/case/read_parameters.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace strake::structure {
namespace offset_keys_test {

const std::string table = R"(# two frames
station [m],height [m],half_breadth [m]
10,0,0
10,0.05,0.15
10,0.25,0.25
20,0,0.1
20,0.2,0.1
20,0.2,0.3
20,0.3,0.3
)";

class Offsets : public testing::Test {
 protected:
  Parameters read(const std::string& rows, const std::string& keys) const {
    const std::filesystem::path path = folder_ / "hull.csv";
    std::ofstream(path) << rows;
    CaseFile file = CaseFile::parse(
        "end_time = 0.5\n[fluid]\nspacing = 0.02\n[structure]\nsolver = \"rigid\"\nmaterial.density = 1000\n"
        "offsets = \"" +
            path.string() + "\"\n" + keys,
        "case.toml");
    Parameters p = structure::read(file, "rigid");
    file.refuse_unknown("structure");
    return p;
  }
  void refuses(const std::string& rows, const std::string& keys, const std::string& words) const {
    try {
      read(rows, keys);
      ADD_FAILURE() << "accepted, expected: " << words;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::case_file);
      EXPECT_NE(to_text(error).find(words), std::string::npos) << to_text(error);
      EXPECT_NE(to_text(error).find("fix:"), std::string::npos) << to_text(error);
    }
  }
  TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_.path();
};

TEST_F(Offsets, ATableWithoutRowsIsSaidToHaveNone) {
  refuses("station [m],height [m],half_breadth [m]\n", "station = 10\n", "holds no rows");
}

TEST_F(Offsets, ASectionIsMirroredAndClosedByADeck) {
  const Parameters p = read(table, "station = 10\n");
  EXPECT_EQ(p.shape.corner.size(), 5u);  // the keel is one corner
  const MassProperties mass = mass_of(p);
  EXPECT_NEAR(mass.mass, 1000 * (0.05 * 0.15 + 0.2 * (0.15 + 0.25)), 1e-10);
  EXPECT_NEAR(mass.centre.x(), 0, 1e-15);
  EXPECT_EQ(read(table, "station = 20\n").shape.corner.size(), 8u);
}

TEST_F(Offsets, ASectionIsScaledHeeledAndMoved) {
  const MassProperties upright = mass_of(read(table, "station = 20\n")),
                       placed = mass_of(
                           read(table, "station = 20\nplaced = { scale = 2, angle = 90, move = [1, 3] }\n"));
  EXPECT_NEAR(placed.mass, 4 * upright.mass, 1e-9);
  EXPECT_NEAR(placed.centre.x(), 1 - 2 * upright.centre.y(), 1e-12);
  EXPECT_NEAR(placed.centre.y(), 3, 1e-12);
}

TEST_F(Offsets, BrokenTablesAreRefusedWithTheRow) {
  refuses(table, "station = 15\n", "10, 20 m");
  refuses(table, "", "10, 20 m");
  refuses(table + "30,0,0\n30,0.2,0.1\n", "station = 30\n", "station 30 m has 2 points");
  refuses(table + "30,0,0\n30,0.2,0.1\n30,0.1,0.2\n", "station = 30\n", "row 10: the height 0.1 m");
  refuses(table + "30,0,0\n30,0.2,-0.1\n", "station = 30\n", "row 9: the half breadth is -0.1 m");
  refuses(table + "30,0,0\n30,0.2,0\n30,0.3,0.2\n30,0.5,0.2\n", "station = 30\n",
          "the half breadth at the height 0.2 m is 0");
  refuses("station [m],height [mm],half_breadth [m]\n1,0,0\n", "", "column height is in [mm]");
  refuses("station [m],height [m]\n1,0\n", "", "no column half_breadth [m]");
}

}  // namespace offset_keys_test
}  // namespace strake::structure
