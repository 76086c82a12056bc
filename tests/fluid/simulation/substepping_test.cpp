#include "fluid/mps/interface_load.hpp"
#include "fluid/scheme/acoustic_substepping.hpp"
#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"
#include "tests/fluid/same_state.hpp"
#include "tests/fluid/vortex.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

namespace strake::fluid {
namespace {

constexpr double spacing = 0.01;  // [m]

// Number of steps of a window that begin a frozen configuration, out of so many equal steps.
int beginnings(int steps, double dt, double longest, double fastest, std::int64_t number = 0,
               double contact_gap = std::numeric_limits<double>::infinity()) {
  AcousticSubstepping hold;
  int count = 0;
  for (int k = 0; k < steps; ++k) {
    hold.step(dt, (steps - 1 - k) * dt, longest, number + k);
    count += hold.begins() ? 1 : 0;
    hold.ends(fastest, 0, contact_gap, spacing);
  }
  EXPECT_TRUE(hold.is_over());
  return count;
}

TEST(AcousticSubstepping, LastsAWindowOrAsLongAsStepsMayLast) {
  EXPECT_EQ(beginnings(5, 2e-6, 1, 0), 1);
  EXPECT_EQ(beginnings(5, 2e-6, 0, 0), 5);
  EXPECT_EQ(beginnings(5, 2e-6, 2e-6, 0), 5);
  EXPECT_EQ(beginnings(5, 2e-6, 4e-6, 0), 3);
}

TEST(AcousticSubstepping, EndsBeforeAnythingMovesTooFar) {
  const double way = AcousticSubstepping::largest_displacement * spacing;
  EXPECT_EQ(beginnings(5, 2e-6, 1, 0.19 * way / 2e-6), 1);
  EXPECT_EQ(beginnings(5, 2e-6, 1, 0.26 * way / 2e-6), 2);
  EXPECT_EQ(beginnings(5, 2e-6, 1, 0.51 * way / 2e-6), 5);
  // The next face to become wet is nearer than that.
  EXPECT_EQ(beginnings(5, 2e-6, 1, 0.19 * way / 2e-6, 0, 0.5 * way), 3);
  EXPECT_EQ(beginnings(5, 2e-6, 1, 0.19 * way / 2e-6, 0, 0), 5);
  EXPECT_EQ(beginnings(5, 2e-6, 1, std::numeric_limits<double>::quiet_NaN()), 5);
}

TEST(AcousticSubstepping, EndsWhereTheParticlesAreSorted) {
  EXPECT_EQ(beginnings(5, 2e-6, 1, 0, reorder_interval - 2), 2);
  EXPECT_EQ(beginnings(5, 2e-6, 1, 0, reorder_interval - 5), 1);
}

/// A small plate that strikes a small tank, in windows of so many steps. held: the steps share a frozen
/// configuration.
struct Entry {
  static constexpr double speed = 6, gap = 0.0002;
  Simulation<2> simulation;
  InterfaceMotion motion;
  double dt;
  int in_window, taken = 0;
  bool held;

