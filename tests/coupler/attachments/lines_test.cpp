// Springs and catenaries against their closed forms.

#include "coupler/attachments/catenary.hpp"
#include "coupler/attachments/local_attachment.hpp"
#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <tuple>
#include <unistd.h>

namespace strake {
namespace lines_test {

using Eigen::MatrixXd;
using Eigen::Vector3d;

CatenaryParameters chain(double stiffness, bool bottom) {
  CatenaryParameters p;
  p.anchor = {{0, 0, 0}};
  p.length = 100;
  p.weight = 50;
  p.axial_stiffness = stiffness;
  p.bottom = bottom;
  return p;
}

TEST(Catenary, OfALineThatRestsInPartIsTheClosedForm) {
  const double w = 50, L = 100, EA = 1e8;
  for (const double H : {1e-3, 1.0, 100.0, 2000.0, 1e5})
    for (const double V : {50.0, 1500.0, 4500.0, 4999.0}) {
      const double x = L - V / w + H / w * std::asinh(V / H) + H * L / EA;
      const double z = V * V / (H + std::hypot(H, V)) / w + V * V / (2 * EA * w);
      const CatenaryForce force = catenary(chain(EA, true), x, z);
      EXPECT_NEAR(force.horizontal, H, 1e-6 * std::hypot(H, V)) << H << " " << V;
      EXPECT_NEAR(force.vertical, V, 1e-6 * std::hypot(H, V));
      EXPECT_NEAR(force.resting, L - V / w, 1e-6 * L);
    }
}

TEST(Catenary, OfALineThatHangsFreeIsTheClosedForm) {
  const double w = 50, L = 100, EA = 1e8;
  for (const double H : {1.0, 100.0, 2000.0, 1e5, 1e7})
    for (const double V : {-4000.0, 0.0, 100.0, 2500.0, 5000.0, 2e4, 1e6}) {
      const double x = H / w * (std::asinh(V / H) - std::asinh((V - w * L) / H)) + H * L / EA;
      const double z = (std::hypot(H, V) - std::hypot(H, V - w * L)) / w + (V * L - w * L * L / 2) / EA;
      const CatenaryForce force = catenary(chain(EA, false), x, z);
      EXPECT_NEAR(force.horizontal, H, 1e-5 * std::hypot(H, V)) << H << " " << V;
      EXPECT_NEAR(force.vertical, V, 1e-5 * std::hypot(H, V));
      EXPECT_EQ(force.resting, 0);
    }
}

TEST(Catenary, LimitsAreASlackLineAVerticalOneAndAStraightOne) {
  // A heap on the bottom: the part that hangs weighs w z.
  const CatenaryForce heap = catenary(chain(1e12, true), 10, 30);
  EXPECT_EQ(heap.horizontal, 0);
  EXPECT_NEAR(heap.vertical, 50 * 30, 1e-4);
  EXPECT_NEAR(heap.resting, 70, 1e-5);
  // Straight down and stretched: z = L + (V L − w L²/2)/EA.
  const CatenaryForce taut = catenary(chain(1e6, false), 0, 101);
  EXPECT_EQ(taut.horizontal, 0);
  EXPECT_NEAR(taut.vertical, 1e6 / 100 + 50 * 100 / 2.0, 1e-3);
  // Far out the stretch alone counts: T = EA (distance − L)/L.
  CatenaryParameters light = chain(1e8, false);
  light.weight = 1e-6;
  const CatenaryForce straight = catenary(light, 60, 90);
  EXPECT_NEAR(std::hypot(straight.horizontal, straight.vertical), 1e8 * (std::hypot(60, 90) - 100) / 100, 50);
  EXPECT_NEAR(straight.vertical / straight.horizontal, 1.5, 1e-6);
}

TEST(Catenary, ShapeGoesFromTheAnchorToTheUpperEndWithTheLinesLength) {
  for (const auto& [bottom, x, z] : {std::tuple{true, 80.0, 30.0}, std::tuple{false, 60.0, -20.0}}) {
    const Eigen::Matrix2Xd shape = catenary_shape(chain(1e12, bottom), x, z, 400);
    EXPECT_NEAR(shape.col(0).norm(), 0, 1e-8);
    EXPECT_NEAR((shape.col(399) - Eigen::Vector2d(x, z)).norm(), 0, 1e-12);
    EXPECT_NEAR((shape.rightCols(399) - shape.leftCols(399)).colwise().norm().sum(), 100, 2e-3);
    EXPECT_LT((shape.rightCols(399) - shape.leftCols(399)).colwise().norm().maxCoeff(), 0.26) << "no jump";
  }
}

TEST(Catenary, PullsTowardsTheAnchorAndAlongGravity) {
  CatenaryParameters p = chain(1e8, true);
  p.anchor = {{3, 5, -20}};
  p.down = {0, 0, -1};
  const CatenaryLaw law(p);
  const LineForce line = law.at(0, {3 + 60, 5 - 80, 10}, {0, 0, 0});
  EXPECT_NEAR(line.force.x() / line.force.y(), -60.0 / 80, 1e-12);
  EXPECT_LT(line.force.x(), 0);
  EXPECT_LT(line.force.z(), 0);
  EXPECT_NEAR(line.tension, line.force.norm(), 1e-12);
}

TEST(Spring, PullsPressesAndDampsAlongItsLine) {
  SpringParameters p{.anchor = {{0, 0, 0}}, .stiffness = 10, .damping = 2, .length = {3}, .slack = false};
  const LineForce pulled = SpringLaw(p).at(0, {5, 0, 0}, {0.5, 7, 0});
  EXPECT_NEAR(pulled.tension, 10 * 2 + 2 * 0.5, 1e-14);
  EXPECT_NEAR((pulled.force - Vector3d(-21, 0, 0)).norm(), 0, 1e-13);
  EXPECT_NEAR(SpringLaw(p).at(0, {0, 2, 0}, {0, 0, 0}).force.y(), 10, 1e-14);
  EXPECT_EQ(SpringLaw(p).at(0, {0, 0, 0}, {1, 1, 1}).force.norm(), 0) << "no line, no force";
  p.slack = true;
  EXPECT_EQ(SpringLaw(p).at(0, {0, 2, 0}, {0, 0, 0}).force.norm(), 0);
  EXPECT_EQ(SpringLaw(p).at(0, {3.1, 0, 0}, {-5, 0, 0}).tension, 0) << "a rope does not press";
  p.slack = false;
  p.length = {0};
  EXPECT_NEAR((SpringLaw(p).at(0, {1, 2, 0}, {1, 0, 0}).force - Vector3d(-12, -20, 0)).norm(), 0, 1e-14);
}

TEST(LocalAttachment, TakesTheMeanOfBothEndsAndGoesOnFromACheckpoint) {
  SpringParameters p{.anchor = {{0, 0, 0}}, .stiffness = 10, .damping = 0, .length = {0}, .slack = false};
  InterfaceMesh mesh{"line", 2, Points::Zero(3, 1), {}, {}};
  const auto made = [&] {
    return LocalAttachment("line", mesh, {MatrixXd(MatrixXd::Zero(3, 1)), MatrixXd(MatrixXd::Zero(3, 1))},
                           std::make_unique<SpringLaw>(p));
  };
  LocalAttachment line = made();
  const auto at = [](double y) {
    MatrixXd u = MatrixXd::Zero(3, 1);
    u(1, 0) = y;
    return Input{{{1.0, {{"displacement", "m", false, u}, {"velocity", "m/s", false, MatrixXd::Zero(3, 1)}}}},
                 false};
  };
  EXPECT_EQ(line.advance({0, 1}, at(0.4)).output[0].value(1, 0), -2);
  line.rewind();
  EXPECT_EQ(line.advance({0, 1}, at(0.2)).output[0].value(1, 0), -1);
  line.commit(false);
  const auto folder = std::filesystem::temp_directory_path() / ("strake_line_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  line.checkpoint(folder);
  LocalAttachment again = made();
  again.resume(folder);
  EXPECT_EQ(again.advance({1, 1}, at(0.6)).output[0].value(1, 0), -4);
  p.anchor.push_back({1, 0, 0});
  p.length.push_back(0);
  mesh.position = Points::Zero(3, 2);
  LocalAttachment other("line", mesh, {MatrixXd(MatrixXd::Zero(3, 2)), MatrixXd(MatrixXd::Zero(3, 2))},
                        std::make_unique<SpringLaw>(p));
  EXPECT_THROW(other.resume(folder), Error);
  std::filesystem::remove_all(folder);
}

}  // namespace lines_test
}  // namespace strake
