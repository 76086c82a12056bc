#include "fluid/boundary/fill.hpp"
#include "fluid/case/read_parameters.hpp"
#include "fluid/parameters/parameters.hpp"
#include "proto/case/case_file.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace strake::fluid {
namespace tank_keys_test {

/// A case with that in [fluid] beside its spacing, 2 cm.
std::string fluid_case(const std::string& keys) {
  return "end_time = 0.5\n[fluid]\nspacing = 0.02\n" + keys;
}
const std::string box = "tank = [[0.0, 0.0], [1.0, 0.6]]\nwater = [[0.0, 0.0], [1.0, 0.4]]\n";

Parameters read_with(const std::string& keys, const std::string& name = "case.toml") {
  CaseFile file = CaseFile::parse(fluid_case(keys), name);
  Parameters parameters = read(file);
  file.refuse_unknown("fluid");
  // What the resolved case says is what was read.
  CaseFile again = CaseFile::parse(file.echo(), name);
  const Parameters echoed = read(again);
  EXPECT_EQ(echoed.tank_polygon.size(), parameters.tank_polygon.size());
  EXPECT_EQ(echoed.water_shapes.size(), parameters.water_shapes.size());
  EXPECT_EQ(echoed.periodic, parameters.periodic);
  EXPECT_EQ(echoed.initial_velocity.value, parameters.initial_velocity.value);
  EXPECT_EQ(echoed.initial_velocity.gradient, parameters.initial_velocity.gradient);
  EXPECT_EQ(echoed.motion.roll, parameters.motion.roll);
  EXPECT_EQ(echoed.motion.table.has_value(), parameters.motion.table.has_value());
  return parameters;
}

void expect_error(const std::string& keys, const std::string& part, const std::string& name = "case.toml") {
  try {
    CaseFile file = CaseFile::parse(fluid_case(keys), name);
    read(file);
    ADD_FAILURE() << "no error, expected: " << part;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::case_file);
    EXPECT_NE(to_text(error).find(part), std::string::npos) << to_text(error);
  }
}

TEST(TankKeys, a_case_of_the_plane_has_no_water_in_space) {
  expect_error(box + "dimension = 3\n", "water with a length along z: fluid.dimension is 3");
}

TEST(TankKeys, a_box_is_open_smooth_and_at_rest_unless_told_otherwise) {
  const auto p = read_with(box);
  EXPECT_TRUE(p.open_top);
  EXPECT_EQ(p.wall, WallSlip::free_slip);
  EXPECT_FALSE(p.motion.moves());
  EXPECT_EQ(p.periodic, (std::array<bool, 3>{}));
  EXPECT_EQ(read_with(box + "wall = \"no-slip\"\nopen_top = false\n").wall, WallSlip::no_slip);
}

TEST(TankKeys, a_polygon_stands_in_place_of_the_box) {
  const std::string polygon = "tank_polygon = [[-0.2, 0.6], [0.0, 0.0], [1.0, 0.0], [1.0, 0.6]]\n";
  const auto p = read_with(polygon + "water = [[-0.2, 0.0], [1.0, 0.4]]\n");
  ASSERT_EQ(p.tank_polygon.size(), 4u);
  EXPECT_EQ(p.tank.min.x(), -0.2);
  EXPECT_EQ(p.tank.max.y(), 0.6);
  EXPECT_GT(fill<2>(p).position.cols(), 900);
  expect_error(polygon + box, "not both");
  expect_error("tank_polygon = [[1.0, 0.6], [1.0, 0.0], [0.0, 0.0], [-0.2, 0.6]]\n" +
                   std::string("water = [[-0.2, 0.0], [1.0, 0.4]]\n"),
               "counter-clockwise");
  // The same corners from another one on: the open side would be a wall of the water.
  expect_error("tank_polygon = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.6], [-0.2, 0.6]]\n" +
                   std::string("water = [[-0.2, 0.0], [1.0, 0.4]]\n"),
               "no wall stands between (-0.2, 0.6) and (0, 0)");
  expect_error("dimension = 3\n" + polygon + "water = [[-0.2, 0.0], [1.0, 0.4]]\n", "three dimensions");
  expect_error(
      "tank = { polygon = [[-0.2, 0.6], [0.0, 0.0], [1.0, 0.6]] }\n"
      "water = [[0.0, 0.0], [1.0, 0.4]]\n",
      "another shape has a key of its own: tank_polygon");
}

