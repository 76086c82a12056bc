#include "structure/body/size.hpp"

#include "structure/body/surface.hpp"
#include "structure/particle/lattice.hpp"
#include "tests/structure/body/boxes.hpp"

#include <gtest/gtest.h>

namespace strake::structure {
namespace size_test {

Parameters plate(int dimension) {
  Parameters p;
  p.dimension = dimension;
  p.plate = {.length = 0.4, .thickness = 0.02};
  p.shape.depth = dimension == 3 ? 0.3 : 0;
  p.surface_spacing = 0.01;
  return p;
}

void expect_counted(const Parameters& p) {
  const auto made = static_cast<double>(surface(p).position.cols());
  EXPECT_GE(surface_size(p).count, 0.7 * made);
  EXPECT_LE(surface_size(p).count, 1.6 * made);
}

TEST(StructureSize, PointsOfTheSurfaceAreCountedBeforeTheyAreMade) {
  for (const int dimension : {2, 3}) {
    Parameters p = plate(dimension);
    expect_counted(p);
    p.shape.kind = ShapeKind::cylinder;
    p.shape.radius = 0.2;
    expect_counted(p);
    p.shape.kind = ShapeKind::wedge;
    p.shape.corner = wedge_polygon({.deadrise = 0.5, .width = 0.5, .height = 0.4});
    expect_counted(p);
    p.shape.kind = ShapeKind::solid;
    p.solid = solid_of_boxes(
        dimension, {soft_box("a", {0, 0, 0}, {1, 0.1, 1}), soft_box("b", {0.4, 0.1, 0}, {0.5, 0.4, 1})});
    if (dimension == 2) p.shape.corner = outer_polygons(p.solid).front();
    expect_counted(p);
  }
  Parameters sphere = plate(3);
  sphere.shape.kind = ShapeKind::sphere;
  sphere.shape.radius = 0.2;
  expect_counted(sphere);
}

TEST(StructureSize, ParticlesAreCountedBeforeTheyAreMade) {
  Parameters p = plate(2);
  p.particle.spacing = 0.005;
  const auto made = static_cast<double>(make_lattice<2>(elastic_solid(p), 0.005, 2.1).size());
  EXPECT_NEAR(particle_sizes(p)[0].count, made, 1e-6 * made);  // no clamp adds any
}

TEST(StructureSize, ACountBeyondAllIntegersIsANumber) {
  Parameters p = plate(2);
  p.surface_spacing = p.particle.spacing = 1e-9;
  EXPECT_NEAR(surface_size(p).count, 0.84e9, 1e3);
  EXPECT_NEAR(particle_sizes(p)[0].count, 8e15, 1e9);
}

}  // namespace size_test
}  // namespace strake::structure
