#pragma once

#include <string>

namespace strake::structure {

/// Two quadrilaterals side by side in Gmsh's format 4.1, with a line at x = 0. names: the lines of
/// $PhysicalNames. line, surface: the groups of the two entities, their number first.
inline std::string two_cells(const std::string& names, const std::string& line, const std::string& surface) {
  return R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
)" + names +
         R"(
$EndPhysicalNames
$Entities
0 1 1 0
4 0 0 0 0 1 0 )" +
         line + " 0\n1 0 0 0 2 1 0 " + surface + R"( 0
$EndEntities
$Nodes
1 6 1 6
2 1 0 6
1
2
3
4
5
6
0 0 0
1 0 0
2 0 0
0 1 0
1 1 0
2 1 0
$EndNodes
$Elements
2 3 1 3
1 4 1 1
1 4 1
2 1 3 2
2 1 2 5 4
3 2 3 6 5
$EndElements
)";
}

}  // namespace strake::structure
