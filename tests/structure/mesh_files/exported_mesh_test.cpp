#include "proto/error.hpp"
#include "structure/mesh_files/mesh_file.hpp"
#include "tests/structure/mesh_files/two_cells.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

// Mesh files as Gmsh and Abaqus/CAE write them.

namespace strake::structure {
namespace exported_mesh_test {

class ExportedMesh : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("strake_export_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  Solid read(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return read_mesh(folder_ / name, 2, {});
  }
  std::string complaint(const std::string& name, const std::string& text) const {
    try {
      read(name, text);
    } catch (const Error& error) {
      return to_text(error);
    }
    return "";
  }
  std::filesystem::path folder_;
};

/// A line at x = 0 and the surface belong to those groups, whose number stands first.
std::string grouped(const std::string& line, const std::string& surface) {
  return two_cells("3\n1 7 \"clamp\"\n1 8 \"wet\"\n2 1 \"steel\"", line, surface);
}

/// A square as a part, and what stands between the parts and the end of the file.
std::string part(const std::string& name, const std::string& left) {
  return "*Part, name=" + name + "\n*Node\n1, " + left + ", 0.\n2, 1., 0.\n3, 1., 1.\n4, " + left +
         ", 1.\n*Element, type=CPE4\n1, 1, 2, 3, 4\n*End Part\n";
}

// Physical Curve("clamp") = {-4} has the tag -7 in format 4.1: the sign tells the orientation.
TEST_F(ExportedMesh, ATagWithTheSignOfItsEntityHasItsName) {
  const Solid solid = read("a.msh", grouped("1 -7", "1 -1"));
  EXPECT_EQ(solid.parts.front().name, "steel");
  ASSERT_EQ(solid.supported.size(), 1U);
  EXPECT_EQ(solid.supported.front().name, "clamp");
}

// Format 2.2 has a side once for each of its groups, 4.1 a list of them.
TEST_F(ExportedMesh, ASideBelongsToAllItsGroups) {
  const Solid solid = read("a.msh", grouped("2 7 8", "1 1"));
  ASSERT_EQ(solid.supported.size(), 2U);
  EXPECT_EQ(solid.supported[0].name, "clamp");
  EXPECT_EQ(solid.supported[1].name, "wet");
  EXPECT_EQ(solid.supported[0].facet, solid.supported[1].facet);
}

// It had the material of the group with the lowest number, and nothing said so.
TEST_F(ExportedMesh, ACellInTwoGroupsIsRefused) {
  const std::string found = complaint("a.msh", grouped("1 7", "2 1 9"));
  EXPECT_NE(found.find("a.msh:36"), std::string::npos) << found;
  EXPECT_NE(found.find("element 2 is in two groups, \"steel\" and \"9\""), std::string::npos) << found;
}

TEST_F(ExportedMesh, AByteOrderMarkIsPassedOver) {
  const std::string mark = "\xef\xbb\xbf";
  EXPECT_EQ(read("a.msh", mark + grouped("1 7", "1 1")).cell.cols(), 2);
  EXPECT_EQ(complaint("a.inp", mark + part("one", "0.")), "");
}

TEST_F(ExportedMesh, PartsAndInstancesThatWouldMixAreRefused) {
  const auto says = [&](const std::string& text, const std::string& wanted) {
    const std::string found = complaint("a.inp", text);
    EXPECT_NE(found.find(wanted), std::string::npos) << found;
    EXPECT_NE(found.find("a.inp:"), std::string::npos) << "the line: " << found;
  };
  EXPECT_EQ(complaint("a.inp", part("one", "0.")), "");
  says(part("one", "0.") + part("two", "0.5"), "node 1 is there twice, at two places");
  const auto instance = [](const std::string& data) {
    return part("one", "0.") + "*Assembly, name=A\n*Instance, name=one-1, part=one\n" + data +
           "*End Instance\n*End Assembly\n";
  };
  EXPECT_EQ(complaint("a.inp", instance("")), "");
  EXPECT_EQ(complaint("a.inp", instance("0., 0., 0.\n")), "");
  says(instance("10., 0., 0.\n"), "an instance that is moved or turned");
  says("*Node, System=C\n1, 1., 90.\n", "coordinates of a system of their own");
  says("*System\n1., 0., 0.\n" + part("one", "0."), "coordinates of a system of their own");
}

}  // namespace exported_mesh_test
}  // namespace strake::structure