TEST(TankKeys, water_may_be_boxes_and_polygons) {
  const auto p = read_with(
      "tank = [[0.0, 0.0], [1.0, 0.6]]\nwater = [[0.0, 0.0], [0.2, 0.4]]\n"
      "[[fluid.more_water]]\nbox = [[0.8, 0.0], [1.0, 0.2]]\n"
      "[[fluid.more_water]]\npolygon = [[0.3, 0.0], [0.7, 0.0], [0.7, 0.2]]\n");
  ASSERT_EQ(p.water_shapes.size(), 3u);
  EXPECT_EQ(p.water.max.x(), 1.0);
  EXPECT_EQ(p.water.max.y(), 0.4);
  expect_error(
      "tank = [[0.0, 0.0], [1.0, 0.6]]\nwater = [[0.0, 0.0], [0.2, 0.4]]\n"
      "[[fluid.more_water]]\nbox = [[0.8, 0.0], [1.2, 0.2]]\n",
      "inside fluid.tank");
}

TEST(TankKeys, three_dimensions_are_read) {
  const auto p = read_with(
      "dimension = 3\ntank = [[0.0, 0.0, 0.0], [0.4, 0.4, 0.2]]\n"
      "water = [[0.0, 0.0, 0.0], [0.4, 0.2, 0.2]]\nperiodic = [\"z\"]\n");
  EXPECT_TRUE(p.periodic[2]);
  EXPECT_EQ(fill<3>(p).kind.size() % 10, 0u);  // every line of ten along z
}

TEST(TankKeys, walls_that_absorb_sound_are_named) {
  const auto p = read_with(box + "absorbing = [\"bottom\", \"sides\"]\n");
  EXPECT_TRUE(p.absorbing_bottom);
  EXPECT_TRUE(p.absorbing_sides);
  EXPECT_FALSE(read_with(box + "absorbing = [\"bottom\"]\n").absorbing_sides);
  expect_error(box + "absorbing = [\"lid\"]\n", "\"bottom\" and \"sides\"");
  expect_error(box + "absorbing = [\"bottom\"]\nsound_speed = inf\n", "no echo");
  expect_error(box + "absorbing = [\"bottom\"]\n[fluid.scheme]\ngradient = \"pairwise\"\n", "least-squares");
}

TEST(TankKeys, sound_may_keep_to_the_water_near_the_surface) {
  EXPECT_TRUE(std::isinf(read_with(box).sound_depth));
  EXPECT_EQ(read_with(box + "sound_depth = 0.1\n").sound_depth, 0.1);
  expect_error(box + "sound_depth = 0.1\nsound_speed = inf\n", "no sound");
  expect_error(box + "sound_depth = 0.1\nabsorbing = [\"bottom\"]\n", "not both");
  expect_error(box + "sound_depth = 0.01\n", "the sheet");
  expect_error(box + "sound_depth = 10.0\n", "the sheet");
  expect_error(box + "sound_depth = 0.1\n[fluid.scheme]\ngradient = \"pairwise\"\n", "least-squares");
}

TEST(TankKeys, the_water_may_start_with_a_linear_velocity) {
  EXPECT_TRUE(read_with(box).initial_velocity.is_zero());
  const auto of = [](const std::string& keys) { return box + "[fluid.initial_velocity]\n" + keys; };
  const auto p = read_with(of("value = [0.5, 0.0]\ngradient = [[2.0, -1.0], [3.0, -2.0]]\n"));
  EXPECT_LT((p.initial_velocity.at({0.1, 0.2, 0}) - Eigen::Vector3d(0.5, -0.1, 0)).norm(), 1e-12);
  const auto state = fill<2>(p);
  for (Eigen::Index i = 0; i < state.position.cols(); ++i) {
    const bool water = state.kind[static_cast<std::size_t>(i)] == Kind::fluid;
    const double x = state.position(0, i), y = state.position(1, i);
    ASSERT_NEAR(state.velocity(0, i), water ? 0.5 + 2 * x - y : 0, 1e-12);
    ASSERT_NEAR(state.velocity(1, i), water ? 3 * x - 2 * y : 0, 1e-12);
  }
  expect_error(of("gradient = [[2.0, 0.0], [0.0, -1.9]]\n"), "does not expand");
  expect_error(of("gradient = [[2.0, 0.0], [0.0, -2.0], [0.0, 0.0]]\n"), "two rows");
  expect_error(of("value = [0.0, 0.0, 1.0]\n"), "nothing along z");
  expect_error(of("gradient = [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]\n"), "nothing along z");
  expect_error("periodic = [\"x\"]\n" + of("gradient = [[0.0, 0.0], [1.0, 0.0]]\n"), "periodic axis");
  const std::string space =
      "dimension = 3\ntank = [[0, 0, 0], [0.4, 0.4, 0.2]]\nwater = [[0, 0, 0], [0.4, 0.2, 0.2]]\n"
      "[fluid.initial_velocity]\n";
  const auto turning = read_with(space + "gradient = [[0, 0, 1], [0, 0, 0], [-1, 0, 0]]\n");
  EXPECT_EQ(turning.initial_velocity.at({1, 2, 3}), Eigen::Vector3d(3, 0, -1));
  expect_error(space + "gradient = [[0, 1], [1, 0]]\n", "three rows");
}

