#include "coupler/coupling/scheme.hpp"
#include "structure/body/mass.hpp"
#include "structure/participant.hpp"
#include "structure/rigid/rigid.hpp"
#include "tests/fluid/plate_case.hpp"
#include "tests/method/coupling/stepped_water.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace strake {
namespace {

struct Body {
  const char* name;
  structure::Parameters parameters;  // without mass
  double area;                       // [m²]
  double added_mass;                 // in this tank, by boundary elements; an outer error below 0.5 % [kg/m]
};

structure::Parameters plane_body(structure::ShapeKind kind) {
  structure::Parameters s;
  s.kind = "rigid";
  s.shape.kind = kind;
  s.surface_spacing = 0.01;
  s.gravity = {0, -9.81, 0};
  s.free.y = true;
  return s;
}

Body cylinder() {
  structure::Parameters s = plane_body(structure::ShapeKind::cylinder);
  s.shape.radius = 0.1;
  s.shape.centre = {0.00371, -0.50437, 0};
  return {"cylinder", s, 64 * 0.5 * 0.01 * std::sin(2 * std::numbers::pi / 64), 32.39};
}

Body square(double angle) {
  structure::Parameters s = plane_body(structure::ShapeKind::polygon);
  const double turn = angle * std::numbers::pi / 180, c = 0.1 * std::cos(turn), d = 0.1 * std::sin(turn);
  const Eigen::Vector2d middle(0.00371, -0.50437), right(c, d), up(-d, c);
  s.shape.corner = {middle - right - up, middle + right - up, middle + right + up, middle - right + up};
  return {angle > 0 ? "square, 20 deg" : "square", s, 0.04, 49.16};
}

struct Release {
  double first = 0, steady = 0;  // acceleration of the first millisecond, and of the following nine [m/s²]
  double largest = 0, mean_force = 0;  // [N/m]
};
Release release(const Body& body, double gravity_of_body) {
  constexpr double window = 1e-3;
  constexpr int windows = 10;
  structure::Parameters s = body.parameters;
  s.body.mass = gravity_of_body * 1000 * body.area;
  auto owned = std::make_unique<structure::Rigid>(s);
  const structure::Rigid& rigid = *owned;
  structure::StructureParticipant dry(std::move(owned), s, CommonKeys{}, {});
  fluid::Parameters p = fluid::tank_case(1.6, 1.0, 0.01);
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.submerged = true;
  models::SteppedWater<2> water(p, dry.mesh(), rigid.velocity());
  SchemeParameters parameters;
  parameters.convergence = {1e-7, 1e-13, Measure::increment, 1, 20, Unconverged::accept};
  parameters.accelerator.kind = "iqn-ils";
  Scheme scheme(water, dry, nearest_neighbour(dry.mesh(), water.mesh()), parameters);
  const Eigen::Vector3d centre = structure::mass_of(s).centre;
  Release out;
  double before = 0;
  for (int w = 0; w < windows; ++w) {
    EXPECT_TRUE(scheme.advance({w * window, window}).converged);
    scheme.commit(false);
    const double now = rigid.velocity_at(centre).y(), acceleration = (now - before) / window;
    const double force = s.body.mass * (acceleration + 9.81);
    (w == 0 ? out.first : out.steady) += acceleration / (w == 0 ? 1 : windows - 1);
    out.largest = std::max(out.largest, force);
    out.mean_force += force / windows;
    before = now;
  }
  return out;
}

// (m_displaced − m) g/(m + m_added), off the lattice. Without packing the bodies fell for 7 ms, and a slam of
// 6 to 8 times the force followed.
TEST(ReleasedBody, HasTheAccelerationOfAddedMassFromItsFirstStep) {
  for (const Body& body : {cylinder(), square(0), square(20)})
    for (const double density : {0.5, 3.0}) {
      const double displaced = 1000 * body.area, mass = density * displaced;
      const double theory = (displaced - mass) * 9.81 / (mass + body.added_mass);
      const Release found = release(body, density);
      fmt::print("{}, s.g. {}: {:.3f}, then {:.3f} m/s^2, theory {:.3f}; force {:.3f} of the mean\n",
                 body.name, density, found.first, found.steady, theory, found.largest / found.mean_force);
      EXPECT_NEAR(found.first, theory, 0.05 * std::abs(theory)) << body.name;
      EXPECT_NEAR(found.steady, theory, 0.05 * std::abs(theory)) << body.name;
      EXPECT_LT(found.largest, 1.2 * found.mean_force) << body.name;
    }
}

}  // namespace
}  // namespace strake
