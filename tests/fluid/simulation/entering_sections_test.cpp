#include "structure/body/surface.hpp"
#include "tests/fluid/plate_case.hpp"

#include <Eigen/Geometry>
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace strake::fluid {
namespace entering_sections_test {

using Places = std::vector<Eigen::Vector2d>;

constexpr double l0 = 0.02, speed = 4, dt = 2e-4, R = 0.15;

/// Force upwards [N/m] on a section that is driven into still water at 4 m/s, after each step. Its lowest
/// point starts 0.6 l0 over the water, and stands beside the lattice's symmetry.
std::vector<double> forces(Places corner, int steps) {
  for (auto& x : corner) x += Eigen::Vector2d(0.23 * l0, 0.6 * l0);
  const InterfaceMesh body = structure::outline(corner, l0);
  const Parameters p = tank_case(1.6, 0.6, l0, 0.5);
  Simulation<2> simulation(p, body, PlateEntry::down(body, speed));
  const auto m = simulation.interface().position.cols();
  InterfaceMotion motion{Points::Zero(3, m), PlateEntry::down(simulation.interface(), speed),
                         Points::Zero(3, m)};
  std::vector<double> out;
  for (int step = 1; step <= steps; ++step) {
    motion.displacement.row(1).setConstant(-speed * step * dt);
    simulation.step(dt, motion);
    out.push_back(simulation.interface_force().row(1).sum());
  }
  return out;
}

/// How the force scatters about its running mean of 2 ms, from that step on.
struct Scatter {
  double rms;    // over the mean
  double least;  // force of a step over its running mean
};
Scatter scatter_of(const std::vector<double>& force, std::size_t from) {
  double sum = 0, squares = 0, least = 1;
  int count = 0;
  for (std::size_t k = from; k + 5 < force.size(); ++k, ++count) {
    double mean = 0;
    for (std::size_t i = k - 5; i <= k + 5; ++i) mean += force[i] / 11;
    sum += mean;
    squares += (force[k] - mean) * (force[k] - mean);
    least = std::min(least, force[k] / mean);
  }
  return {std::sqrt(squares / count) / (sum / count), least};
}

/// The same of a section that is driven for that many steps, printed with its name.
Scatter scatter_of(const char* section, const Places& corner, int steps, std::size_t from) {
  const Scatter found = scatter_of(forces(corner, steps), from);
  fmt::print("{}: scatter {:.3f} of the mean, least {:.2f}\n", section, found.rms, found.least);
  return found;
}

Places arc(double from, double to) {
  Places out;
  for (double angle = from; angle < to + 1; angle += 5)
    out.emplace_back(R * std::cos(angle / 180 * std::numbers::pi),
                     R + R * std::sin(angle / 180 * std::numbers::pi));
  return out;
}

// Pieces of the bent edge were left out where pairs of water and layers were looked for: half a cylinder had
// 72 % of the whole one's impulse.
TEST(EnteringSections, ARoundBottomUnderADeckHasTheForceOfAWholeCylinder) {
  Places half = arc(180, 360);
  half.emplace_back(R, R + 0.1);
  half.emplace_back(-R, R + 0.1);
  const int steps = 50;  // to 40 mm below the level
  double of_half = 0, of_whole = 0;
  for (const double force : forces(half, steps)) of_half += force * dt;
  for (const double force : forces(arc(0, 355), steps)) of_whole += force * dt;
  fmt::print("impulse of half a cylinder {:.1f} N s/m, of a whole one {:.1f}\n", of_half, of_whole);
  EXPECT_GT(of_whole, 50);
  EXPECT_NEAR(of_half / of_whole, 1, 0.04);
}

// Where faces ended at the knuckles of 29 and 14 degrees, water met one face and left the other in a few
// steps, and the force rose and fell by half of its mean.
TEST(EnteringSections, WaterPassesTheKnucklesOfABowWithoutBlows) {
  Places bow = {{0, 0}, {0.06, 0.017}, {0.1, 0.057}, {0.13, 0.107}, {0.2, 0.177}, {0.2, 0.227}};
  for (std::size_t k = bow.size() - 1; k > 0; --k) bow.emplace_back(-bow[k].x(), bow[k].y());
  const auto [rms, least] = scatter_of("bow", bow, 125, 30);
  EXPECT_LT(rms, 0.2);
  EXPECT_GT(least, 0.4);
}

// Water that passes a chine is near the side beyond, and flies away from it. The side met each such particle,
// and let it go again a spacing away: the force rose and fell by a sixth of its mean.
TEST(EnteringSections, WaterLeavesTheChinesOfAFlaredVWithoutBlows) {
  const Places flared = {{0, 0}, {R, 0.0546}, {R + 0.0437, 0.1746}, {-R - 0.0437, 0.1746}, {-R, 0.0546}};
  const auto [rms, least] = scatter_of("V of 20 degrees, sides of 70", flared, 170, 70);
  EXPECT_LT(rms, 0.12);
  EXPECT_GT(least, 0.6);
}

// As corners, the chines let go of the water in one step, and the lower one was taken for a keel: water clung
// to the sides, and the force rose and fell by a third of its mean and more.
TEST(EnteringSections, WaterLeavesTheFlaredSidesOfAFlatBottomThatHeels) {
  const Eigen::Rotation2Dd heel(4 / 180.0 * std::numbers::pi);
  Places flared = {{R, 0}, {R + 0.0693, 0.12}, {-R - 0.0693, 0.12}, {-R, 0}};
  for (auto& x : flared) x = heel * x + Eigen::Vector2d(0, R * std::sin(heel.angle()));
  const auto [rms, least] = scatter_of("flat bottom with flared sides, heeled", flared, 160, 80);
  EXPECT_LT(rms, 0.12);
  EXPECT_GT(least, 0.6);
}

// A heeled V is crossed by the water. As a corner its keel ended both faces there: 0.083 of the mean, least
// 0.67.
TEST(EnteringSections, WaterCrossesTheKeelOfAVThatHeelsWithoutBlows) {
  const Eigen::Rotation2Dd heel(12 / 180.0 * std::numbers::pi);
  Places vee = {{0, 0}, {R, 0.0546}, {R, 0.1746}, {-R, 0.1746}, {-R, 0.0546}};
  for (auto& x : vee) x = heel * x;
  const auto [rms, least] = scatter_of("V of 20 degrees, heeled by 12", vee, 200, 90);
  EXPECT_LT(rms, 0.065);
  EXPECT_GT(least, 0.75);
}

}  // namespace entering_sections_test
}  // namespace strake::fluid
