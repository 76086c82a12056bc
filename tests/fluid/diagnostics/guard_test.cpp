#include "fluid/diagnostics/guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace strake::fluid {
namespace guard_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The two faces of a wedge, its apex `depth` under the still level, in pieces of a spacing.
std::vector<FacePiece> wedge(double degrees, double speed, double half_width, double spacing, double depth) {
  const double slope = std::tan(degrees * std::numbers::pi / 180), length = std::hypot(1, slope);
  std::vector<FacePiece> pieces;
  for (double x = 0.5 * spacing / length; x < half_width; x += spacing / length)
    for (const double side : {-1.0, 1.0})
      pieces.push_back({.at = {side * x, slope * x - depth, 0},
                        .normal = {side * slope / length, -1 / length, 0},
                        .velocity = {0, -speed, 0},
                        .area = spacing,
                        .pressure = 1e4,
                        .wet = true});
  return pieces;
}

GuardScales water() {
  return {.sound_speed = 1500, .spacing = 0.008, .top = 0, .drop = 0.4, .half_width = 0.25, .enters = true};
}

Extreme value(double of, double step = 2e-6) {
  return {.value = of, .at = {0.1, 0.2, 0}, .time = 0.005, .step = step};
}

TEST(Guard, BoundsTheJetOfAWedgeByWagner) {
  Guard guard(water());
  for (const double degrees : {15.0, 30.0, 45.0}) {
    GuardRecord record;
    guard.faces(record, wedge(degrees, 5, 0.25, 0.008, 0.1));
    const double jet = std::numbers::pi * 5 / std::tan(degrees * std::numbers::pi / 180);
    EXPECT_NEAR(record.jet, jet, 1e-9 * jet) << degrees;
    EXPECT_NEAR(guard.speed_bound(record), 1.3 * jet, 1e-9 * jet) << "no gravity";
  }
}

TEST(Guard, BoundsTheJetOfALevelFaceByThePressureOfSound) {
  EXPECT_NEAR(Guard(water()).jet(6, 0), 2 * std::sqrt(2 * 1500.0 * 6), 1e-9);
  GuardScales incompressible = water();
  incompressible.sound_speed = infinity;
  EXPECT_NEAR(Guard(incompressible).jet(6, 0), std::numbers::pi * 6 / (0.5 * 0.008 / 0.25), 1e-9)
      << "particles show no slope below l0/2 over a";
  EXPECT_EQ(Guard(water()).jet(-1, 0.5), 0) << "a face that recedes throws nothing";
}

TEST(Guard, TakesABodyWithoutFacesForLevel) {
  const Guard guard(water());
  GuardRecord record;
  guard.body(record, 6);
  EXPECT_EQ(record.jet, guard.jet(6, 0));
  EXPECT_EQ(record.normal_speed, 6);
}

TEST(Guard, BoundsWaterUnderGravityByTheFrontOfADamBreakAndTheWallItMeets) {
  GuardScales dam = {.gravity = 9.81, .drop = 0.6};
  EXPECT_NEAR(Guard(dam).speed_bound({}), 1.3 * std::numbers::pi * 2 * std::sqrt(9.81 * 0.6), 1e-9);
  dam.drop = infinity;  // gravity along a direction that repeats itself
  GuardRecord record;
  Guard(dam).extremes(record, {.speed = value(1e6), .pressure = {}});
  EXPECT_FALSE(record.raised(Alarm::speed));
}

TEST(Guard, CountsTheSpeedThatTheWaterStartsWith) {
  const Guard drop({.water_speed = 2});
  EXPECT_NEAR(drop.speed_bound({}), 1.3 * std::numbers::pi * 2, 1e-9);
  EXPECT_NEAR(Guard({.half_width = 0.25, .water_speed = 2}).pressure_bound({}, 1e-3), 1.3 * 1000 * 250 * 2,
              1e-6);
}

TEST(Guard, BoundsPressureByWhatSoundOrTheStepCarriesAway) {
  Guard guard(water());
  GuardRecord record;
  guard.faces(record, wedge(0, 6, 0.25, 0.008, 0.1));
  const double speed = 3 * std::numbers::pi + 0.1 * guard.jet(6, 0);
  EXPECT_NEAR(guard.pressure_bound(record, 2e-6), 1.3 * 1000 * 1500 * speed, 1);
  EXPECT_NEAR(guard.pressure_bound(record, 1e-3), 1.3 * 1000 * 250 * speed, 1) << "a/Δt = 250 m/s";
  GuardScales tank = water();
  tank.half_width = 0;
  EXPECT_EQ(Guard(tank).pressure_bound(record, 2e-6), 0) << "unknown without a body";
}

