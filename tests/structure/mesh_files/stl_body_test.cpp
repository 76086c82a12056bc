// Bodies from STL files: cubes, and every fault that a file may have.
#include "structure/mesh_files/stl_body.hpp"

#include "proto/error.hpp"
#include "proto/mesh_files/stl.hpp"
#include "structure/body/mass.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>

namespace strake::structure {
namespace stl_body_test {

using Eigen::Vector3d;
using Facet = std::array<Vector3d, 3>;
using Facets = std::vector<Facet>;

/// The twelve triangles of a box, their normals outside.
Facets box(const Vector3d& min, const Vector3d& max) {
  const std::array<std::array<int, 4>, 6> sides = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  const auto at = [&](int corner) {
    return Vector3d(corner & 1 ? max.x() : min.x(), corner & 2 ? max.y() : min.y(),
                    corner & 4 ? max.z() : min.z());
  };
  Facets facets;
  for (const auto& [a, b, c, d] : sides) {
    facets.push_back({at(a), at(b), at(c)});
    facets.push_back({at(a), at(c), at(d)});
  }
  return facets;
}

Facets turned(Facets facets) {
  for (Facet& facet : facets) std::swap(facet[1], facet[2]);
  return facets;
}

Facets operator+(Facets one, const Facets& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

std::string text(const Facets& facets) {
  std::string all = "solid body of a test\n";
  for (const Facet& facet : facets) {
    all += "  facet normal 0 0 0\n    outer loop\n";
    for (const Vector3d& x : facet) all += fmt::format("      vertex {:e} {:e} {:e}\n", x.x(), x.y(), x.z());
    all += "    endloop\n  endfacet\n";
  }
  return all + "endsolid body of a test\n";
}

std::string binary(const Facets& facets) {
  std::string bytes(80, 's');
  const auto add = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(static_cast<std::uint32_t>(facets.size()));
  for (const Facet& facet : facets) {
    for (int k = 0; k < 3; ++k) add(0.0F);
    for (const Vector3d& x : facet)
      for (int axis = 0; axis < 3; ++axis) add(static_cast<float>(x[axis]));
    add(std::uint16_t{0});
  }
  return bytes;
}

class Stl : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("strake_stl_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  ClosedSurface read(const std::string& bytes) const {
    std::ofstream(folder_ / "body.STL", std::ios::binary) << bytes;
    return read_stl_body(folder_ / "body.STL");
  }
  /// Expects an error with the file's name, these words and a remedy.
  void refuses(const std::string& bytes, const std::string& words) const {
    try {
      read(bytes);
      ADD_FAILURE() << "accepted, expected: " << words;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::case_file);
      EXPECT_NE(error.where().find("body.STL"), std::string::npos) << error.where();
      EXPECT_NE((error.where() + ": " + error.problem()).find(words), std::string::npos) << to_text(error);
      EXPECT_FALSE(error.fix().empty()) << to_text(error);
    }
  }
  std::filesystem::path folder_;
};

const Facets cube = box({1, 0, 0}, {3, 2, 2});

bool tells(const ClosedSurface& surface, const std::string& words) {
  for (const std::string& line : surface.lines)
    if (line.find(words) != std::string::npos) return true;
  return false;
}

/// Each edge of a closed interface has two triangles of opposite direction.
void expect_closed(const InterfaceMesh& mesh) {
  std::map<std::pair<int, int>, int> sides;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f)
    for (Eigen::Index k = 0; k < 3; ++k) ++sides[{mesh.faces(k, f), mesh.faces((k + 1) % 3, f)}];
  for (const auto& [side, count] : sides) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(sides.contains({side.second, side.first}));
  }
}

TEST_F(Stl, ABoxHasItsMassAsTextAndAsBinary) {
  const Facets facets = box({1, 0, -1}, {1.5, 2, 3});
  for (const std::string& bytes : {text(facets), binary(facets)}) {
    const ClosedSurface body = read(bytes);
    EXPECT_EQ(body.point.cols(), 8);
    EXPECT_EQ(body.outer, 12);
    EXPECT_DOUBLE_EQ(volume_of(body), 4);
    const MassProperties mass = mass_of(body, 500);
    EXPECT_NEAR(mass.mass, 2000, 1e-9);
    EXPECT_LT((mass.centre - Vector3d(1.25, 1, 1)).norm(), 1e-13);
    const Vector3d inertia = 2000.0 / 12 * Vector3d(4 + 16, 0.25 + 16, 0.25 + 4);
    EXPECT_LT((mass.inertia - Eigen::Matrix3d(inertia.asDiagonal())).norm(), 1e-9);
  }
}

