#include "fluid/simulation/simulation.hpp"
#include "structure/body/shape.hpp"
#include "structure/body/surface.hpp"
#include "tests/fluid/plate_case.hpp"
#include "tests/fluid/solid_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <vector>

// What an observer who turns, moves, or looks over a seam must find the same.

namespace strake::fluid {
namespace invariance_test {

constexpr auto absent = MotionColumn::absent;

/// Water around a body in a tank that has been turned by an angle about the origin, gravity with it.
struct TurnedTank {
  Eigen::VectorXd pressure;  // by State::id

  TurnedTank(Parameters p, const InterfaceMesh& body, double angle) {
    p.end_time = 2;
    p.scheme.pressure_tolerance = 1e-10;
    const auto turn_of = [&](double t) { return angle * t * t * (3 - 2 * t); };  // a cubic: exact as a spline
    std::vector<double> time, turn;
    for (int k = 0; k <= 10; ++k) {
      time.push_back(0.1 * k);
      turn.push_back(turn_of(time.back()));
    }
    p.motion.table = MotionTable(time, {absent, absent, absent, MotionColumn::place}, {{{}, {}, {}, turn}});
    const Simulation<2> start(p, body, Points::Zero(3, body.position.cols()));
    State<2> state = start.state();
    const Eigen::Matrix2d R = Eigen::Rotation2Dd(angle).toRotationMatrix();
    p.gravity.head<2>() = R * p.gravity.head<2>();
    Simulation<2> turned(p, body, Points::Zero(3, body.position.cols()));
    const Points& reference = turned.interface().position;
    const Points zero = Points::Zero(3, reference.cols());
    InterfaceMotion motion{zero, zero, zero};
    motion.displacement.topRows<2>() = R * reference.topRows<2>() - reference.topRows<2>();
    state.time = 1;  // where the table ends its turn, and rests
    state.step = 1;
    state.position = (R * state.position).eval();
    state.interface_displacement = motion.displacement.topRows<2>();
    turned.set_state(state);
    for (int k = 0; k < 2; ++k) turned.step(1e-3, motion);
    pressure.setZero(std::count(state.kind.begin(), state.kind.end(), Kind::fluid));
    for (Eigen::Index i = 0; i < pressure.size(); ++i)
      pressure[turned.state().id[static_cast<std::size_t>(i)]] = turned.state().pressure[i];
  }
};

TEST(Invariance, WaterAroundABodyFeelsNoTurnOfTankBodyAndGravityTogether) {
  Parameters p = tank_case(0.6, 0.3, 0.01, 0.2);
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.submerged = true;
  const InterfaceMesh body =
      structure::outline(structure::circle_polygon({0, -0.15}, 0.07, p.spacing), p.spacing);
  const TurnedTank upright(p, body, 0);
  EXPECT_GT(upright.pressure.maxCoeff(), 2800);
  for (const double angle : {0.2, 0.5 * std::numbers::pi, std::numbers::pi})
    EXPECT_LT((TurnedTank(p, body, angle).pressure - upright.pressure).cwiseAbs().maxCoeff(), 1e-3) << angle;
}

/// The pressure on the lower face of a plate that strikes the water, from row to row along z. It reaches from
/// seam to seam.
std::vector<double> along_seams(int steps) {
  constexpr double l0 = 0.02, length = 0.32, dt = 1e-5;
  Parameters p = basin(0.6, 0.2, l0, 0.2);
  p.tank.min.z() = p.water.min.z() = -0.5 * length;
  p.tank.max.z() = p.water.max.z() = 0.5 * length;
  p.periodic[2] = true;
  const InterfaceMesh plate = box_surface({0, 0, 0}, {0.2, 0.08, length}, l0);
  const auto m = plate.position.cols();
  InterfaceMotion motion{Points::Zero(3, m), Points::Zero(3, m), Points::Zero(3, m)};
  motion.velocity.row(1).setConstant(-1);
  Simulation<3> simulation(p, plate, motion.velocity);
  for (int k = 1; k <= steps; ++k) {
    motion.displacement.row(1).setConstant(-k * dt);
    simulation.step(dt, motion);
  }
  std::map<long, double> load;
  for (const FacePiece& piece : simulation.face_pieces())
    if (piece.normal.y() < -0.9) load[std::lround(piece.at.z() / l0 - 0.5)] += piece.pressure;
  std::vector<double> rows;
  for (const auto& [row, pressure] : load) rows.push_back(pressure);
  return rows;
}

TEST(Invariance, APlateFromSeamToSeamHasNoEndsThere) {
  const std::vector<double> rows = along_seams(10);
  ASSERT_EQ(rows.size(), 16U);
  const auto [least, most] = std::ranges::minmax(rows);
  EXPECT_GT(least, 0);
  EXPECT_LT(most - least, 0.01 * most);
}

/// The force on a plate that strikes the water of a periodic tank, its middle that many spacings from the
/// tank's.
double force_beside_seam(int spacings) {
  constexpr double l0 = 0.01, dt = 1e-4;
  Parameters p = tank_case(0.6, 0.2, l0, 0.2);
  p.periodic[0] = true;
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.scheme.pressure_tolerance = 1e-10;
  const InterfaceMesh plate = rectangle(-0.1 + spacings * l0, 0, 0.2, 0.04, l0);
  Simulation<2> simulation(p, plate, PlateEntry::down(plate, 1));
  const auto m = simulation.interface().position.cols();
  InterfaceMotion motion{Points::Zero(3, m), PlateEntry::down(simulation.interface(), 1), Points::Zero(3, m)};
  for (int k = 1; k <= 10; ++k) {
    motion.displacement.row(1).setConstant(-k * dt);
    simulation.step(dt, motion);
  }
  return simulation.interface_force().row(1).sum();
}

TEST(Invariance, APlateBesideASeamHasTheForceOfOneInTheMiddle) {
  const double middle = force_beside_seam(0);
  EXPECT_GT(middle, 1000);
  for (const int spacings : {17, 19, 20, -20})  // 20: its side stands on the seam
    EXPECT_NEAR(force_beside_seam(spacings), middle, 1e-5 * middle) << spacings;
}

}  // namespace invariance_test
}  // namespace strake::fluid