TEST(Guard, RaisesEachAlarmOnceWithItsFirstPlaceAndTime) {
  Guard guard(water());
  GuardRecord record;
  guard.faces(record, wedge(30, 5, 0.25, 0.008, 0.1));
  guard.extremes(record, {.speed = value(20), .pressure = value(1e6)});
  EXPECT_FALSE(record.raised(Alarm::speed));
  EXPECT_NEAR(record.speed_share, 20 / guard.speed_bound(record), 1e-12);
  guard.extremes(record, {.speed = value(50), .pressure = value(1e6)});
  guard.extremes(record, {.speed = value(70), .pressure = value(1e6)});
  ASSERT_TRUE(record.raised(Alarm::speed));
  EXPECT_FALSE(record.raised(Alarm::pressure));
  std::map<std::string, double> monitor;
  guard.report(record, monitor);
  EXPECT_EQ(monitor.at("alarm.speed.value"), 50);
  EXPECT_EQ(monitor.at("alarm.speed.time"), 0.005);
  EXPECT_EQ(monitor.at("alarm.speed.y"), 0.2);
  EXPECT_EQ(monitor.at("alarm.speed.step"), 2e-6);
  EXPECT_GT(monitor.at("check.largest_speed"), 1);
  EXPECT_FALSE(monitor.contains("alarm.pressure.time"));
}

TEST(Guard, ComparesMomentumVolumeAndHollows) {
  const Guard guard(water());
  GuardRecord record;
  guard.momentum(record, 0.1, 0.06);
  guard.volume(record, 0.1, -0.03);
  guard.hollow(record, 0.1, 0.01);
  for (const Alarm kind : {Alarm::momentum, Alarm::volume, Alarm::hollow}) EXPECT_FALSE(record.raised(kind));
  guard.momentum(record, 0.2, 0.12);
  guard.volume(record, 0.2, -0.06);
  guard.hollow(record, 0.2, 0.03);
  for (const Alarm kind : {Alarm::momentum, Alarm::volume, Alarm::hollow}) EXPECT_TRUE(record.raised(kind));
  std::map<std::string, double> monitor;
  guard.report(record, monitor);
  EXPECT_FALSE(monitor.contains("alarm.volume.x")) << "it has no place";
}

TEST(Guard, MissesTheWaterOfAFaceThatAdvancesWithoutIt) {
  Guard guard(water());
  GuardRecord record;
  std::vector<FacePiece> dry = wedge(30, 5, 0.25, 0.008, 0.1);
  for (FacePiece& piece : dry) piece.wet = false;
  const double dt = 5e-3;  // 22 mm along the normal of a face
  guard.water_on_faces(record, 0.005, dt, dry);
  guard.water_on_faces(record, 0.010, dt, dry);
  EXPECT_FALSE(record.raised(Alarm::dry)) << "less than a quarter of the half width of 250 mm";
  guard.water_on_faces(record, 0.015, dt, wedge(30, 5, 0.25, 0.008, 0.1));
  EXPECT_EQ(record.dry_since, -1) << "the water is there again";
  for (int k = 4; k < 8; ++k) guard.water_on_faces(record, k * dt, dt, dry);
  EXPECT_TRUE(record.raised(Alarm::dry));
  GuardRecord other;
  for (FacePiece& piece : dry) piece.velocity *= -1;
  for (int k = 1; k < 20; ++k) guard.water_on_faces(other, k * dt, dt, dry);
  EXPECT_FALSE(other.raised(Alarm::dry)) << "a face that recedes is dry by right";
}

/// A body at rest half a metre under water, whose faces carry that share of the water's weight.
std::vector<FacePiece> resting(double share) {
  std::vector<FacePiece> pieces;
  for (int k = 0; k < 10; ++k)
    pieces.push_back({.at = {0.01 * k, -0.5, 0},
                      .normal = {0, -1, 0},
                      .velocity = {0, 0, 0},
                      .area = 0.01,
                      .pressure = share * 1000 * 9.81 * 0.5,
                      .wet = true});
  return pieces;
}

