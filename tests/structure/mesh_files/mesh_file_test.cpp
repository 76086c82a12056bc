#include "structure/mesh_files/mesh_file.hpp"

#include "proto/error.hpp"
#include "structure/body/mass.hpp"
#include "tests/structure/mesh_files/two_cells.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

namespace strake::structure {
namespace mesh_file_test {

class MeshFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("strake_mesh_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  std::string complaint(const std::string& name, const std::string& text, int dimension = 2) const {
    try {
      read_mesh(file(name, text), dimension, {});
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::case_file);
      return error.where() + " | " + error.problem() + " | " + error.fix();
    }
    return "";
  }
  std::filesystem::path folder_;
};

std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

// Two quadrilaterals side by side, the second one walked clockwise; the left end has a name.
const std::string msh2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 7 "clamp"
2 1 "steel"
2 2 "rubber"
$EndPhysicalNames
$Nodes
7
1 0 0 0
2 1 0 0
3 2 0 0
4 0 1 0
5 1 1 0
6 2 1 0
9 5 5 0
$EndNodes
$Elements
3
1 1 2 7 4 4 1
2 3 2 1 1 1 2 5 4
3 3 2 2 2 2 5 6 3
$EndElements
)";

const std::string msh4 = two_cells("2\n1 7 \"clamp\"\n2 1 \"steel\"", "1 7", "1 1");

const std::string inp = R"(*HEADING
two cells
*NODE
1, 0., 0.
2, 1., 0.
3, 2., 0.
4, 0., 1.
5, 1., 1.
6, 2., 1.
*ELEMENT, TYPE=CPE4, ELSET=steel
1, 1, 2, 5, 4
2, 2, 3,
6, 5
** a comment
*NSET, NSET=clamp
1, 4
*NSET, NSET=lower, GENERATE
1, 3, 1
)";

TEST_F(MeshFile, GmshTwoHasPartsNamedFacesAndTurnsCellsOver) {
  const Solid solid = read_mesh(file("a.msh", msh2), 2, {.density = 1});
  EXPECT_EQ(solid.cell.cols(), 2);
  EXPECT_EQ(solid.node.cols(), 6) << "a node that no cell uses is left out";
  ASSERT_EQ(solid.parts.size(), 2U);
  EXPECT_EQ(solid.parts[1].name, "rubber");
  EXPECT_TRUE(fault_of(solid).problem.empty()) << fault_of(solid).problem;
  EXPECT_NEAR(mass_of(solid).mass, 2, 1e-15);
  const auto clamp = facets_named(solid, "clamp");
  ASSERT_EQ(clamp.size(), 1U);
  EXPECT_TRUE(on_facet(solid, clamp[0], {0, 0.3, 0}, 1e-9));
}

TEST_F(MeshFile, GmshFourTakesNamesFromItsEntities) {
  const Solid solid = read_mesh(file("a.msh", msh4), 2, {.density = 1});
  EXPECT_NEAR(mass_of(solid).mass, 2, 1e-15);
  EXPECT_EQ(solid.parts.at(0).name, "steel");
  EXPECT_EQ(facets_named(solid, "clamp").size(), 1U);
}

TEST_F(MeshFile, AbaqusHasElementSetsAndNodeSets) {
  const Solid solid = read_mesh(file("a.inp", inp), 2, {.density = 1});
  EXPECT_NEAR(mass_of(solid).mass, 2, 1e-15);
  EXPECT_EQ(solid.parts.at(0).name, "steel");
  EXPECT_EQ(facets_named(solid, "clamp").size(), 1U);
  EXPECT_EQ(facets_named(solid, "lower").size(), 2U);
}

// A set of all cells, or of those at a surface, takes no cell out of the part that the case names.
TEST_F(MeshFile, OfSeveralSetsOfAbaqusTheOneThatTheCaseNamesCounts) {
  const std::string sets =
      changed(inp, ", ELSET=steel", ", ELSET=all") +
      "*ELSET, ELSET=rubber\n1\n*ELSET, ELSET=steel\n2\n*ELSET, ELSET=wet, INTERNAL\n1, 2\n";
  const std::vector<std::string> names = {"steel", "rubber"};
  const Solid solid = read_mesh(file("a.inp", sets), 2, {.density = 1}, names);
  ASSERT_EQ(solid.parts.size(), 2U);
  EXPECT_EQ(solid.part(0).name, "rubber");
  EXPECT_EQ(solid.part(1).name, "steel");
  try {
    read_mesh(file("b.inp", sets + "*ELSET, ELSET=rubber, GENERATE\n1, 2\n"), 2, {.density = 1}, names);
    FAIL() << "a cell of two parts";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what())
                  .find("element 2 is in two sets that the case names as parts, \"steel\" and "
                        "\"rubber\": which material has it?"),
              std::string::npos)
        << error.what();
  }
}

