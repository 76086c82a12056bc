// Particles on bodies of meshes, on supports that turn, slide or are symmetric, and on supports that move.
#include "structure/particle/solver.hpp"
#include "tests/method/structure/flag.hpp"
#include "tests/method/structure/moving_supports.hpp"
#include "tests/structure/paper_plate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

namespace strake::structure {
namespace particle_support_test {

Parameters flag_of_particles(int layers) {
  Parameters p = flag(100, 8);
  p.kind = "particle";
  p.particle.spacing = 0.02 / layers;
  return p;
}

TEST(ParticleMesh, TheFlagHasItsMassCentreAndMoment) {
  for (const int layers : {4, 8}) {
    const Parameters p = flag_of_particles(layers);
    const MassProperties body = mass_of(p.solid),
                         particles = mass_of(make_lattice<2>(p.solid, p.particle.spacing, 2.1));
    EXPECT_NEAR(particles.mass / body.mass, 1, 1e-3) << layers << " layers";
    EXPECT_NEAR(particles.inertia(2, 2) / body.inertia(2, 2), 1, 5e-3);
    EXPECT_LT((particles.centre - body.centre).norm(), 2e-4);
  }
}

// CSM1 of Turek & Hron 2006: (−7.1878, −66.1029) mm.
TEST(ParticleMesh, TheFlagHangsUnderItsWeightWithinThreePercentAtEightLayers) {
  ParticleSolver<2> solver(flag_of_particles(8));
  solver.solve_static();
  const Eigen::Vector3d tip = solver.displacement_at({0.6, 0.2, 0});
  RecordProperty("x", std::to_string(tip.x() / -7.1878e-3));
  RecordProperty("y", std::to_string(tip.y() / -66.1029e-3));
  EXPECT_NEAR(tip.x() / -7.1878e-3, 1, 0.03);
  EXPECT_NEAR(tip.y() / -66.1029e-3, 1, 0.03);
}

// The lattice meets the faces of a turned plate at a slant. Its frequency is that of the plate.
TEST(ParticleMesh, APlateTurnedByThirtyDegreesKeepsItsFrequency) {
  Parameters p = paper_plate(8);
  p.plate.right = Support::free;
  const double straight = ParticleSolver<2>(p).frequencies(1).at(0);
  p.solid = elastic_solid(p);
  p.shape.kind = ShapeKind::solid;
  const double c = std::cos(std::acos(-1.0) / 6), s = 0.5;
  for (Eigen::Index i = 0; i < p.solid.node.cols(); ++i) {
    const Eigen::Vector3d X = p.solid.node.col(i);
    p.solid.node.col(i) << c * X.x() - s * X.y(), s * X.x() + c * X.y(), 0;
  }
  p.solid.plane = {};  // no boxes any more
  p.shape.corner = outer_polygons(p.solid).front();
  EXPECT_EQ(lattice_fault(p.solid, p.particle.spacing).problem, "");
  const double turned = ParticleSolver<2>(p).frequencies(1).at(0);
  RecordProperty("turned_over_straight", std::to_string(turned / straight));
  EXPECT_NEAR(turned / straight, 1, 0.1);
}

// cases/VALIDATION.md, "Strips: deflection and frequencies": pinned at mid-height 306.9 Hz by plane
// elasticity, and 2.181e-4 m under 1e5 Pa.
TEST(ParticleSupports, APinnedStripHasItsFrequencyAndDeflection) {
  Parameters p = paper_plate(8);
  p.plate.left = p.plate.right = Support::pinned;
  p.load.kind = LoadKind::traction;
  p.load.value = {0, -1e5, 0};
  ParticleSolver<2> solver(p);
  const double f1 = solver.frequencies(1).at(0);
  RecordProperty("f1", std::to_string(f1));
  EXPECT_NEAR(f1 / 306.9, 1, 0.03);
  solver.solve_static();
  const double w = -solver.displacement_at({0, 0.01, 0}).y();
  RecordProperty("w", std::to_string(w / 2.181e-4));
  EXPECT_NEAR(w / 2.181e-4, 1, 0.05);
  EXPECT_NEAR(solver.displacement_at({-0.2, 0.01, 0}).norm(), 0, 1e-9 * w) << "the pin holds";
}

// Half of a strip whose other half is its mirror image. A strip of which one end rolls bends as if both were
// pinned, since there is no membrane force.
TEST(ParticleSupports, SymmetryAndRollersStandForTheWholeStrip) {
  Parameters p = paper_plate(4);
  const double whole = ParticleSolver<2>(p).frequencies(1).at(0);
  SolidBox half;
  half.name = "half";
  half.max << 0.2, 0.02, 0;
  half.support[0] = Support::clamped;
  half.support[1] = Support::symmetry;
  p.shape.kind = ShapeKind::solid;
  p.solid = solid_of_boxes(2, {half});
  p.shape.corner = outer_polygons(p.solid).front();
  EXPECT_NEAR(ParticleSolver<2>(p).frequencies(1).at(0) / whole, 1, 0.01);

  half.max.x() = 0.4;
  half.support[0] = half.support[1] = Support::pinned;
  p.solid = solid_of_boxes(2, {half});
  const double pinned = ParticleSolver<2>(p).frequencies(1).at(0);
  half.support[1] = Support::roller;
  p.solid = solid_of_boxes(2, {half});
  EXPECT_NEAR(ParticleSolver<2>(p).frequencies(1).at(0) / pinned, 1, 0.005);
}

// cases/VALIDATION.md, "Elastic plate: first bending", dry: a plate at 1 m/s whose ends are stopped, peak of
// the middle. Modes 1 and 3 of pinned ends, whose frequencies are as 1 to 9, make two peaks alike, at 0.691
// and 0.931 ms. Also energy.
TEST(ParticleSupports, AStoppedPlateBendsAsFarAsTheBeamInItsFirstPeak) {
  for (const auto& [support, peak_at, time_at] :
       {std::tuple{Support::clamped, 0.3049e-3, 0.444e-3}, {Support::pinned, 0.6571e-3, 0.931e-3}}) {
    Parameters p = paper_plate(8);
    p.plate.left = p.plate.right = support;
    p.initial.value = {0, -1, 0};
    ParticleSolver<2> solver(p);
    const double start = solver.energy().kinetic;
    double peak = 0, time = 0, drift = 0;
    for (int k = 0; k * 1e-5 < 1.3 * time_at; ++k) {
      solver.advance(k * 1e-5, 1e-5, {});
      const double w = -solver.displacement_at({0, 0.01, 0}).y();
      if (w > peak) {
        peak = w;
        time = (k + 1) * 1e-5;
      }
      const Energy e = solver.energy();
      drift = std::max(drift, std::abs(e.kinetic + e.strain - start));
    }
    const std::string name = support == Support::clamped ? "cc" : "pp";
    RecordProperty(name + "_peak", std::to_string(peak / peak_at));
    RecordProperty(name + "_time", std::to_string(time / time_at));
    EXPECT_NEAR(peak / peak_at, 1, 0.05) << name;
    EXPECT_LT(time / time_at, 1.1) << name;
    EXPECT_GT(time / (support == Support::clamped ? time_at : 0.691e-3), 0.9) << name;
    EXPECT_LT(drift, 0.01 * start) << name;  // of leapfrog: it swings with (ω_max h)², and comes back
  }
}

TEST(ParticleFrame, ADropKeepsMomentumAndEnergy) {
  for (const Support support : {Support::clamped, Support::pinned}) {
    Parameters p = dropped_plate();
    p.plate.left = p.plate.right = support;
    expect_a_drop_to_keep_momentum_and_energy<ParticleSolver<2>>(p, 0.01);  // of leapfrog, see above
  }
}

TEST(ParticleFrame, AnAccelerationOfTheSupportsBendsLikeWeight) {
  expect_acceleration_to_bend_like_weight<ParticleSolver<2>>(paper_plate(4));
}

TEST(ParticleFrame, AClampThatTurnsStretchesAStrip) {
  expect_a_turning_clamp_to_stretch_the_strip<ParticleSolver<2>>(paper_plate(2), 1e-3, 0.05);
}

TEST(ParticleFrame, AFreeBodyFalls) {
  expect_a_free_body_to_fall<ParticleSolver<2>>(paper_plate(4));
}

TEST(ParticleFrame, CheckpointsAndRewindsAreBitEqual) {
  expect_checkpoints_and_rewinds_to_be_bit_equal<ParticleSolver<2>>(dropped_plate());
}

}  // namespace particle_support_test
}  // namespace strake::structure
