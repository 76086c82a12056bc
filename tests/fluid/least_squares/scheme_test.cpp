#include "fluid/least_squares/scheme.hpp"

#include "fluid/boundary/fill.hpp"
#include "tests/fluid/plate_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace strake::fluid {
namespace scheme_test {

constexpr double dt = 1e-3;

Parameters incompressible(double spacing) {
  Parameters p = tank_case(20 * spacing, 12 * spacing, spacing, 4 * spacing);
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.scheme.tau = p.scheme.gamma = 0;
  return p;
}

/// Water that gravity has just set in motion, u* = g Δt, its inner particles off their lattice places.
struct Column {
  Parameters p;
  State<2> state;
  Boundary<2> boundary;
  NeighbourSearch<2> search;
  LeastSquaresScheme<2> scheme;
  const Neighbours* far = nullptr;
  Vector<2> gravity;

  Column(const Parameters& parameters, double disorder, const InterfaceMesh& body = {})
      : p(parameters),
        state(fill<2>(p)),
        boundary(p, body, Points::Zero(3, body.position.cols()), state),
        search(p.scheme.radius_laplacian * p.spacing, 0),
        scheme(p, boundary, state),
        gravity(p.gravity.head<2>()) {
    state.surface.assign(state.kind.size(), 1);
    measure();  // on the lattice, where water touches all of the walls
    std::mt19937 random(7);
    std::uniform_real_distribution<double> move(-disorder * p.spacing, disorder * p.spacing);
    for (std::int64_t i = 0; i < boundary.water(); ++i) {
      state.velocity.col(i) = dt * gravity;
      // The surface's condition assumes a lattice; the layers next to it stay in order.
      if (state.position(1, i) > -5 * p.spacing) continue;  // between two layers
      state.position(0, i) += move(random);
      state.position(1, i) += move(random);
    }
    measure();
    scheme.filter(boundary, state, near(), dt);
  }
  void measure() {
    far = &search.update(state.position, boundary.tags(state));
    scheme.measure(boundary, state, *far, near(), dt);
  }
  const Neighbours& near() { return search.within(p.scheme.radius_gradient * p.spacing); }
  double hydrostatic(std::int64_t i) const { return -p.density * 9.81 * state.position(1, i); }
  std::int64_t nearest(const Vector<2>& place) const {
    std::int64_t best = 0;
    for (std::int64_t i = 0; i < boundary.water(); ++i)
      if ((state.position.col(i) - place).norm() < (state.position.col(best) - place).norm()) best = i;
    return best;
  }
};

TEST(LeastSquaresScheme, HydrostaticPressureSolvesTheEquationHoweverTheParticlesLie) {
  Column column(incompressible(0.01), 0.15);
  PressureSystem system;
  column.scheme.assemble(column.boundary, column.state, *column.far, column.near(), column.gravity, dt,
                         system);
  ASSERT_EQ(system.size(), column.boundary.water());
  double largest = 0, scale = 0;
  for (std::int64_t k = 0; k < system.size(); ++k) {
    const auto row = static_cast<std::size_t>(k);
    double sum = system.diagonal[k] * column.hydrostatic(system.particle[row]);
    scale = std::max(scale, std::abs(sum));
    for (std::int64_t e = system.start[row]; e < system.stop[row]; ++e)
      sum += system.value[static_cast<std::size_t>(e)] *
             column.hydrostatic(
                 system.particle[static_cast<std::size_t>(system.column[static_cast<std::size_t>(e)])]);
    largest = std::max(largest, std::abs(sum - system.right[k]));
  }
  // A thousandth of the largest entry. At corners of surface and wall, a wall layer above the water is a
  // neighbour.
  EXPECT_LT(largest, 2e-3 * scale);
}

TEST(LeastSquaresScheme, PressureGradientOfStillWaterCarriesItsWeightAtWallsAndSurfaceToo) {
  Column column(incompressible(0.01), 0.15);
  for (std::int64_t i = 0; i < column.boundary.water(); ++i) column.state.pressure[i] = column.hydrostatic(i);
  PressureSystem system;
  column.scheme.assemble(column.boundary, column.state, *column.far, column.near(), column.gravity, dt,
                         system);
  const Vectors<2>& gradient =
      column.scheme.pressure_gradient(column.boundary, column.state, column.near(), dt);
  const Vector<2> weight = column.p.density * column.gravity;
  for (std::int64_t i = 0; i < column.boundary.water(); ++i) {
    const bool at_surface = column.state.position(1, i) > -2 * column.p.spacing;
    // Round-off of sums over a dozen neighbours; beside the surface the depth is that of a lattice's layer.
    const double tolerance = at_surface ? 0.05 : 1e-9;
    EXPECT_LT((gradient.col(i) - weight).norm(), tolerance * weight.norm())
        << "at " << column.state.position.col(i).transpose();
  }
}

/// Water around a box under water, 60 by 40 mm; its lower left corner is at (−30, −80) mm.
struct AroundABox : Column {
  AroundABox() : Column(submerged(), 0, rectangle(-0.03, -0.08, 0.06, 0.04, 0.01)) {}
  static Parameters submerged() {
    Parameters p = incompressible(0.01);
    p.submerged = true;
    return p;
  }
};

TEST(LeastSquaresScheme, PressureAtASharpCornerUnderWaterLiesWithinThatOfTheWaterAround) {
  AroundABox box;
  PressureSystem system;
  box.scheme.assemble(box.boundary, box.state, *box.far, box.near(), box.gravity, dt, system);
  const std::int64_t corner = box.nearest({-0.035, -0.085}), before_face = box.nearest({0.005, -0.085}),
                     away = box.nearest({0.075, -0.085});
  for (const double part : {5.0, -5.0}) {
    for (std::int64_t i = 0; i < box.boundary.water(); ++i) box.state.pressure[i] = box.hydrostatic(i);
    for (const std::int64_t i : {corner, before_face, away}) box.state.pressure[i] *= part;
    box.scheme.limit_at_corners(box.boundary, box.state, box.near());
    EXPECT_NEAR(box.state.pressure[corner], box.hydrostatic(corner), 1e-9 * box.hydrostatic(corner)) << part;
    for (const std::int64_t i : {before_face, away})
      EXPECT_EQ(box.state.pressure[i], part * box.hydrostatic(i));
  }
}

/// The right-hand side beside the box's corner, while a particle that moves up at 0.2 m/s stands under its
/// lower face, that far from the face's end.
double right_side_at_corner(double inside) {
  AroundABox box;
  const std::int64_t mover = box.nearest({-0.025, -0.085}), watched = box.nearest({-0.045, -0.085});
  box.state.position.col(mover) = Vector<2>(-0.03 + inside, -0.085);
  box.state.velocity.col(mover) = Vector<2>(0, 0.2);
  box.measure();
  PressureSystem system;
  box.scheme.assemble(box.boundary, box.state, *box.far, box.near(), box.gravity, dt, system);
  return system.right[watched];
}

TEST(LeastSquaresScheme, WaterThatPassesASharpCornerDoesNotChangeTheFluxThereAtOnce) {
  const double passing = right_side_at_corner(1e-7) - right_side_at_corner(-1e-7),
               whole = right_side_at_corner(0.0025) - right_side_at_corner(-1e-7);
  EXPECT_LT(std::abs(passing), 1e-3 * std::abs(whole));
}

/// The part of a small tension that a particle keeps. It is below ρu² of the water that has just begun to
/// fall.
double tension_kept(Column& column, std::int64_t particle) {
  PressureSystem system;
  column.scheme.assemble(column.boundary, column.state, *column.far, column.near(), column.gravity, dt,
                         system);
  constexpr double tension = -0.01;
  column.state.pressure.setConstant(tension);
  column.scheme.limit_tension(column.boundary, column.state, *column.far);
  return column.state.pressure[particle] / tension;
}

Column still_water(bool submerged) {
  Parameters p = incompressible(0.01);
  p.submerged = submerged;
  return Column(p, 0);
}

/// The part that deep water keeps at that distance [l0] from its place in the lattice. Its neighbours leave
/// an opening on the other side, which counts as a little surface at last.
double tension_beside_an_opening(double moved) {
  Column column = still_water(true);
  const std::int64_t watched = column.nearest({-0.005, -0.065});
  column.state.position(0, watched) += 0.01 * moved;
  column.measure();
  return tension_kept(column, watched);
}

// Beside a section that rolls, σ of a particle 6 spacings deep rose to 0.0005. It lost all its tension, and
// the pressure around it rose from 920 to 2150 Pa in one step.
TEST(LeastSquaresScheme, TensionOfDeepWaterFadesWhereALittleSurfaceComesUp) {
  double largest = 0, before = tension_beside_an_opening(0);
  EXPECT_EQ(before, 1);
  for (double moved = 0.01; moved < 0.6; moved += 0.01) {
    const double now = tension_beside_an_opening(moved);
    largest = std::max(largest, std::abs(now - before));
    before = now;
  }
  EXPECT_LT(before, 0.5);
  EXPECT_LT(largest, 0.15);
}

/// The part that water so many spacings under the two rows of the surface (σ = 1) keeps.
double tension_under_the_surface(int rows, bool submerged) {
  Column column = still_water(submerged);
  return tension_kept(column, column.nearest({-0.005, -0.015 - 0.01 * rows}));
}

// Within 1.6 l0 of the surface the water beside a section that rolls was let go of where its side slowed
// down.
TEST(LeastSquaresScheme, TensionHoldsTheRowUnderTheSurfaceBesideABodyThatStoodInTheWater) {
  for (const int row : {0, 1, 2}) {
    EXPECT_NEAR(tension_under_the_surface(row, true), std::max(0.0, (row - 0.8) / 2.3), 1e-6) << row;
    EXPECT_NEAR(tension_under_the_surface(row, false), std::max(0.0, (row - 1.6) / 1.5), 1e-6) << row;
  }
}

TEST(LeastSquaresScheme, FaceOfTheFloorCarriesTheWholeDepth) {
  Column column(incompressible(0.01), 0.15);
  for (std::int64_t i = 0; i < column.boundary.water(); ++i) column.state.pressure[i] = column.hydrostatic(i);
  PressureSystem system;
  column.scheme.assemble(column.boundary, column.state, *column.far, column.near(), column.gravity, dt,
                         system);
  column.scheme.pressure_gradient(column.boundary, column.state, column.near(), dt);
  const LayerForces<2> forces = column.scheme.layer_forces(column.boundary, column.state, column.near());
  double floor = 0;
  for (std::int64_t j = column.boundary.water(); j < forces.cols(); ++j)
    if (column.boundary.tank().is_floor(j)) floor += forces(1, j);
  const double load = -column.p.density * 9.81 * 0.12 * 0.2;
  EXPECT_NEAR(floor / load, 1, 1e-9);
}

/// The part of ∇p along y of a surface particle beside a vertical face of a body, of its own pressure 1 Pa.
/// The row beneath is pressed against the surface's.
double own_gradient() {
  Parameters p = incompressible(0.02);
  const double l0 = p.spacing;
  p.water.max[0] = 0;
  Column c(p, 0, rectangle(0, -11 * l0, 8 * l0, 13 * l0, l0));
  std::int64_t beside = -1;
  for (std::int64_t i = 0; i < c.boundary.water(); ++i) {
    if (std::abs(c.state.position(1, i) + 1.5 * l0) < 0.1 * l0) c.state.position(1, i) += 0.4 * l0;
    if (std::abs(c.state.position(1, i) + 0.5 * l0) < 0.1 * l0 && c.state.position(0, i) > -0.6 * l0)
      beside = i;
  }
  if (beside < 0) return std::numeric_limits<double>::infinity();
  c.measure();
  c.scheme.filter(c.boundary, c.state, c.near(), dt);
  c.state.pressure.setZero();
  c.state.pressure[beside] = 1;
  return c.scheme.pressure_gradient(c.boundary, c.state, c.near(), dt)(1, beside);
}

// Beside a body the pressure of one particle must not drive it along N into those beneath (F47). N leans from
// the face a little, so that 2.6 1/m are left along y of 53 1/m without the bound on b.
TEST(LeastSquaresScheme, ThePressureOfAParticleAtTheSurfaceDoesNotDriveItIntoTheWater) {
  const double bounded = own_gradient();
  double& counts = least_squares_constants().body_counts;
  const double as_used = counts;
  counts = 1e9;
  const double without = own_gradient();
  counts = as_used;
  EXPECT_GT(without, 10);
  EXPECT_LT(bounded, 0.1 * without);
}

TEST(LeastSquaresScheme, SurfaceParticlesAreThoseOfTheTopRow) {
  Column column(incompressible(0.01), 0.1);
  for (std::int64_t i = 0; i < column.boundary.water(); ++i)
    EXPECT_EQ(column.state.surface[static_cast<std::size_t>(i)] != 0,
              column.state.position(1, i) > -column.p.spacing)
        << "at " << column.state.position.col(i).transpose();
}

TEST(LeastSquaresScheme, FilterLeavesALinearVelocityAloneAndKeepsMomentum) {
  Parameters p = incompressible(0.01);
  Column column(p, 0.2);
  State<2> linear = column.state;
  Tensor<2> slope;
  slope << 3.0, -1.0, 2.0, -3.0;
  for (std::int64_t i = 0; i < column.boundary.water(); ++i)
    linear.velocity.col(i) = slope * linear.position.col(i);
  const Vectors<2> before = linear.velocity;
  column.scheme.filter(column.boundary, linear, column.near(), dt);
  EXPECT_LT((linear.velocity - before).norm(), 1e-12 * before.norm());

  State<2> rough = column.state;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jump(-1, 1);
  for (std::int64_t i = 0; i < column.boundary.water(); ++i)
    rough.velocity.col(i) << jump(random), jump(random);
  const Vectors<2> start = rough.velocity;
  column.scheme.filter(column.boundary, rough, column.near(), dt);
  const auto water = column.boundary.water();
  EXPECT_LT((rough.velocity - start).leftCols(water).rowwise().sum().norm(), 1e-12 * start.norm());
  EXPECT_LT(rough.velocity.leftCols(water).squaredNorm(), 0.99 * start.leftCols(water).squaredNorm());
}

// |δ| counts as at least a part of √(g l0): small differences of neighbours fade at a rate that does not fall
// with them.
TEST(LeastSquaresScheme, FilterTakesTheSamePartOfAllSmallDifferences) {
  Column column(incompressible(0.01), 0);
  const auto part_taken = [&](double size) {
    State<2> rough = column.state;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> jump(-size, size);
    const auto water = column.boundary.water();
    for (std::int64_t i = 0; i < water; ++i) rough.velocity.col(i) << jump(random), jump(random);
    const double before = rough.velocity.leftCols(water).norm();
    column.scheme.filter(column.boundary, rough, column.near(), dt);
    return 1 - rough.velocity.leftCols(water).norm() / before;
  };
  EXPECT_GT(part_taken(1e-5), 1e-3);
  EXPECT_NEAR(part_taken(1e-5), part_taken(1e-4), 1e-9);
}

// Beside a face shifts go one way: a particle that another one presses on stays before it.
TEST(LeastSquaresScheme, ShiftsGoThroughNoWall) {
  Column column(incompressible(0.01), 0);
  const double l0 = column.p.spacing, floor = column.p.tank.min.y();
  std::int64_t low = 0, upper = 0;
  const auto middle_column = [&](std::int64_t i) {
    return std::abs(column.state.position(0, i) - 0.5 * l0) < 0.1 * l0;
  };
  for (std::int64_t i = 0; i < column.boundary.water(); ++i) {
    column.state.velocity.col(i) << 20, 0;
    if (middle_column(i) && std::abs(column.state.position(1, i) - floor - 0.5 * l0) < 0.1 * l0) low = i;
    if (middle_column(i) && std::abs(column.state.position(1, i) - floor - 1.5 * l0) < 0.1 * l0) upper = i;
  }
  column.state.position(1, low) = floor + 0.02 * l0;
  column.state.position(1, upper) = floor + 0.35 * l0;
  column.measure();
  column.scheme.filter(column.boundary, column.state, column.near(), dt);
  column.scheme.shift(column.boundary, column.state, column.near(), dt);
  EXPECT_GE(column.state.position(1, low), floor);
}

TEST(LeastSquaresScheme, WallIsNotSeenBeforeWaterTouchesIt) {
  PlateEntry dry(PlateEntry::parameters(0.02), 1.0, 0.1 * 0.02);
  dry.step(1e-5);
  EXPECT_EQ(dry.simulation.interface_force().norm(), 0);
  PlateEntry wet(PlateEntry::parameters(0.02), 1.0, 0.01 * 0.02);
  wet.step(1e-5);
  EXPECT_GT(wet.simulation.interface_force().row(1).sum(), 0);
}

}  // namespace scheme_test
}  // namespace strake::fluid