// A line can name more numbers than there is memory, and end at the largest number there is.
TEST_F(MeshFile, AGeneratedSetOfAbaqusIsWhatTheMeshHasOfItsNumbers) {
  for (const char* line : {"1, 9223372036854775807", "1, 9223372036854775807, 1", "1, 3, 1"}) {
    const std::string text = changed(inp, "1, 3, 1", line) + "*ELSET, ELSET=rubber, GENERATE\n" + line + "\n";
    const Solid solid = read_mesh(file("a.inp", changed(text, ", ELSET=steel", "")), 2, {.density = 1});
    const bool all = std::string(line) != "1, 3, 1";
    EXPECT_EQ(facets_named(solid, "lower").size(), all ? 6U : 2U) << line;
    EXPECT_EQ(solid.parts.at(0).name, "rubber") << line;
  }
  const Solid every_second =
      read_mesh(file("b.inp", changed(inp, "1, 3, 1", "1, 9223372036854775807, 9223372036854775806")), 2,
                {.density = 1});
  EXPECT_TRUE(facets_named(every_second, "lower").empty());
  for (const char* line : {"-9223372036854775807, 9223372036854775807", "3, 1", "1, 3, 0"})
    EXPECT_NE(
        complaint("c.inp", changed(inp, "1, 3, 1", line)).find("c.inp:18 | expected FIRST, LAST[, STEP]"),
        std::string::npos)
        << line;
}

TEST_F(MeshFile, AHexahedronIsReadWithItsSides) {
  const Solid solid = read_mesh(file("h.inp", R"(*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 2
6, 1, 0, 2
7, 1, 1, 2
8, 0, 1, 2
*ELEMENT, TYPE=C3D8, ELSET=block
1, 5, 6, 7, 8, 1, 2, 3, 4
)"),
                                3, {.density = 3});
  EXPECT_TRUE(fault_of(solid).problem.empty()) << fault_of(solid).problem;
  EXPECT_NEAR(mass_of(solid).mass, 6, 1e-14);
  EXPECT_EQ(facets_named(solid, "front").size(), 1U);
}

TEST_F(MeshFile, WhatIsWrongIsNamedWithItsLine) {
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  says(complaint("a.stl", msh2), "ends in .msh (Gmsh) or .inp (Abaqus)");
  says(complaint("a.msh", "hello"), "no $MeshFormat");
  says(complaint("a.msh", changed(msh2, "2.2 0 8", "2.2 1 8")), "a.msh:2 | a binary mesh file");
  says(complaint("a.msh", changed(msh2, "2.2 0 8", "1 0 8")), "is not 2.2 or 4.1");
  says(complaint("a.msh", changed(msh2, "2 1 0 0", "2 1 zero 0")), "a.msh:13 | expected NUMBER X Y Z");
  EXPECT_EQ(complaint("a.msh", changed(msh2, "3 3 2 2 2 2 5 6 3", "3 2 2 2 2 2 5 6")), "")
      << "a triangle beside a quadrilateral";
  says(complaint("a.msh", changed(msh2, "3 3 2 2 2 2 5 6 3", "3 3 2 2 2 2 5 66 3")), "names node 66");
  says(complaint("a.msh", changed(msh2, "3 3 2 2 2 2 5 6 3", "3 16 2 2 2 2 5 6 3 1 1 1 1")), "ElementOrder");
  says(complaint("a.msh", changed(msh2, "6 2 1 0", "6 2 1 0.5")), "the plane z = 0");
  says(complaint("a.msh", changed(msh2, "1 1 2 7 4 4 1", "1 1 2 7 4 2 5")),
       "no side of a cell at the body's boundary");
  // A twisted cell has other sides than the file says: the cell is named, not the side.
  says(complaint("a.msh", changed(msh2, "2 3 2 1 1 1 2 5 4", "2 3 2 1 1 1 2 4 5")),
       "cell 1 of part \"steel\"");
  says(complaint("a.msh", msh2, 3), "has no tetrahedra or hexahedra");
  says(complaint("a.msh", changed(msh2, "$Elements\n3", "$Elements\n9")), "expected");
  says(complaint("a.inp", changed(inp, "TYPE=CPE4", "TYPE=CPE8")), "CPE8");
  says(complaint("a.inp", changed(inp, "1., 1.", "1., one")),
       "a.inp:8 | expected a number instead of \"one\"");
  const std::string last = std::to_string(std::numeric_limits<long>::max());
  says(complaint("n.inp", changed(changed(inp, "6, 2.", last + ", 2."), "\n6, 5", "\n" + last + ", 5")),
       "n.inp | has a node of number 9223372036854775807, the largest is 1000000000000000");
}

