#include "fluid/case/read_parameters.hpp"

#include "fluid/parameters/parameters.hpp"
#include "proto/case/case_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace strake::fluid {
namespace read_parameters_test {

const std::string tank = R"(
end_time = 0.03
[fluid]
spacing = 0.01
tank = [[-1.0, -0.5, 0.0], [1.0, 0.5, 0.0]]
water = [[-1.0, -0.5, 0.0], [1.0, 0.0, 0.0]]
)";

Parameters read_with(const std::vector<std::string>& sets, const std::string& text = tank) {
  CaseFile file = CaseFile::parse(text, "case.toml", sets);
  Parameters parameters = read(file);
  file.refuse_unknown("fluid");
  return parameters;
}

std::string error_of(const std::vector<std::string>& sets, const std::string& text = tank) {
  try {
    read_with(sets, text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::case_file);
    return to_text(error);
  }
  return "no error";
}

void expect_in(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(FluidKeys, the_improved_preset_is_compressible_least_squares_and_without_tension) {
  const auto p = read_with({});
  EXPECT_EQ(p.sound_speed, 1500);
  EXPECT_EQ(p.scheme.gradient, Gradient::least_squares);
  EXPECT_EQ(p.scheme.shifting, 5);
  EXPECT_EQ(p.scheme.second, SecondCriterion::arc);
  EXPECT_EQ(p.scheme.gamma, 0);
  EXPECT_EQ(p.scheme.tau, 0.02);
  EXPECT_FALSE(p.scheme.negative_pressure);
  EXPECT_EQ(p.scheme.anti_penetration, AntiPenetration::collision);
  EXPECT_TRUE(p.scheme.collision_conserve);
}

TEST(FluidKeys, volume_coupling_takes_the_symmetric_gradient_and_refuses_least_squares) {
  const auto p = read_with({"coupling.interface=volume", "structure.solver=particle"});
  EXPECT_EQ(p.scheme.gradient, Gradient::pairwise);
  EXPECT_EQ(p.scheme.shifting, 0);
  EXPECT_EQ(p.scheme.filter, 4);
  EXPECT_EQ(read_with({"fluid.scheme.gradient=pairwise"}).scheme.filter, 0);
  EXPECT_EQ(read_with({"fluid.scheme.gradient=pairwise", "fluid.scheme.filter=2"}).scheme.filter, 2);
  expect_in(error_of({"coupling.interface=volume", "structure.solver=particle",
                      "fluid.scheme.gradient=least-squares"}),
            "pairwise");
}

TEST(FluidKeys, least_squares_refuses_a_source_that_it_does_not_have) {
  expect_in(error_of({"fluid.scheme.source.density_at=star"}), "least-squares");
}

TEST(FluidKeys, the_paper_preset_is_the_papers_scheme) {
  const auto p = read_with({"preset=paper"});
  EXPECT_TRUE(std::isinf(p.sound_speed));
  EXPECT_EQ(p.scheme.source, Source::mixed);
  EXPECT_EQ(p.scheme.density_at, DensityAt::old);
  EXPECT_EQ(p.scheme.gamma, 0.01);
  EXPECT_EQ(p.scheme.tau, 0);
  EXPECT_EQ(p.scheme.gradient, Gradient::min_pressure);
  EXPECT_EQ(p.scheme.beta, 0.97);
  EXPECT_EQ(p.scheme.second, SecondCriterion::none);
  EXPECT_FALSE(p.scheme.negative_pressure);
  EXPECT_EQ(p.scheme.anti_penetration, AntiPenetration::average);
  EXPECT_FALSE(p.scheme.collision_conserve);
  EXPECT_EQ(p.scheme.preconditioner, Preconditioner::automatic);
  EXPECT_EQ(p.scheme.time_step, 2e-6);
  EXPECT_EQ(p.scheme.turbulence, Turbulence::statics);
}

TEST(FluidKeys, steps_that_resolve_sound_are_for_bodies_that_may_fall_level) {
  for (const std::string shape :
       {"wedge.deadrise=30", "cylinder.radius=0.1", "sphere.radius=0.1", "mesh=a.msh"})
    EXPECT_TRUE(std::isinf(read_with({"structure." + shape}).scheme.time_step)) << shape;
  EXPECT_TRUE(std::isinf(read_with({"structure.solver=none"}).scheme.time_step));
  for (const std::string body : {"plate.length=0.4", "solver=./own_program", "solver=replay"})
    EXPECT_EQ(read_with({"structure." + body}).scheme.time_step, 2e-6) << body;
  EXPECT_EQ(read_with({"structure.wedge.deadrise=30", "preset=paper"}).scheme.time_step, 2e-6);
  EXPECT_EQ(read_with({"structure.wedge.deadrise=30", "fluid.scheme.time_step=2e-6"}).scheme.time_step, 2e-6);
}

TEST(FluidKeys, incompressible_water_takes_a_window_in_one_step) {
  EXPECT_EQ(read_with({"fluid.sound_speed=inf"}).scheme.time_step, 1e-5);
  EXPECT_EQ(read_with({"fluid.sound_speed=inf", "coupling.surface.window=1e-4"}).scheme.time_step, 1e-4);
  EXPECT_EQ(read_with({"fluid.sound_speed=inf", "fluid.scheme.time_step=2e-6"}).scheme.time_step, 2e-6);
  EXPECT_EQ(read_with({}).scheme.time_step, 2e-6);
}

TEST(FluidKeys, a_key_of_the_case_is_stronger_than_the_preset) {
  const auto p = read_with({"preset=paper", "fluid.sound_speed=1500", "fluid.scheme.gradient=corrected",
                            "fluid.scheme.source.tau=0.01"});
  EXPECT_EQ(p.sound_speed, 1500);
  EXPECT_EQ(p.scheme.gradient, Gradient::corrected);
  EXPECT_EQ(p.scheme.tau, 0.01);
  EXPECT_EQ(p.scheme.gamma, 0);  // given one, the other's default steps back
  EXPECT_TRUE(std::isinf(read_with({"fluid.sound_speed=inf"}).sound_speed));
  EXPECT_EQ(read_with({"fluid.scheme.source.gamma=0.001"}).scheme.tau, 0);
}

TEST(FluidKeys, a_resolved_case_reads_back_to_the_same_values) {
  for (const char* preset : {"preset=paper", "preset=improved"})
    for (const char* key : {"fluid.scheme.turbulence.cs=0.2", "fluid.scheme.turbulence.c_eps=0.9",
                            "fluid.scheme.source.gamma=0.02", "fluid.scheme.source.tau=0.05"}) {
      CaseFile file = CaseFile::parse(tank, "case.toml", {preset, key});
      const auto p = read(file);
      const auto again = read_with({}, file.echo());
      EXPECT_EQ(again.scheme.c_eps, p.scheme.c_eps) << key;
      EXPECT_EQ(again.scheme.gamma, p.scheme.gamma) << key;
      EXPECT_EQ(again.scheme.tau, p.scheme.tau) << key;
      EXPECT_EQ(again.sound_speed, p.sound_speed) << key;
      EXPECT_EQ(again.tank.max, p.tank.max) << key;
    }
}

TEST(FluidKeys, smagorinskys_constant_sets_the_dissipation) {
  const auto p = read_with({"fluid.scheme.turbulence.cs=0.2"});
  EXPECT_NEAR(std::pow(std::pow(p.scheme.c_nu, 3) / p.scheme.c_eps, 0.25), 0.2, 1e-12);
  expect_in(error_of({"fluid.scheme.turbulence.cs=0.2", "fluid.scheme.turbulence.c_eps=1.0"}),
            "cs or c_eps, not both");
}

TEST(FluidKeys, removed_choices_are_refused_with_those_that_remain) {
  const std::string pressure = "fluid.scheme.pressure.";
  for (const char* solver : {"cholmod", "hypre"})
    expect_in(error_of({pressure + "solver=" + solver}), "\"cg\"");
  expect_in(error_of({pressure + "preconditioner=ic"}), "\"jacobi\"");
  expect_in(error_of({"fluid.scheme.source.kind=density"}), "\"divergence\"");
  expect_in(error_of({"fluid.scheme.surface.second=asymmetry"}), "\"arc\"");
  expect_in(error_of({"fluid.scheme.turbulence.sps=laplacian"}), "\"stress_pair\"");
  EXPECT_NO_THROW(read_with({pressure + "solver=cg"}));  // an old case
}

TEST(FluidKeys, a_wrong_key_or_value_is_refused_with_its_name) {
  expect_in(error_of({"fluid.spacng=0.02"}), "spacing");
  expect_in(error_of({"fluid.spacing=-0.01"}), "fluid.spacing");
  expect_in(error_of({"fluid.density=\"heavy\""}), "fluid.density");
  expect_in(error_of({"fluid.scheme.gradient=upwind"}), "min-pressure");
  expect_in(error_of({"fluid.scheme.source.gamma=0.01", "fluid.scheme.source.tau=0.01"}), "not both");
}

// The cause in the case is what is named: volume coupling has another gradient than least-squares too.
TEST(FluidKeys, air_is_refused_where_it_is_not_computed) {
  const auto with_air = [](std::vector<std::string> sets) {
    sets.push_back("fluid.air.layer=true");
    return error_of(sets);
  };
  EXPECT_EQ(with_air({"structure.solver=rigid"}), "no error");
  expect_in(with_air({"structure.solver=particle", "coupling.interface=volume"}),
            "coupling.interface = \"surface\"");
  expect_in(with_air({"structure.solver=rigid", "preset=paper"}), "preset = \"improved\"");
  expect_in(with_air({"structure.solver=none"}), "there is no body");
  expect_in(with_air({"structure.solver=rigid", "fluid.air.pressure=0"}), "fluid.air.pressure");
}

TEST(FluidKeys, a_time_step_longer_than_the_window_is_refused) {
  expect_in(error_of({"fluid.scheme.time_step=1e-4"}), "fluid.scheme.time_step");
  EXPECT_EQ(read_with({"coupling.surface.window=1e-6"}).scheme.time_step, 1e-6);  // the default yields
}

TEST(FluidKeys, water_and_tank_that_do_not_fit_are_refused_at_their_key) {
  expect_in(error_of({"fluid.water=[[-1.0,-0.5],[1.2,0.0]]"}), "fluid.water");
  expect_in(error_of({"fluid.water=[[-1.0,-0.5],[1.0,0.004]]"}), "the nearest is 0 m");
  const std::string odd = error_of({"fluid.tank=[[-1.0,-0.5],[1.004,0.493]]"});
  expect_in(odd, "x = 1.004 m, y = 0.493 m are not");
  expect_in(odd, "the nearest are x = 1 m, y = 0.49 m");
  expect_in(error_of({"fluid.tank=[[-1.0,-0.5],[1.001,0.5]]"}), "fluid.tank");
  expect_in(error_of({"fluid.spacing=0.25"}), "particles across the water");
}

TEST(FluidKeys, a_sensor_outside_the_tank_is_refused_and_its_diameter_defaults_to_two_spacings) {
  const auto with_probe = [](const std::string& at) {
    return tank + "[[output.probe]]\nname = \"p\"\nof = \"fluid\"\nat = " + at + "\n";
  };
  EXPECT_EQ(read_with({}, with_probe("[0.0, -0.5]")).probes.at(0).diameter, 0.02);
  expect_in(error_of({}, with_probe("[0.0, -0.7]")), "outside fluid.tank");
}

TEST(FluidKeys, declarations_need_no_case) {
  CaseFile nothing = CaseFile::declarations_only();
  read(nothing);
  bool found = false;
  for (const auto& key : nothing.declared())
    if (key.path == "fluid.scheme.source.tau") found = key.unit == "s" && !key.help.empty();
  EXPECT_TRUE(found);
}

}  // namespace read_parameters_test
}  // namespace strake::fluid