  static Parameters parameters(double sound = 1500) {
    Parameters p = tank_case(0.4, 0.15, spacing, 0.2);
    p.sound_speed = sound;
    return p;
  }
  static InterfaceMesh body() { return rectangle(-0.1, gap, 0.2, 0.02, spacing); }
  Entry(const Parameters& p, double step, int steps, bool holds, const InterfaceMesh& mesh = body())
      : simulation(p, mesh, PlateEntry::down(mesh, speed)), dt(step), in_window(steps), held(holds) {
    const auto m = simulation.interface().position.cols();
    motion = {Points::Zero(3, m), Points::Zero(3, m), Points::Zero(3, m)};
    motion.velocity.row(1).setConstant(-speed);
  }
  void windows(int count) {
    for (int k = 0; k < count * in_window; ++k) {
      const int to_come = in_window - 1 - taken++ % in_window;
      motion.displacement.row(1).setConstant(-speed * (simulation.state().time + dt));
      simulation.step(dt, motion, held ? to_come * dt : 0);
    }
  }
  double load() const { return simulation.interface_force().row(1).sum(); }
};

TEST(AcousticSubstepping, StepsThatFollowNoSoundAreTakenOneByOne) {
  for (const auto& [sound, dt] : {std::pair(std::numeric_limits<double>::infinity(), 2e-6), {1500.0, 1e-5}}) {
    Entry together(Entry::parameters(sound), dt, 5, true), alone(Entry::parameters(sound), dt, 5, false);
    together.windows(6);
    alone.windows(6);
    EXPECT_EQ(differences(together.simulation.state(), alone.simulation.state()), "") << sound;
  }
}

TEST(AcousticSubstepping, OtherSchemesTakeEveryStepByItself) {
  Parameters p = Entry::parameters();
  p.scheme = with_gradient(p.scheme, Gradient::min_pressure);
  Entry together(p, 2e-6, 5, true), alone(p, 2e-6, 5, false);
  together.windows(6);
  alone.windows(6);
  EXPECT_EQ(differences(together.simulation.state(), alone.simulation.state()), "");
}

/// A circular cylinder, its lowest point at the height `low`.
InterfaceMesh cylinder(double radius, double low) {
  InterfaceMesh mesh =
      rectangle(0, 0, 0.5 * std::numbers::pi * radius, 0.5 * std::numbers::pi * radius, spacing);
  const auto n = mesh.position.cols();
  for (Eigen::Index k = 0; k < n; ++k) {
    const double angle = 2 * std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(n);
    mesh.position.col(k) << radius * std::cos(angle), low + radius * (1 + std::sin(angle)), 0;
  }
  return mesh;
}

// In windows of fifty steps, in which the cylinder moves by 0.06 l0. Its faces become wet one after another;
// together, at the end of a group, they would be a blow.
TEST(AcousticSubstepping, ARoundBodyMeetsTheWaterAsInStepsTakenOneByOne) {
  for (const double low : {0.0008, 0.0011}) {
    std::vector<double> impulse[2];
    for (const bool held : {true, false}) {
      Entry entry(Entry::parameters(), 2e-6, 50, held, cylinder(0.05, low));
      for (int k = 0; k < 6; ++k) {
        entry.windows(1);
        impulse[held].push_back(entry.simulation.state().impulse_on_bodies.y());
      }
    }
    fmt::print("cylinder {:.1f} mm above the water: impulse {:.3f} N s held, {:.3f} by single steps\n",
               1e3 * low, fmt::join(impulse[1], ", "), fmt::join(impulse[0], ", "));
    ASSERT_GT(impulse[0][2], 1);  // from the third window on
    for (std::size_t k = 2; k < impulse[0].size(); ++k)
      EXPECT_NEAR(impulse[1][k] / impulse[0][k], 1, 0.03) << "window " << k;
  }
}

// Contact is seen where a window begins: the loads of an impact are compared from the contact on.
TEST(AcousticSubstepping, ImpactIsThatOfStepsTakenOneByOne) {
  const auto impulses = [](bool held) {
    Entry entry(Entry::parameters(), 2e-6, 5, held);
    std::vector<double> impulse{0};
    double hardest = 0;
    for (int k = 0; k < 60; ++k) {
      entry.windows(1);
      const double now = entry.simulation.state().impulse_on_bodies.y();
      if (now > 1) impulse.push_back(now);
      hardest = std::max(hardest, entry.load());
    }
    EXPECT_EQ(entry.simulation.state().penetrations, 0);
    const double mass = 1000 * spacing * spacing;
    EXPECT_LT(momentum_gap(entry.simulation.state(), mass).norm(), 0.03 * impulse.back());
    return std::pair(impulse[40], hardest);
  };
  const auto [together, hard_together] = impulses(true);
  const auto [alone, hard_alone] = impulses(false);
  fmt::print("impact: impulse {:.2f} N s held, {:.2f} by single steps; largest load {:.5g} and {:.5g} N\n",
             together, alone, hard_together, hard_alone);
  EXPECT_NEAR(together / alone, 1, 0.01);
  EXPECT_NEAR(hard_together / hard_alone, 1, 0.01);
}

TEST(AcousticSubstepping, GoingBackToAWindowsBeginGivesTheSameBitsWithAnyNumberOfThreads) {
  Entry entry(Entry::parameters(), 2e-6, 5, true);
  entry.windows(14);
  const State<2> saved = entry.simulation.state();
  entry.windows(14);
  const State<2> first = entry.simulation.state();
  ASSERT_GT(first.pressure.maxCoeff(), 1e6);  // the plate has struck
  entry.simulation.set_state(saved);
  entry.windows(14);
  EXPECT_EQ(differences(first, entry.simulation.state()), "");
  // From the middle of a hold as well, as after a fault.
  entry.simulation.set_state(saved);
  entry.in_window = 14 * 5;
  entry.taken = 0;
  entry.simulation.step(2e-6, entry.motion, 8e-6);
  entry.simulation.set_state(saved);
  entry.in_window = 5;
  entry.windows(14);
  EXPECT_EQ(differences(first, entry.simulation.state()), "");
  Parameters p = Entry::parameters();
  p.threads = 2;
  Entry other(p, 2e-6, 5, true);
  other.simulation.set_state(saved);
  other.windows(14);
  EXPECT_EQ(differences(first, other.simulation.state()), "");
}

// Effect of the places of turning water on ∇·u in two steps of 0.02 l0 each. If the first step of a frozen
// configuration corrected all of it, the pressure would fluctuate with the frozen configurations.
TEST(AcousticSubstepping, TurningWaterFeelsNoPressureThatComesAndGoesWithTheHolds) {
  const auto turning = [](bool held) {
    constexpr double dt = 1e-4;
    constexpr int in_window = 5, steps = 400;
    Parameters p = tank_case(0.3, 0.3, spacing, 0.1);
    p.sound_speed = 30;
    Simulation<2> simulation(p, {}, {});
    State<2> start = simulation.state();
    const std::int64_t water = set_turning(start);
    simulation.set_state(start);
    const State<2>& state = simulation.state();
    Eigen::VectorXd before = Eigen::VectorXd::Zero(water), last = before, now = before;
    double rough = 0, energy = 0;
    for (int k = 0; k < steps; ++k) {
      simulation.step(dt, {}, held ? (in_window - 1 - k % in_window) * dt : 0);
      for (std::int64_t i = 0; i < water; ++i) now[state.id[static_cast<std::size_t>(i)]] = state.pressure[i];
      if (k >= steps / 2) rough += (now - 2 * last + before).squaredNorm();
      before = last;
      last = now;
    }
    for (std::int64_t i = 0; i < water; ++i) energy += state.velocity.col(i).squaredNorm();
    return std::pair(std::sqrt(rough / (0.5 * steps * static_cast<double>(water))), energy);
  };
  const auto [rough_together, energy_together] = turning(true);
  const auto [rough_alone, energy_alone] = turning(false);
  fmt::print(
      "turning water: second difference of p from step to step {:.2f} Pa held, {:.2f} by single steps; "
      "energy {:+.2f} %\n",
      rough_together, rough_alone, 100 * (energy_together / energy_alone - 1));
  EXPECT_LT(rough_together, 1.5 * rough_alone);
  EXPECT_NEAR(energy_together / energy_alone, 1, 0.01);
}

}  // namespace
}  // namespace strake::fluid
