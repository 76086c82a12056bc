#include "fluid/mps/interface_load.hpp"

#include "fluid/boundary/fill.hpp"
#include "fluid/mps/correction.hpp"
#include "tests/fluid/plate_case.hpp"

#include <gtest/gtest.h>

namespace strake::fluid {
namespace interface_load_test {

constexpr double l0 = 0.01;

/// A plate that lies on still water under its own pressure: p = p0 − ρ g y.
struct Scene {
  Parameters p = tank_case(0.4, 0.2, l0, 0.2);
  State<2> state = fill<2>(p);
  Boundary<2> boundary;
  NeighbourSearch<2> search{3.1 * l0, 0};
  LatticeConstants lattice = lattice_constants<2>(2.1, l0);
  Vector<2> gravity{0, -9.81};
  double ambient = 2e4;
  Points still;
  Vectors<2> none;

  Scene() : boundary(p, rectangle(-0.1, 0.0, 0.2, 0.02, l0), {}, state) {
    still = Points::Zero(3, boundary.mesh().position.cols());
    for (std::size_t i = 0; i < state.kind.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const int point = boundary.point_of(k);
      state.surface[i] = point >= 0 && boundary.body_surface().edge_of(point) != 0;  // sides and top are dry
      state.pressure[k] = state.surface[i] ? 0 : ambient + 1000 * gravity.dot(state.position.col(k));
    }
    boundary.fill_dummies(state, gravity, still);
  }
  const Neighbours& near() {
    const auto keep = [this](std::int32_t i, std::int32_t j) { return boundary.keep(state, i, j); };
    search.update(state.position, boundary.tags(state), keep);
    return search.within(lattice.radius);
  }
  LayerForces<2> forces(Gradient gradient) {
    const LoadTerms<2> terms{none, gravity, still, gradient, lattice, 1000, l0};
    return layer_forces<2>(state, boundary, near(), terms);
  }
};

TEST(InterfaceLoad, FacesFeelTheAmbientPressureWithEveryGradient) {
  for (const Gradient gradient : {Gradient::min_pressure, Gradient::pairwise, Gradient::corrected}) {
    Scene scene;
    const Vectors<2> force = gather_on_points<2>(scene.forces(gradient), scene.boundary);
    // The four points at each end also see water beside the plate (pairwise) or miss none (face integral).
    for (int k = 4; k < 16; ++k) {
      EXPECT_NEAR(force(1, k), scene.ambient * l0, 0.01 * scene.ambient * l0);
      EXPECT_NEAR(force(0, k), 0, 1e-9 * scene.ambient * l0);
    }
  }
}

TEST(InterfaceLoad, SymmetricGradientGivesToTankAndBodyWhatItTakesFromTheWater) {
  Scene scene;
  const LayerForces<2> forces = scene.forces(Gradient::pairwise);
  std::vector<std::uint8_t> water(scene.state.kind.size(), 0);
  std::fill_n(water.begin(), scene.boundary.water(), std::uint8_t{1});
  const Vectors<2> gradient = pressure_gradient<2>(scene.state, scene.boundary, scene.near(), scene.lattice,
                                                   Gradient::pairwise, {water, {}});
  const Vector<2> on_water = -l0 * l0 * gradient.rowwise().sum();
  EXPECT_LT((on_water + forces.rowwise().sum()).norm(), 1e-12 * forces.colwise().norm().sum());
}

TEST(InterfaceLoad, DryFacesFeelNothingFromTheFaceIntegral) {
  Scene scene;
  const Vectors<2> force = gather_on_points<2>(scene.forces(Gradient::corrected), scene.boundary);
  for (int k = 20; k < scene.boundary.body_surface().points(); ++k) EXPECT_EQ(force.col(k).norm(), 0);
}

}  // namespace interface_load_test
}  // namespace strake::fluid