TEST(TankKeys, a_moving_tank_carries_water_that_has_a_velocity_of_its_own) {
  const auto p = read_with(box +
                           "initial_velocity = { value = [0.0, 0.25] }\n[fluid.motion]\namplitude = 0.1\n"
                           "direction = [1.0, 0.0, 0.0]\nfrequency = 0.5\n");
  const auto start = p.motion.at(0).velocity;
  EXPECT_GT(start.x(), 0.1);
  const auto state = fill<2>(p);
  EXPECT_NEAR(state.velocity(0, 0), start.x(), 1e-12);
  EXPECT_NEAR(state.velocity(1, 0), 0.25, 1e-12);
}

TEST(TankKeys, periodic_axes_are_checked) {
  EXPECT_TRUE(read_with(box + "periodic = [\"x\"]\n").periodic[0]);
  expect_error(box + "periodic = [\"z\"]\n", "\"x\" and \"y\"");
  expect_error("tank = [[0.0, 0.0], [0.1, 0.6]]\nwater = [[0.0, 0.0], [0.1, 0.4]]\nperiodic = [\"x\"]\n",
               "a period of at least");
  expect_error(box + "periodic = [\"x\"]\n[fluid.motion]\nroll = 3.0\nfrequency = 1.0\n", "does not turn");
}

TEST(TankKeys, a_sine_moves_the_tank_along_a_direction_and_about_a_pivot) {
  const auto p = read_with(box +
                           "[fluid.motion]\namplitude = 0.1\ndirection = [0.0, 2.0, 0.0]\nroll = 5.0\n"
                           "frequency = 0.5\npivot = [0.5, 0.2]\n");
  EXPECT_NEAR(p.motion.at(0.5).displacement.y(), 0.1, 1e-12);
  EXPECT_NEAR(p.motion.at(0.5).angle, 5.0 * 3.14159265358979 / 180, 1e-9);
  expect_error(box + "[fluid.motion]\namplitude = 0.1\n", "fluid.motion.frequency");
}

TEST(TankKeys, a_table_moves_the_tank_and_belongs_to_the_cases_hash) {
  const TemporaryFolder folder;
  const std::filesystem::path table = folder.path() / "roll.csv", where = folder.path() / "case.toml";
  const std::string keys = box + "[fluid.motion]\nfile = \"roll.csv\"\n";
  const auto write = [&](const std::string& text) { std::ofstream(table) << text; };
  write("t [s],x [m],angle [deg]\n0,0,0\n0.25,0.01,1\n0.5,0.03,2\n1,0.02,0\n");
  const auto p = read_with(keys, where.string());
  ASSERT_TRUE(p.motion.table);
  EXPECT_NEAR(p.motion.at(0.5).displacement.x(), 0.03, 1e-12);
  const auto before = CaseFile::parse(fluid_case(keys), where.string()).hash();
  write("t [s],x [m]\n0,0\n0.25,0.01\n0.5,0.04\n1,0.02\n");
  EXPECT_NE(CaseFile::parse(fluid_case(keys), where.string()).hash(), before);

  write("t [s],x [m]\n0,0.1\n0.5,0.2\n1,0.1\n");
  expect_error(keys, "0 at t = 0", where.string());
  write("t [s],x [m]\n0,0\n0.2,0.1\n0.4,0.2\n");
  expect_error(keys, "end_time", where.string());
  write("t [s],x [m]\n0,0\n0.2,oops\n0.6,0.2\n");
  expect_error(keys, "roll.csv", where.string());
  write("t [s],x [m]\n0,0\n0.2,0.1\n0.1,0.2\n");
  expect_error(keys, "rising order", where.string());
}

}  // namespace tank_keys_test
}  // namespace strake::fluid