TEST(Guard, MissesTheWeightOfTheWaterOnABodyThatBeginsInIt) {
  GuardScales scales = {.sound_speed = infinity,
                        .spacing = 0.01,
                        .gravity = 9.81,
                        .top = 0,
                        .drop = 1,
                        .half_width = 0.1,
                        .submerged = true};
  const Guard guard(scales);
  GuardRecord whole, light;
  for (int k = 1; k < 4; ++k) {
    guard.water_on_faces(whole, k * 1e-3, 1e-3, resting(0.5));
    guard.water_on_faces(light, k * 1e-3, 1e-3, resting(0.03));
  }
  EXPECT_FALSE(whole.raised(Alarm::dry));
  EXPECT_TRUE(light.raised(Alarm::dry));
  guard.water_on_faces(whole, 4e-3, 1e-3, resting(0));
  guard.water_on_faces(whole, 6e-3, 2e-3, resting(0));
  EXPECT_FALSE(whole.raised(Alarm::dry)) << "a body that has felt the water may leave it";
  EXPECT_NEAR(light.alarm(4, static_cast<int>(Alarm::dry)), 0.03, 1e-12);
  // The foot of a plate on the tank's floor has no room for water.
  GuardRecord foot;
  std::vector<FacePiece> dry_foot = resting(0);
  for (FacePiece& piece : dry_foot) piece.on_wall = true;
  for (int k = 1; k < 4; ++k) guard.water_on_faces(foot, k * 1e-3, 1e-3, dry_foot);
  EXPECT_FALSE(foot.raised(Alarm::dry));
  // Sound needs 4 H/c = 2.7 ms to bring the weight; and gravity that grows is waited for.
  scales.sound_speed = 1500;
  GuardRecord soon, late, ramped;
  Guard(scales).water_on_faces(soon, 2e-3, 2e-3, resting(0));
  EXPECT_FALSE(soon.raised(Alarm::dry));
  Guard(scales).water_on_faces(late, 4e-3, 4e-3, resting(0));
  EXPECT_TRUE(late.raised(Alarm::dry));
  scales.gravity_ramp = 0.1;
  Guard(scales).water_on_faces(ramped, 0.05, 0.05, resting(0));
  EXPECT_FALSE(ramped.raised(Alarm::dry));
}

TEST(Guard, SaysNothingOfAPressureThatIsNotMeasured) {
  GuardScales volume = water();
  volume.has_faces = false;
  std::map<std::string, double> with, without;
  Guard(water()).report({}, with);
  Guard(volume).report({}, without);
  EXPECT_TRUE(with.contains("check.largest_pressure"));
  EXPECT_FALSE(without.contains("check.largest_pressure"));
}

TEST(Guard, IsReadBackFromAnArchive) {
  Guard guard(water());
  GuardRecord written;
  guard.faces(written, wedge(30, 5, 0.25, 0.008, 0.1));
  guard.extremes(written, {.speed = value(50), .pressure = value(1e6)});
  Archive archive;
  save(written, archive);
  const GuardRecord read = load_guard(archive);
  EXPECT_EQ(read.alarm, written.alarm);
  EXPECT_EQ(read.jet, written.jet);
  EXPECT_EQ(read.speed_share, written.speed_share);
  EXPECT_FALSE(load_guard({}).raised(Alarm::speed)) << "a checkpoint of a version without a guard";
}

/// What the cases of newcomers gave with the commit before issue 24: largest speed [m/s], and pressure on a
/// piece of face [Pa] (0: not recorded), at steps of 2e-6 s, and at the steps of the flow.
struct NewcomersRun {
  const char* name;
  double deadrise, speed, spacing, half_width;  // [°], [m/s], [m]
  double water, pressure, step;                 // [m/s], [Pa], [s]
  bool alarm;
};

TEST(Guard, TripsOnTheRunsOfNewcomersThatWereWrong) {
  for (const NewcomersRun& run : {
           NewcomersRun{"wedge of 15 degrees", 15, 5, 0.008, 0.25, 93.7, 1.008e7, 2e-6, true},
           NewcomersRun{"wedge of 30 degrees", 30, 5, 0.008, 0.25, 38.9, 3.8e6, 2e-6, true},
           NewcomersRun{"wedge_entry at 25 degrees, 10 mm", 25, 6, 0.01, 0.25, 286, 2.02e7, 2e-6, true},
           NewcomersRun{"wedge_entry at 25 degrees, 12.5 mm", 25, 6, 0.0125, 0.25, 78.2, 1.24e7, 2e-6, true},
           NewcomersRun{"V section of 15 degrees, fem", 15, 5, 0.01, 0.3, 490, 4.28e8, 2e-6, true},
           NewcomersRun{"V section of 15 degrees, rigid", 15, 5, 0.01, 0.3, 189, 0, 2e-6, true},
           NewcomersRun{"wedge of 15 degrees, steps of the flow", 15, 5, 0.008, 0.25, 46.6, 2.4e6, 1e-5,
                        false},
           NewcomersRun{"wedge of 30 degrees, steps of the flow", 30, 5, 0.008, 0.25, 19.0, 1.76e6, 1e-5,
                        false},
       }) {
    GuardScales scales = water();
    scales.spacing = run.spacing;
    scales.half_width = run.half_width;
    Guard guard(scales);
    GuardRecord record;
    guard.faces(record, wedge(run.deadrise, run.speed, run.half_width, run.spacing, 0.01));
    guard.extremes(record, {.speed = value(run.water, run.step), .pressure = value(run.pressure, run.step)});
    EXPECT_EQ(record.raised(Alarm::speed) || record.raised(Alarm::pressure), run.alarm) << run.name;
  }
}

}  // namespace guard_test
}  // namespace strake::fluid