TEST_F(MeshFile, ACellThatIsTurnedInsideOutIsNamed) {
  std::string crossed = msh2;
  const std::string from = "2 3 2 1 1 1 2 5 4";
  crossed.replace(crossed.find(from), from.size(), "2 3 2 1 1 1 5 2 4");
  const SolidFault fault = fault_of(read_mesh(file("a.msh", crossed), 2, {}));
  EXPECT_NE(fault.problem.find("turned inside out"), std::string::npos) << fault.problem;
}

const std::string triangles = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 7 "clamp"
2 1 "steel"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 2 0 0
3 2 1 0
4 0 1 0
5 3 0.5 0
$EndNodes
$Elements
4
1 1 2 7 4 4 1
2 2 2 1 1 1 2 3
3 2 2 1 1 1 4 3
4 2 2 1 1 2 5 3
$EndElements
)";

TEST_F(MeshFile, TrianglesAreCutIntoQuadrilateralsOfTheSameBody) {
  const Solid solid = read_mesh(file("t.msh", triangles), 2, {.density = 10});
  EXPECT_EQ(solid.cell.cols(), 9);
  EXPECT_EQ(fault_of(solid).problem, "");
  const MassProperties mass = mass_of(solid);
  EXPECT_NEAR(mass.mass, 10 * 2.5, 1e-12);
  EXPECT_NEAR(mass.centre.x(), (2 * 1 + 0.5 * (2 + 1.0 / 3)) / 2.5, 1e-12);
  ASSERT_EQ(solid.supported.size(), 1u);
  EXPECT_EQ(solid.supported[0].facet.size(), 2u);  // the named side, in two
  EXPECT_EQ(solid.facet.cols(), 10);
}

TEST_F(MeshFile, TetrahedraAndPrismsAreCutIntoHexahedraOfTheSameBody) {
  const std::string head =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 7 \"foot\"\n$EndPhysicalNames\n";
  const std::string tetrahedra =
      head +
      "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n"
      "$Elements\n3\n1 2 2 7 1 1 2 3\n2 4 2 1 1 1 2 3 4\n3 4 2 1 1 2 4 3 5\n$EndElements\n";
  const Solid pair = read_mesh(file("tets.msh", tetrahedra), 3, {.density = 6});
  EXPECT_EQ(pair.cell.cols(), 8);
  EXPECT_EQ(fault_of(pair).problem, "");
  EXPECT_NEAR(mass_of(pair).mass, 1 + 2, 1e-12);
  EXPECT_EQ(pair.facet.cols(), 6 * 3);  // six outer triangles, three sides each
  ASSERT_EQ(pair.supported.size(), 1u);
  EXPECT_EQ(pair.supported[0].facet.size(), 3u);
  const std::string prism = head +
                            "$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 2\n5 1 0 2\n6 0 1 2\n$EndNodes\n"
                            "$Elements\n2\n1 2 2 7 1 1 2 3\n2 6 2 1 1 1 2 3 4 5 6\n$EndElements\n";
  const Solid wedge = read_mesh(file("prism.msh", prism), 3, {.density = 6});
  EXPECT_EQ(wedge.cell.cols(), 6);
  EXPECT_EQ(fault_of(wedge).problem, "");
  EXPECT_NEAR(mass_of(wedge).mass, 6, 1e-12);
  EXPECT_NE(complaint("pyramid.msh",
                      head + "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n$EndNodes\n"
                             "$Elements\n1\n1 7 2 1 1 1 2 3 4 5\n$EndElements\n",
                      3)
                .find("a pyramid"),
            std::string::npos);
}

