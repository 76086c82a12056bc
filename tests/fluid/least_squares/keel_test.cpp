// Water at a keel in space, under water.

#include "fluid/boundary/boundary.hpp"
#include "fluid/boundary/fill.hpp"
#include "fluid/least_squares/scheme.hpp"
#include "tests/fluid/solid_case.hpp"

#include <gtest/gtest.h>

namespace strake::fluid {
namespace keel_test {

constexpr double l0 = 0.01, dt = 1e-4;

Parameters submerged_basin() {
  Parameters p = basin(0.16, 0.14, l0, 0.02);
  p.gravity = {0, -9.81, 0};
  p.submerged = true;
  return p;
}

/// Water around a prism, its keel at y = -80 mm with 62 degrees inside the body.
struct AroundAKeel {
  Parameters p = submerged_basin();
  InterfaceMesh body = structure::prism_surface(
      structure::outline({{0, -0.08}, {0.03, -0.03}, {-0.03, -0.03}}, l0), 0.08, 0, l0);
  State<3> state = fill<3>(p);
  Boundary<3> boundary{p, body, Points::Zero(3, body.position.cols()), state};
  NeighbourSearch<3> search{p.scheme.radius_laplacian * l0, 0};
  LeastSquaresScheme<3> scheme{p, boundary, state};
  const Neighbours* far = nullptr;

  AroundAKeel() { state.surface.assign(state.kind.size(), 1); }
  /// Puts the particle nearest to that place there.
  std::int64_t put(const Vector<3>& place) {
    std::int64_t best = 0;
    for (std::int64_t i = 0; i < boundary.water(); ++i)
      if ((state.position.col(i) - place).norm() < (state.position.col(best) - place).norm()) best = i;
    state.position.col(best) = place;
    return best;
  }
  void measure() {
    far = &search.update(state.position, boundary.tags(state));
    scheme.measure(boundary, state, *far, near(), dt);
  }
  const Neighbours& near() { return search.within(p.scheme.radius_gradient * l0); }
  double hydrostatic(std::int64_t i) const { return -p.density * 9.81 * state.position(1, i); }
};

TEST(LeastSquaresScheme, PressureAtAKeelUnderWaterLiesWithinThatOfTheWaterAround) {
  AroundAKeel keel;
  // Half a spacing up one face, and under the keel; then two spacings up the face.
  const Vector<3> up = Vector<3>(3, 5, 0).normalized(), out(up.y(), -up.x(), 0), apex(0, -0.08, 0.003);
  const std::int64_t beside = keel.put(apex + 0.5 * l0 * up + 0.5 * l0 * out),
                     under = keel.put(apex + Vector<3>(0, -0.5 * l0, 3 * l0)),
                     before_face = keel.put(apex + 2 * l0 * up + 0.5 * l0 * out - Vector<3>(0, 0, 3 * l0));
  keel.measure();
  keel.measure();  // faces become wet in the first
  PressureSystem system;
  keel.scheme.assemble(keel.boundary, keel.state, *keel.far, keel.near(), {0, -9.81, 0}, dt, system);
  for (const double part : {5.0, -5.0}) {
    for (std::int64_t i = 0; i < keel.boundary.water(); ++i) keel.state.pressure[i] = keel.hydrostatic(i);
    for (const std::int64_t i : {beside, under, before_face}) {
      keel.state.pressure[i] *= part;
      keel.state.surface[static_cast<std::size_t>(i)] = 0;
    }
    keel.scheme.limit_at_corners(keel.boundary, keel.state, keel.near());
    for (const std::int64_t i : {beside, under})
      EXPECT_NEAR(keel.state.pressure[i], keel.hydrostatic(i), 1e-9 * keel.hydrostatic(i))
          << i << " " << part;
    EXPECT_EQ(keel.state.pressure[before_face], part * keel.hydrostatic(before_face));
  }
}

}  // namespace keel_test
}  // namespace strake::fluid