TEST_F(Stl, ATextWithAByteOrderMarkIsReadAsText) {
  EXPECT_DOUBLE_EQ(volume_of(read("\xef\xbb\xbf" + text(cube))), 8);
}

TEST_F(Stl, ABinaryFileThatBeginsWithSolidIsReadAsBinary) {
  std::string bytes = binary(cube);
  bytes.replace(0, 5, "solid");
  EXPECT_DOUBLE_EQ(volume_of(read(bytes)), 8);
}

TEST_F(Stl, NearCornersAreMergedAndToldSo) {
  Facets facets = cube;
  facets[3][1] += Vector3d(1e-6, 0, -1e-6);
  facets.push_back({Vector3d(1, 0, 0), Vector3d(1, 0, 1e-7), Vector3d(3, 0, 0)});  // no area
  const ClosedSurface body = read(text(facets));
  EXPECT_EQ(body.point.cols(), 8);
  EXPECT_NEAR(volume_of(body), 8, 1e-4);
  EXPECT_TRUE(tells(body, "2 corners within 2e-06"));
  EXPECT_TRUE(tells(body, "1 triangles without area"));
}

TEST_F(Stl, ABodyFarFromTheOriginKeepsItsVolume) {
  const Vector3d away(1e9, -1e9, 1e9);  // seven digits of the text: corners move by up to 500
  const ClosedSurface body = read(text(box(away, away + Vector3d(4e5, 2e5, 1e5))));
  EXPECT_NEAR(volume_of(body), 8e15, 1e-2 * 8e15);
}

TEST_F(Stl, PiecesAreTurnedOutAndHollowsIn) {
  EXPECT_DOUBLE_EQ(volume_of(read(text(turned(cube)))), 8);
  EXPECT_TRUE(tells(read(text(turned(cube))), "1 of 1 pieces"));
  const Facets hollow = box({1.5, 0.5, 0.5}, {2.5, 1.5, 1.5}), beside = box({5, 0, 0}, {6, 1, 1});
  for (const Facets& inner : {hollow, turned(hollow)}) {
    const ClosedSurface body = read(binary(inner + cube + beside));
    EXPECT_DOUBLE_EQ(volume_of(body), 8 - 1 + 1);
    EXPECT_EQ(body.outer, 24);
    EXPECT_DOUBLE_EQ(outer_area(body), 24 + 6);
    EXPECT_TRUE(tells(body, "3 separate pieces, 1 of them hollows"));
    EXPECT_FALSE(is_inside(body, {2, 1, 1}, 1e-6));
    EXPECT_TRUE(is_inside(body, {1.25, 1, 1}, 1e-6));
    EXPECT_TRUE(is_inside(body, {3, 2, 2}, 1e-6));
    EXPECT_FALSE(is_inside(body, {4, 1, 1}, 1e-6));
    EXPECT_EQ(refined_surface(body, 10).position.cols(), 16);
  }
}

TEST_F(Stl, LongEdgesAreHalvedUntilPointsAreASpacingApart) {
  const ClosedSurface body = read(text(cube));
  const InterfaceMesh mesh = refined_surface(body, 0.25);
  EXPECT_EQ(mesh.position.cols(), 6 * 8 * 8 + 2);  // the points of squares of 0.25
  expect_closed(mesh);
  const Facets sliver = box({0, 0, 0}, {10, 0.01, 1});
  const ClosedSurface plank = read(text(sliver));
  const InterfaceMesh fine = refined_surface(plank, 0.3);
  expect_closed(fine);
  double longest = 0;
  for (Eigen::Index f = 0; f < fine.faces.cols(); ++f)
    for (Eigen::Index k = 0; k < 3; ++k)
      longest = std::max(
          longest,
          (fine.position.col(fine.faces(k, f)) - fine.position.col(fine.faces((k + 1) % 3, f))).norm());
  EXPECT_LE(longest, 0.45);
  EXPECT_GT(longest, 0.2);
  EXPECT_LT(fine.position.cols(), refined_count(plank, 0.3));
  EXPECT_GT(3 * fine.position.cols(), refined_count(plank, 0.3));
}

