#include "fluid/mps/number_density.hpp"
#include "fluid/viscosity/viscosity.hpp"
#include "fluid/viscosity/viscous_stage.hpp"
#include "tests/fluid/lattice.hpp"
#include "tests/fluid/viscosity/channel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace strake::fluid {
namespace turbulence_test {

constexpr double l0 = 0.01;

template <int dim>
struct Flow {
  int side;
  Vectors<dim> position, velocity;
  NeighbourSearch<dim> search{3.1 * l0, 0};
  const Neighbours *far, *near;
  Parameters parameters;
  WallLayers<dim> walls;  // none
  Eigen::VectorXd k;
  Flow(int n, double disorder) : side(n), position(block<dim>(n, l0, disorder)) {
    far = &search.update(position);
    near = &search.within(2.1 * l0);
    parameters.dimension = dim;
    parameters.spacing = l0;
    parameters.kinematic_viscosity = 0;
    parameters.scheme.gradient = Gradient::pairwise;
    velocity = Vectors<dim>::Zero(dim, position.cols());
  }
  ViscousStage<dim> stage() {
    walls.resize(position.cols(), 0);
    k.setZero(position.cols());
    ViscousStage<dim> viscous;
    viscous.compute(parameters, {position, velocity, *near, *far, walls}, 0, k);
    return viscous;
  }
  std::vector<std::int64_t> inside() const { return interior<dim>(side, 5); }
};

TEST(Sps, constants_give_the_papers_smagorinsky_number) {
  EXPECT_NEAR(SpsModel{}.cs(), 0.1504, 5e-5);  // (0.08³)^¼
}

TEST(Sps, production_in_the_plane_is_equation_11) {
  Tensor<2> gradient;
  gradient << 2.0, -3.0, 0.5, 7.0;
  EXPECT_DOUBLE_EQ(production<2>(gradient), 2 * (4.0 + 49.0) + 2.5 * 2.5);
}

TEST(Sps, equilibrium_holds_between_k_viscosity_and_dissipation) {
  Flow<2> flow(11, 0);
  flow.velocity.row(0) = 300.0 * flow.position.row(1);
  const auto stage = flow.stage();
  const std::size_t i = 60;  // the middle
  const double c_nu = 0.08, c_eps = 1.0, production = 300.0 * 300.0;
  const double k = flow.k[60], eddy = stage.viscosity()[i];  // the water has none of its own
  EXPECT_NEAR(eddy, c_nu * l0 * std::sqrt(k), 1e-15);
  EXPECT_NEAR(eddy * production, c_eps * std::pow(k, 1.5) / l0, 1e-9);
}

template <int dim>
void linear_shear(SpsForm form) {
  Flow<dim> flow(dim == 2 ? 15 : 11, 0);
  flow.parameters.scheme.sps = form;
  flow.parameters.kinematic_viscosity = 1e-3;
  flow.velocity.row(0) = 100.0 * flow.position.row(1);
  const auto acceleration = flow.stage().acceleration;
  // Round-off of τ/l0: ν_t S ≈ 0.023 m²/s² over 0.01 m.
  for (const auto i : flow.inside()) EXPECT_LT(acceleration.col(i).norm(), 1e-10);
}
TEST(Sps, a_linear_shear_has_no_force_inside_the_lattice) {
  linear_shear<2>(SpsForm::joint);
  linear_shear<3>(SpsForm::joint);
  linear_shear<2>(SpsForm::stress_pair);
  linear_shear<3>(SpsForm::stress_pair);
}

// Parabolic profile u = a y², v = 0. S = a y off-diagonal, Pr = (2 a y)², ν_t = (C_s Δ)² 2 a y, τ_xy = (C_s
// Δ)² (2 a y)², ∂τ_xy/∂y = 8 (C_s Δ)² a² y, and −(2/3)∂k/∂y = −(16/3)(C_ν/C_ε) Δ² a² y. Symmetric differences
// on the lattice sum quadratic stresses exactly; the velocity gradient of a parabola is exact there too.
TEST(Sps, a_parabolic_profile_has_the_analytic_force) {
  Flow<2> flow(21, 0);
  flow.position.row(1).array() += 1.0;  // y > 0 everywhere, so |S| does not change sign
  flow.far = &flow.search.update(flow.position);
  flow.near = &flow.search.within(2.1 * l0);
  const double a = 40, mixing = SpsModel{}.cs() * l0;
  flow.velocity.row(0) = a * flow.position.row(1).array().square();
  const auto acceleration = flow.stage().acceleration;
  for (const auto i : flow.inside()) {
    const double y = flow.position(1, i);
    EXPECT_NEAR(acceleration(0, i), 8 * mixing * mixing * a * a * y, 1e-9);
    EXPECT_NEAR(acceleration(1, i), -16.0 / 3 * 0.08 * l0 * l0 * a * a * y, 1e-9);
  }
}

TEST(Sps, the_stress_pair_form_keeps_linear_momentum_to_round_off) {
  Flow<2> flow(21, 0.3);
  flow.parameters.kinematic_viscosity = 1e-3;
  flow.velocity.row(0) = (200 * flow.position.row(1)).array().sin();
  flow.velocity.row(1) = (150 * flow.position.row(0)).array().cos();
  const auto acceleration = flow.stage().acceleration;
  EXPECT_LT(acceleration.rowwise().sum().norm(), 1e-13 * acceleration.cwiseAbs().sum());
}

TEST(Sps, spray_with_fewer_than_four_neighbours_has_no_eddy_viscosity) {
  const std::vector<Tensor<2>> gradient(2, Tensor<2>::Constant(50.0));
  SpsModel model;
  model.filter = l0;
  const auto sps = sps_fields<2>(gradient, std::vector<std::int32_t>{3, 4}, model);
  EXPECT_EQ(sps.eddy_viscosity[0], 0);
  EXPECT_EQ(sps.k[0], 0);
  EXPECT_GT(sps.eddy_viscosity[1], 0);
}

TEST(Sps, wall_damping_takes_the_eddy_viscosity_to_zero_at_the_wall_and_leaves_it_far_away) {
  const std::vector<Tensor<2>> gradient(3, Tensor<2>::Constant(50.0));
  SpsModel model;
  model.filter = l0;
  model.kinematic_viscosity = 1e-6;
  const std::vector<std::int32_t> counts{12, 12, 12};
  const auto free = sps_fields<2>(gradient, counts, model);
  model.wall_damping = true;
  const auto damped = sps_fields<2>(gradient, counts, model, std::vector<double>{0.0, 1.0});
  EXPECT_EQ(damped.eddy_viscosity[0], 0);
  EXPECT_NEAR(damped.eddy_viscosity[1], free.eddy_viscosity[1], 1e-12);
  EXPECT_EQ(damped.eddy_viscosity[2], 0);  // a layer particle, which has no distance
}

// Steady shear: k rises from zero to the value of the static closure, (C_ν/C_ε) Δ² Pr, where production
// equals dissipation. This takes about 1/(½ √(C_ν C_ε Pr)) = 0.07 s. Away from the edges k is uniform, so
// that diffusion is zero.
TEST(SpsEnergy, steady_shear_takes_the_k_model_to_the_static_closure) {
  Channel channel(20, 0.1, true);
  channel.parameters.scheme.turbulence = Turbulence::k;
  channel.parameters.kinematic_viscosity = 1e-6;
  for (std::int64_t i = 0; i < channel.water; ++i) channel.velocity(0, i) = 100 * channel.y(i);
  for (std::int64_t w = 0; w < channel.walls.size(); ++w) {  // smooth for k, but the shear continues
    channel.walls.normal.col(w).setZero();
    channel.walls.velocity(0, w) = 100 * channel.y(channel.water + w);
  }
  for (std::size_t w = 0; w < channel.walls.master.size(); ++w) channel.walls.master[w] = -1;
  channel.walls.slip.assign(channel.walls.slip.size(), 0);
  const SpsModel model = sps_model(channel.parameters);
  const double equilibrium = model.equilibrium(1e4);
  channel.acceleration(1e-3);
  const std::int64_t middle = channel.water / 2 + Channel::along / 2;
  EXPECT_GT(channel.k[middle], 0);
  EXPECT_LT(channel.k[middle], 0.1 * equilibrium);
  for (int step = 0; step < 500; ++step) channel.acceleration(1e-3);
  EXPECT_NEAR(channel.k[middle], equilibrium, 1e-3 * equilibrium);
  EXPECT_NEAR(channel.stage.viscosity()[static_cast<std::size_t>(middle)] - model.kinematic_viscosity,
              std::pow(model.cs() * channel.l0, 2) * 100, 1e-3 * model.eddy_viscosity(equilibrium));
}

// dk/dt = −C_ε k^{3/2}/Δ: k = k0/(1 + ½ C_ε k0^½ t/Δ)², exact for any step.
TEST(SpsEnergy, k_without_shear_decays_by_the_exact_solution) {
  Channel channel(10, 0, true);
  channel.parameters.scheme.turbulence = Turbulence::k;
  channel.k.head(channel.water).setConstant(0.04);
  for (const double dt : {0.01, 0.2, 1.0}) {
    const double before = channel.k[0];
    channel.acceleration(dt);
    const double exact = before / std::pow(1 + 0.5 * std::sqrt(before) * dt / channel.l0, 2);
    EXPECT_NEAR(channel.k.head(channel.water).minCoeff(), exact, 1e-14);
    EXPECT_NEAR(channel.k.head(channel.water).maxCoeff(), exact, 1e-14);
  }
}

TEST(SpsEnergy, diffusion_keeps_k_positive_for_a_huge_step_and_takes_it_to_zero_at_rough_walls) {
  Channel channel(10, 0.1);
  channel.parameters.scheme.turbulence = Turbulence::k;
  channel.k[37] = 1.0;
  channel.acceleration(100.0);
  EXPECT_GE(channel.k.head(channel.water).minCoeff(), 0);
  EXPECT_LT(channel.k.maxCoeff(), 1.0);
  Channel smooth(10, 0, true), rough(10, 0, false);
  for (Channel* c : {&smooth, &rough}) {
    c->parameters.scheme.turbulence = Turbulence::k;
    c->parameters.scheme.c_eps = 1e-9;  // diffusion alone
    c->k.head(c->water).setConstant(0.01);
    for (int step = 0; step < 100; ++step) c->acceleration(1e-3);
  }
  EXPECT_NEAR(smooth.k.head(smooth.water).minCoeff(), 0.01, 1e-9);  // no flux
  EXPECT_LT(rough.k[0], 0.5 * rough.k[rough.water / 2]);
}

TEST(SpsEnergy, every_model_is_switched_by_its_key) {
  for (const Turbulence kind : {Turbulence::none, Turbulence::statics, Turbulence::k})
    for (const SpsForm form : {SpsForm::joint, SpsForm::stress_pair}) {
      Channel channel(10, 0.1);
      channel.parameters.scheme.turbulence = kind;
      channel.parameters.scheme.sps = form;
      channel.parameters.scheme.radius_laplacian = 2.1;
      for (std::int64_t i = 0; i < channel.water; ++i) channel.velocity(0, i) = std::sin(9 * channel.y(i));
      channel.acceleration(0.01);
      EXPECT_TRUE(channel.stage.acceleration.allFinite());
      EXPECT_EQ(channel.k.maxCoeff() > 0, kind != Turbulence::none);
    }
}

TEST(Viscosity, a_parabolic_profile_feels_twice_nu_times_its_curvature) {
  Flow<2> flow(15, 0);
  flow.parameters.kinematic_viscosity = 1e-3;
  flow.parameters.scheme.turbulence = Turbulence::none;
  flow.velocity.row(0) = 40.0 * flow.position.row(1).array().square();
  const auto acceleration = flow.stage().acceleration;
  for (const auto i : flow.inside()) {
    EXPECT_NEAR(acceleration(0, i), 80e-3, 1e-12);
    EXPECT_NEAR(acceleration(1, i), 0, 1e-12);
  }
}

}  // namespace turbulence_test
}  // namespace strake::fluid
