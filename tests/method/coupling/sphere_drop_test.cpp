#include "coupler/coupling/scheme.hpp"
#include "fluid/mps/interface_load.hpp"
#include "structure/body/mass.hpp"
#include "structure/participant.hpp"
#include "structure/rigid/rigid.hpp"
#include "tests/fluid/solid_case.hpp"
#include "tests/method/coupling/stepped_water.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace strake {
namespace {

using Eigen::Vector3d;

// A light sphere, five spacings of radius, falls into still water, free in all its motions. Its momentum goes
// to the water and the walls and nowhere else; von Karman's and Wagner's added masses 4/3 ρc³ bound its
// speed, c² = 2Rz − z² and 3Rz.
TEST(SphereDrop, AFreeSphereGivesItsMomentumToTheWaterAsAddedMassHasIt) {
  constexpr double radius = 0.08, spacing = 0.016, speed = 4, window = 1.6e-4, end = 3.2e-3;
  structure::Parameters s;
  s.kind = "rigid";
  s.dimension = 3;
  s.shape.kind = structure::ShapeKind::sphere;
  s.shape.radius = radius;
  s.shape.centre = {0, radius + 0.2 * spacing, 0};
  s.surface_spacing = spacing;
  s.body.mass = 250 * 4.0 / 3 * std::numbers::pi * std::pow(radius, 3);
  s.gravity = {0, -9.81, 0};
  s.velocity = {0, -speed, 0};
  s.free = {.x = true, .y = true, .z = true, .angle = false, .rotation = true};
  auto owned = std::make_unique<structure::Rigid>(s);
  const structure::Rigid& body = *owned;
  structure::StructureParticipant dry(std::move(owned), s, CommonKeys{}, {});
  const fluid::Parameters p = fluid::basin(0.48, 0.16, spacing, 0.16);
  models::SteppedWater<3> water(p, dry.mesh(), body.velocity());

  SchemeParameters parameters;
  parameters.convergence = {1e-7, 1e-12, Measure::increment, 1, 20, Unconverged::accept};
  parameters.accelerator.kind = "iqn-ils";
  Scheme scheme(water, dry, nearest_neighbour(dry.mesh(), water.mesh()), parameters);
  const Vector3d centre = structure::mass_of(s).centre, start = body.velocity_at(centre);
  int unconverged = 0;
  const int windows = static_cast<int>(std::lround(end / window));
  for (int w = 0; w < windows; ++w) {
    unconverged += scheme.advance({w * window, window}).converged ? 0 : 1;
    scheme.commit(false);
  }
  const Vector3d now = body.velocity_at(centre), sunk = body.displacement_at(centre);
  const fluid::State<3>& state = water.state();
  const double momentum = s.body.mass * speed, depth = -sunk.y() - 0.2 * spacing;
  const auto left = [&](double disc) {  // (m + 4/3 ρc³) v = m (V + g t)
    return s.body.mass * (speed + 9.81 * end) / (s.body.mass + 4.0 / 3 * p.density * std::pow(disc, 1.5));
  };
  const double karman = left(2 * radius * depth - depth * depth), wagner = left(3 * radius * depth);
  fmt::print("sphere drop: {:.3f} m/s left at z/R = {:.3f}, von Karman {:.3f}, Wagner {:.3f}\n", -now.y(),
             depth / radius, karman, wagner);
  EXPECT_EQ(unconverged, 0);
  EXPECT_LT(-now.y(), karman);
  EXPECT_GT(-now.y(), wagner);
  EXPECT_LT((s.body.mass * (now - start - end * s.gravity) - state.impulse_on_bodies).norm(),
            1e-4 * momentum);
  // The rim of the wetted disc is one layer of particles: 0.045 here, 0.019 at half the spacing.
  EXPECT_LT(fluid::momentum_gap(state, p.density * std::pow(spacing, 3)).norm(), 0.06 * momentum);
  EXPECT_LT(std::hypot(now.x(), now.z()), 0.005 * speed);  // the mesh has no symmetry of the lattice
  EXPECT_LT((body.velocity_at(centre + Vector3d(radius, 0, 0)) - now).norm(), 0.005 * speed);
  EXPECT_EQ(state.penetrations, 0);
  EXPECT_EQ(state.lost, 0);
}

}  // namespace
}  // namespace strake
