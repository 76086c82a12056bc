#include "coupler/run/surface_faces.hpp"

#include "proto/geometry/face_direction.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace strake {
namespace surface_faces_test {

using Eigen::Index;
using Eigen::MatrixXi;
using Eigen::Vector3d;
using Element = std::vector<int>;  // Gmsh's type, then nodes

/// A Gmsh file of format 2.2; node k is the k-th point, from 1 on.
std::string gmsh(const Points& node, const std::vector<Element>& elements) {
  std::string text = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", node.cols());
  for (Index i = 0; i < node.cols(); ++i)
    text += fmt::format("{} {} {} {}\n", i + 1, node(0, i), node(1, i), node(2, i));
  text += fmt::format("$EndNodes\n$Elements\n{}\n", elements.size());
  for (std::size_t e = 0; e < elements.size(); ++e)
    text += fmt::format("{} {} 2 0 1 {}\n", e + 1, elements[e][0],
                        fmt::join(elements[e].begin() + 1, elements[e].end(), " "));
  return text + "$EndElements\n";
}

InterfaceMesh mesh_of(const Points& position, int dimension) {
  InterfaceMesh mesh;
  mesh.dimension = dimension;
  mesh.position = position;
  return mesh;
}

Points square() {
  Points corners(3, 4);
  corners << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  return corners;
}

/// Corner k has the bits of k as coordinates.
Points cube() {
  Points corners(3, 8);
  for (int k = 0; k < 8; ++k) corners.col(k) << (k & 1), (k >> 1 & 1), (k >> 2 & 1);
  return corners;
}

/// The six sides, turned at random.
std::vector<Element> sides() {
  return {{3, 1, 2, 4, 3}, {3, 5, 6, 8, 7}, {3, 1, 2, 6, 5},
          {3, 3, 4, 8, 7}, {3, 1, 3, 7, 5}, {3, 2, 4, 8, 6}};
}

class SurfaceFaces : public testing::Test {
 protected:
  MatrixXi read(const Points& node, const std::vector<Element>& elements, const InterfaceMesh& mesh) {
    const auto file = folder_ / "surface.msh";
    put(file, gmsh(node, elements));
    return faces_from_file(file, mesh);
  }
  TemporaryFolder folder_;
};

TEST_F(SurfaceFaces, OfAnOutlineRunCounterClockwiseWhateverItsLinesDo) {
  Points shuffled(3, 4);  // the structure's own order
  shuffled << square().col(2), square().col(0), square().col(3), square().col(1);
  const MatrixXi faces = read(square(), {{1, 2, 1}, {1, 2, 3}, {1, 4, 3}, {1, 1, 4}}, mesh_of(shuffled, 2));
  ASSERT_EQ(faces.cols(), 4);
  double area = 0;
  for (Index f = 0; f < 4; ++f) {
    const Vector3d a = shuffled.col(faces(0, f)), b = shuffled.col(faces(1, f));
    EXPECT_EQ((a - b).norm(), 1);
    area += 0.5 * a.cross(b).z();
  }
  EXPECT_EQ(area, 1);
}

TEST_F(SurfaceFaces, OfACubeAreTwiceAsManyTrianglesThatEncloseIt) {
  const MatrixXi faces = read(cube(), sides(), mesh_of(cube(), 3));
  ASSERT_EQ(faces.cols(), 12);
  double volume = 0;
  for (Index f = 0; f < 12; ++f) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = cube().col(faces(k, f));
    volume += corners.determinant() / 6;
  }
  EXPECT_NEAR(volume, 1, 1e-14);
}

// Gmsh writes a side once for each of its physical groups.
TEST_F(SurfaceFaces, OfSidesInTwoGroupsCountOnce) {
  std::vector<Element> twice = sides();
  twice.push_back(twice[1]);
  twice.push_back(twice[4]);
  EXPECT_EQ(read(cube(), twice, mesh_of(cube(), 3)), read(cube(), sides(), mesh_of(cube(), 3)));
}

TEST_F(SurfaceFaces, OfAnOpenPieceTakeTheDirectionOfItsFirst) {
  const MatrixXi faces = read(square(), {{1, 2, 1}, {1, 2, 3}, {1, 4, 3}}, mesh_of(square(), 2));
  const MatrixXi expected = (MatrixXi(2, 3) << 1, 2, 3, 0, 1, 2).finished();  // 2→1, 3→2, 4→3
  EXPECT_EQ(faces, expected);
}

TEST_F(SurfaceFaces, AreRefusedWithTheLineThatIsWrong) {
  const auto refused = [&](const Points& node, const std::vector<Element>& elements, int dimension,
                           const std::string& why) {
    expect_refused([&] { read(node, elements, mesh_of(dimension == 2 ? square() : cube(), dimension)); },
                   why);
  };
  Points off = square();
  off(0, 1) += 1e-3;
  refused(off, {{1, 1, 2}}, 2, "node 2 at (1.001, 0, 0) m lies 0.001 m from the nearest point");
  refused(square(), {{3, 1, 2, 3, 4}}, 2, "holds no lines");
  refused(cube(), {{1, 1, 2}}, 3, "holds no triangles and no quadrilaterals");
  refused(square(), {{1, 1, 2}, {1, 2, 3}, {1, 2, 4}}, 2, "more than two lines meet at a point");
  std::vector<Element> with_inner = sides();
  with_inner.push_back({3, 1, 2, 8, 7});
  refused(cube(), with_inner, 3, "more than two faces meet at an edge");
  Points twice = square();
  twice.col(1) = twice.col(0);
  refused(twice, {{1, 1, 2}}, 2, "two corners of line 1 lie at one point");
  put(folder_ / "surface.stl", "solid");
  expect_refused([&] { faces_from_file(folder_ / "surface.stl", mesh_of(square(), 2)); },
                 "ends in .msh (Gmsh) or .inp (Abaqus)");
}

}  // namespace surface_faces_test
}  // namespace strake