/// A sheet of n × n quadrilaterals of the side 1/n with nodes of its own, moved by `move`, as elements of the
/// physical group `group`; numbers of nodes and elements begin after `before`.
void add_sheet(int n, double move, int group, std::string& nodes, std::string& elements, int& before) {
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      nodes += fmt::format("{} {} {} 0\n", before + j * (n + 1) + i + 1, move + i / double(n), j / double(n));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = before + j * (n + 1) + i + 1;
      elements += fmt::format("{} 3 2 {} 1 {} {} {} {}\n", before + j * n + i + 1, group, a, a + 1, a + n + 2,
                              a + n + 1);
    }
  before += (n + 1) * (n + 1);
}

std::string sheets(int n, double move) {
  std::string nodes, elements;
  int before = 0;
  add_sheet(n, 0, 1, nodes, elements, before);
  add_sheet(n, move, 2, nodes, elements, before);
  return fmt::format(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n{}$EndNodes\n$Elements\n{}\n{}"
      "$EndElements\n",
      before, nodes, 2 * n * n, elements);
}

/// A block of n³ hexahedra of the side 1/n whose inner nodes are moved by up to `shake` sides along each
/// axis.
std::string shaken_block(int n, double shake) {
  std::string nodes, elements;
  const auto number = [n](int i, int j, int k) { return (k * (n + 1) + j) * (n + 1) + i + 1; };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const int m = number(i, j, k);
        nodes += fmt::format("{} {} {} {}\n", m, (i + shake * std::sin(7.0 * m)) / n,
                             (j + shake * std::sin(11.0 * m)) / n, (k + shake * std::sin(13.0 * m)) / n);
      }
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        elements += fmt::format("{} 5 2 1 1", (k * n + j) * n + i + 1);
        for (const int up : {k, k + 1})
          elements += fmt::format(" {} {} {} {}", number(i, j, up), number(i + 1, j, up),
                                  number(i + 1, j + 1, up), number(i, j + 1, up));
        elements += "\n";
      }
  return fmt::format(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n{}$EndNodes\n$Elements\n{}\n{}$EndElements\n",
      (n + 1) * (n + 1) * (n + 1), nodes, n * n * n, elements);
}

// Their sides are bent: the planes through them divide neighbours, but not cells that share an edge alone.
TEST_F(MeshFile, BentCellsSideBySideDoNotLieOverOneAnother) {
  for (const double shake : {0.0, 0.1, 0.2})
    EXPECT_EQ(complaint("b.msh", shaken_block(6, shake), 3), "") << shake;
}

TEST_F(MeshFile, CellsOverOneAnotherAreRefused) {
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  // A part that was meshed twice: the nodes are equal, but not merged.
  says(complaint("a.msh", sheets(4, 0)), "element 26 lies over element 1 (line 59), at (0.125, 0.125, 0)");
  says(complaint("a.msh", sheets(4, 0)), "cells that reach into another: 32");
  // Another mesh of the same place, moved by less than a cell; its first column is over the first sheet.
  says(complaint("a.msh", sheets(4, 0.8)), "lies over element 4");
  // By two fifths and a fifth of a cell: no middle lies in another cell, and the nodes lie on sides.
  says(complaint("a.msh", sheets(4, 0.9)), "lies over element 4");
  says(complaint("a.msh", sheets(4, 0.95)), "cells that reach into another: 8");
  EXPECT_EQ(complaint("a.msh", sheets(4, 1)), "") << "side by side";
  EXPECT_EQ(complaint("a.msh", sheets(4, 1 - 1e-9)), "") << "nodes that miss one another by a rounding";
  // One element in two physical groups, as Gmsh writes it in format 2.2.
  says(complaint("a.msh", changed(msh2, "3 3 2 2 2 2 5 6 3", "2 3 2 1 1 1 2 5 4")),
       "element 2 is there twice");
  // Triangles and tetrahedra are compared as they are cut.
  says(complaint("t.msh", changed(triangles, "4 2 2 1 1 2 5 3", "4 2 2 1 1 1 2 3")),
       "element 4 lies over element 2");
  const std::string tets =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n"
      "6 0.1 0.1 1\n$EndNodes\n$Elements\n2\n2 4 2 1 1 1 2 3 4\n3 4 2 1 1 ";
  EXPECT_EQ(complaint("t.msh", tets + "2 4 3 5\n$EndElements\n", 3), "");
  says(complaint("t.msh", tets + "1 2 3 6\n$EndElements\n", 3), "element 3 lies over element 2");
}

}  // namespace mesh_file_test
}  // namespace strake::structure