TEST_F(Stl, BrokenFilesAreRefusedWithThePlace) {
  const std::string whole = text(cube), bytes = binary(cube);
  refuses(bytes.substr(0, bytes.size() - 7), "has 684 bytes, this one has 677: it is cut off");
  refuses(bytes + "more", "has 684 bytes, this one has 688");
  refuses(bytes.substr(0, 60), "60 bytes");
  refuses(binary({}), "no triangles");
  refuses("solid\nendsolid\n", "no triangles");
  refuses(whole.substr(0, whole.find("vertex") + 3), "body.STL:4: expected \"vertex\"");
  refuses(whole.substr(0, whole.rfind("endsolid")), "the file ends here, expected \"facet\" or \"endsolid\"");
  std::string broken = whole;
  broken.replace(whole.find("endloop"), 7, "vertex ");
  refuses(broken, "body.STL:7: expected \"endloop\", found \"vertex\"");
  broken = whole;
  broken.replace(whole.find("e+00"), 4, "e+xx");
  refuses(broken, "body.STL:4: expected a number");
  Facets odd = cube;
  odd[4][1].y() = std::numeric_limits<double>::quiet_NaN();
  refuses(binary(odd), "triangle 5 has a corner that is not finite");
  std::string huge = bytes;
  const std::uint32_t many = 3'000'000;
  huge.replace(80, 4, reinterpret_cast<const char*>(&many), 4);
  huge.resize(84 + 50 * std::size_t{many}, '\0');
  refuses(huge, "3000000 triangles, at most 2000000 are read");
}

TEST_F(Stl, SurfacesThatBoundNoBodyAreRefusedWithThePlace) {
  refuses(text(Facets(cube.begin(), cube.end() - 2)),
          "the surface is not closed, edges with one triangle alone: 4; the first from (3, 2, 0) to (3, 0, "
          "0), triangle 2");
  refuses(text(cube + box({3, 0, 0}, {4, 2, 2})), "edges with more than two triangles");
  Facets mixed = cube;
  std::swap(mixed[7][1], mixed[7][2]);
  refuses(text(mixed), "two triangles are turned against one another: 3; the first from");
  Facets flat = cube;
  flat.push_back({Vector3d(1, 0, 0), Vector3d(2, 0, 0), Vector3d(3, 0, 0)});
  refuses(text(flat), "triangle 13 has no area: its corners (1, 0, 0), (2, 0, 0) and (3, 0, 0)");
  refuses(text({Facet{Vector3d(1, 1, 1), Vector3d(1, 1, 1), Vector3d(1, 1, 1)}}),
          "all corners lie at (1, 1, 1)");
  Facets far = cube;
  far[0][0].x() = 1e300;
  refuses(text(far), "the body is 1e+300 long");
  const Facets sheet = {cube[0]};
  refuses(text(sheet + turned(sheet)), "encloses no volume");
  refuses(text(box({0, -1, -1}, {4, 3, 3}) + cube + box({1.5, 0.5, 0.5}, {2.5, 1.5, 1.5})),
          "lies inside 2 others");
}

/// The triangles of a ball of n rings and 2 n meridians.
Facets ball(const Vector3d& centre, double radius, int n) {
  const double step = std::numbers::pi / n;
  const auto at = [&](int ring, int meridian) {
    const double theta = ring * step, phi = meridian % (2 * n) * step, r = ring == n ? 0 : std::sin(theta);
    return Vector3d(centre + radius * Vector3d(r * std::cos(phi), r * std::sin(phi), std::cos(theta)));
  };
  Facets facets;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      if (i < n - 1) facets.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      if (i > 0) facets.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return facets;
}

TEST_F(Stl, ASurfaceThatCutsItselfIsRefusedWithThePlace) {
  refuses(text(cube + box({2.5, 0.5, 0.5}, {4, 1.5, 1.5})), "the surface cuts itself: ");
  refuses(text(cube + box({1.5, 1.5, 1}, {2, 3, 1.5})),
          "pairs of triangles; the first, 7 and 13, at (1.5, 2, 1)");
  refuses(binary(ball({0, 0, 0}, 1, 40) + ball({1.9, 0, 0}, 1, 40)), "the surface cuts itself");
  Facets pulled = cube;  // one corner of a single piece through the opposite face
  for (Facet& facet : pulled)
    for (Vector3d& X : facet)
      if (X == Vector3d(3, 2, 2)) X = Vector3d(0.5, 0.5, 0.5);
  refuses(text(pulled), "the surface cuts itself");
}

TEST_F(Stl, PiecesThatTouchOrLieNearAreRead) {
  EXPECT_DOUBLE_EQ(volume_of(read(text(cube + box({3, 0.5, 0.5}, {4, 1.5, 1.5})))), 9);
  EXPECT_DOUBLE_EQ(volume_of(read(text(cube + box({1.5, 2, 1}, {2.5, 3, 1.5})))), 8.5);
  EXPECT_NEAR(volume_of(read(binary(ball({0, 0, 0}, 1, 40) + ball({2.001, 0, 0}, 1, 40)))),
              8 * std::numbers::pi / 3, 0.04);
}

}  // namespace stl_body_test
}  // namespace strake::structure
