#include "proto/error.hpp"
#include "proto/files/result_file.hpp"
#include "tests/fluid/participant_case.hpp"
#include "tests/fluid/solid_case.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace strake::fluid {
namespace participant_test {

TEST(FluidParticipant, a_level_face_met_in_long_steps_gets_a_line) {
  const auto says = [](const std::vector<std::string>& sets) {
    const Case c(sets);
    const auto lines = FluidParticipant<2>(c.parameters, c.common, entering()).description().lines;
    return lines.back().find("a level face of 0.1 m") != std::string::npos;
  };
  EXPECT_TRUE(says({}));  // c Δt = 1.5 l0
  EXPECT_FALSE(says({"fluid.scheme.time_step=5e-6"}));
  EXPECT_FALSE(says({"fluid.sound_speed=inf"}));
}

TEST(FluidParticipant, a_level_face_that_a_table_drives_from_rest_gets_the_line_too) {
  const auto says = [](const std::string& speed) {
    const TemporaryFolder folder;
    put(folder / "ramp.csv", "t [s],vy [m/s]\n0,0\n0.001," + speed + "\n");
    const Case c({"structure.motion.file=" + (folder / "ramp.csv").string()});
    strake::Setup setup = entering();
    setup.partner_initial.back() = moving("velocity", {0, 0, 0});
    const auto lines = FluidParticipant<2>(c.parameters, c.common, setup).description().lines;
    return lines.back().find("a level face of 0.1 m") != std::string::npos;
  };
  EXPECT_TRUE(says("-2"));
  EXPECT_FALSE(says("0"));
}

TEST(FluidParticipant, sends_the_force_of_each_step_where_the_structure_takes_a_history) {
  const Case c;
  strake::Setup setup = entering();
  FluidParticipant<2> silent(c.parameters, c.common, setup);
  setup.history = true;
  FluidParticipant<2> telling(c.parameters, c.common, setup);
  constexpr double longer = 10 * window;
  double largest = 0;
  for (int k = 0; k < contact_window / 10 + 2; ++k) {
    const Window w = nth(k, longer);
    const Advanced expected = silent.advance(w, at_speed(w)), told = telling.advance(w, at_speed(w));
    EXPECT_TRUE(expected.history.empty());
    expect_equal_bits(told, expected, k);
    ASSERT_FALSE(told.history.empty());
    EXPECT_EQ(told.history.back().time, w.t + w.dt);
    Eigen::MatrixXd impulse = Eigen::MatrixXd::Zero(3, plate().position.cols());
    double before = w.t;
    for (const Sample& sample : told.history) {
      impulse += (sample.time - before) * sample.fields.at(0).value;
      before = sample.time;
    }
    const Eigen::MatrixXd& mean = told.output.at(0).value;
    EXPECT_LE((impulse / w.dt - mean).norm(), 1e-9 * mean.norm());
    largest = std::max(largest, mean.norm());
    silent.commit(false);
    telling.commit(false);
  }
  EXPECT_GT(largest, 0);  // it has met the water
}

TEST(FluidParticipant, the_force_is_the_mean_over_the_window) {
  const Case c;
  FluidParticipant<2> fine(c.parameters, c.common, entering()), coarse(c.parameters, c.common, entering());
  for (int k = 0; k < contact_window / 2 + 5; ++k) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3, plate().position.cols());
    for (int half = 2 * k; half < 2 * k + 2; ++half) {
      sum += fine.advance(nth(half), at_speed(nth(half))).output.at(0).value;
      fine.commit(false);
    }
    const auto w = nth(k, 2 * window);
    const auto force = coarse.advance(w, at_speed(w)).output.at(0).value;
    coarse.commit(false);
    // The same steps, up to the round-off of the motion: velocity from differences of 1e-3 m over 1e-5 s.
    EXPECT_LT((force - sum / 2).norm(), 1e-6 * (force.norm() + 1)) << k;
  }
}

TEST(FluidParticipant,
     momentum_of_water_bodies_and_walls_is_accounted_for_to_round_off_with_the_symmetric_gradient) {
  Case c;
  c.parameters.scheme = with_gradient(c.parameters.scheme, Gradient::pairwise);
  FluidParticipant<2> participant(c.parameters, c.common, entering());
  Advanced last;
  for (int k = 0; k < contact_window + 20; ++k) {
    last = participant.advance(nth(k), at_speed(nth(k)));
    participant.commit(false);
  }
  EXPECT_LT(last.monitor.at("check.momentum_gap"), 1e-9);
  EXPECT_EQ(last.monitor.at("check.lost"), 0);
  EXPECT_EQ(last.monitor.at("count.fluid"), 300);
}

// Where nothing enters there is no 2ρVa², however slowly the body creeps; and the tank carries its bodies
// along.
TEST(FluidParticipant, a_body_that_starts_in_the_water_or_rides_with_the_tank_enters_nothing) {
  const Eigen::Vector3d creep(1e-6, 0, 0);
  strake::Setup setup = entering();
  setup.partner_initial = {moving("displacement", {0, 0, 0}), moving("velocity", creep)};
  const auto gap_and_headline = [&](const Parameters& parameters, const CommonKeys& common) {
    FluidParticipant<2> participant(parameters, common, setup);
    Advanced last;
    for (int k = 0; k < 5; ++k) {
      const Window w = nth(k);
      last = participant.advance(w, {{{w.t + w.dt, {moving("displacement", creep * (w.t + w.dt))}}}});
      participant.commit(false);
    }
    return std::pair(last.monitor.at("check.momentum_gap"), participant.description().lines.front());
  };
  const Case c({"fluid.submerged=true"}, "[0.0, -0.048]");
  setup.partner_mesh.position.row(1).array() -= 0.05;  // its lower face 48 mm below the surface
  EXPECT_LT(gap_and_headline(c.parameters, c.common).first, 0.1);

  setup.partner_mesh = plate();
  Case rides;
  rides.parameters.motion.table =
      MotionTable({0, 1}, {MotionColumn::rate}, {std::vector<double>{creep.x(), creep.x()}});
  const auto [gap, headline] = gap_and_headline(rides.parameters, rides.common);
  EXPECT_LT(gap, 0.1);
  EXPECT_EQ(headline.find("Re "), std::string::npos) << headline;
}

/// Momentum gap of a box of that size in space, 0.5 ms after contact. The tank reaches from −side to side.
double gap_of_box(const Eigen::Vector3d& size, const std::string& side = "0.12") {
  const Case c({"fluid.dimension=3", "fluid.tank=[[-0.12, -0.06, -" + side + "], [0.12, 0.1, " + side + "]]",
                "fluid.water=[[-0.12, -0.06, -" + side + "], [0.12, 0, " + side + "]]",
                "fluid.scheme.time_step=1e-4", "coupling.surface.window=1e-4", "run.threads=1"});
  strake::Setup setup;
  setup.interface = "surface";
  setup.partner_mesh = box_surface({0, 0.002, 0}, size, 0.01);
  const Eigen::Index n = setup.partner_mesh.position.cols();
  const auto all = [n](const std::string& quantity, const std::string& unit, double y) {
    return Field{quantity, unit, false, Eigen::Vector3d(0, y, 0).replicate(1, n)};
  };
  setup.partner_initial = {all("displacement", "m", 0), all("velocity", "m/s", -speed)};
  FluidParticipant<3> participant(c.parameters, c.common, setup);
  Advanced last;
  for (int k = 0; k < 15; ++k) {
    const Window w = nth(k, 1e-4);
    last = participant.advance(w, {{{w.t + w.dt, {all("displacement", "m", -speed * (w.t + w.dt))}}}});
    participant.commit(false);
  }
  return last.monitor.at("check.momentum_gap");
}

// Over 2ρVa³ a slender body had a gap of nothing when it lay along x, and a large one along z.
TEST(FluidParticipant, the_momentum_gap_of_a_slender_body_in_space_does_not_depend_on_its_heading) {
  const double along_x = gap_of_box({0.12, 0.02, 0.04}), along_z = gap_of_box({0.04, 0.02, 0.12});
  EXPECT_GT(along_x, 0);
  EXPECT_NEAR(along_z / along_x, 1, 0.05);
}

// Over 2ρVab min(a, b) a body across a narrow tank had the larger gap the narrower the tank was.
TEST(FluidParticipant, the_momentum_gap_of_a_body_across_the_tank_does_not_depend_on_its_length) {
  const double narrow = gap_of_box({0.08, 0.02, 0.08}, "0.04"), wide = gap_of_box({0.08, 0.02, 0.16}, "0.08");
  EXPECT_GT(narrow, 0);
  EXPECT_NEAR(wide / narrow, 1, 0.05);
}

TEST(FluidParticipant, impulse_counts_from_the_first_step_above_the_stagnation_pressure) {
  const Case c;
  FluidParticipant<2> participant(c.parameters, c.common, entering());
  bool touched = false;
  double impulse = 0;
  for (int k = 0; k < contact_window + 20; ++k) {
    const auto monitor = participant.advance(nth(k), at_speed(nth(k))).monitor;
    participant.commit(false);
    touched = touched || monitor.at("p.max") > 0.5 * 1000 * speed * speed;
    if (!touched) {
      EXPECT_EQ(monitor.at("p.impulse"), 0) << k;
    }
    impulse = monitor.at("p.impulse");
    EXPECT_LE(monitor.at("p.min"), monitor.at("p.mean"));
    EXPECT_LE(monitor.at("p.mean"), monitor.at("p.max"));
  }
  EXPECT_TRUE(touched);
  EXPECT_GT(impulse, 0);
}

TEST(FluidParticipant, a_drop_that_starts_with_a_velocity_of_its_own_has_a_scale_for_its_momentum) {
  const Case c({"fluid.gravity=[0, 0, 0]", "fluid.sound_speed=inf",
                "fluid.initial_velocity.gradient=[[4, 0], [0, -4]]", "fluid.scheme.time_step=inf",
                "fluid.tank=[[-0.2, -0.2], [0.2, 0.2]]", "fluid.water=[[-0.1, -0.1], [0.1, 0.1]]"},
               "[-0.2, 0.0]");
  FluidParticipant<2> participant(c.parameters, c.common, {});
  const double largest = 4 * 0.095 * std::sqrt(2.0);
  EXPECT_NE(
      participant.description().lines.front().find(fmt::format("starts with up to {:.3g} m/s", largest)),
      std::string::npos)
      << participant.description().lines.front();
  Advanced last;
  for (int k = 0; k < 20; ++k) {
    last = participant.advance(nth(k, 1e-3), {});
    participant.commit(false);
  }
  EXPECT_GT(last.monitor.at("check.momentum_gap"), 0) << "over a scale that is not zero";
  EXPECT_LT(last.monitor.at("check.momentum_gap"), 0.01);
  EXPECT_FALSE(last.monitor.contains("alarm.speed.time"));
  EXPECT_GT(last.monitor.at("check.largest_speed"), 0.1) << "the guard knows the speed";
  const double centre = std::hypot(last.monitor.at("water.centre.x"), last.monitor.at("water.centre.y"));
  EXPECT_LT(centre, 1e-4);
}

TEST(FluidParticipant, a_still_tank_alone_reports_its_floor_load_and_no_force) {
  const Case c({"fluid.scheme.time_step=2e-5"}, "[0.0, -0.1]");
  strake::Setup alone;
  alone.interface = "none";
  FluidParticipant<2> participant(c.parameters, c.common, alone);
  const auto advanced = participant.advance(nth(0), {});
  EXPECT_TRUE(advanced.output.empty());
  EXPECT_TRUE(advanced.monitor.contains("floor.y"));
  EXPECT_EQ(participant.mesh().position.cols(), 0);
  for (const auto& column : participant.description().columns)
    EXPECT_TRUE(advanced.monitor.contains(column.name) || column.name == "water.volume") << column.name;
}

/// A column that collapses, in windows far longer than a step.
Case collapse(const std::vector<std::string>& more = {}) {
  std::vector<std::string> sets = {"fluid.water=[[-0.15,-0.1],[0.0,0.0]]", "fluid.scheme.time_step=inf",
                                   "coupling.surface.window=0.02", "fluid.scheme.cfl=0.05"};
  sets.insert(sets.end(), more.begin(), more.end());
  return Case(sets, "[-0.15, -0.05]");
}

TEST(FluidParticipant, steps_follow_the_flow_inside_a_long_window) {
  const Case c = collapse();
  FluidParticipant<2> participant(c.parameters, c.common, strake::Setup{});
  double before = 0, first = 0, last = 0;
  for (int k = 0; k < 6; ++k) {
    const auto monitor = participant.advance(nth(k, 0.02), {}).monitor;
    participant.commit(false);
    // The limit is taken before a step. In one step gravity adds at most g dt = 0.25 √(g l0) to a speed.
    EXPECT_LE(monitor.at("cfl"), c.parameters.scheme.cfl * 1.5) << k;
    last = monitor.at("count.steps") - before;
    before = monitor.at("count.steps");
    if (k == 0) first = last;
  }
  EXPECT_GE(first, std::ceil(0.02 / column_step(c.parameters)));
  EXPECT_GT(last, first);  // the front runs at 1 m/s
}

TEST(FluidParticipant, a_long_window_of_changing_steps_is_rewound_to_the_bit) {
  const Case c = collapse();
  FluidParticipant<2> straight(c.parameters, c.common, strake::Setup{}),
      iterated(c.parameters, c.common, strake::Setup{});
  for (int k = 0; k < 6; ++k) {
    const auto expected = straight.advance(nth(k, 0.02), {});
    straight.commit(false);
    iterated.advance(nth(k, 0.013), {});
    iterated.rewind();
    expect_equal_bits(iterated.advance(nth(k, 0.02), {}), expected, k);
    iterated.commit(false);
  }
}

TEST(FluidParticipant, resolved_acoustics_limit_the_step_by_the_speed_of_sound) {
  const Case c = collapse({"fluid.sound_speed=100", "fluid.scheme.acoustic_cfl=0.5"});
  FluidParticipant<2> participant(c.parameters, c.common, strake::Setup{});
  const auto monitor = participant.advance(nth(0, 1e-3), {}).monitor;
  EXPECT_EQ(monitor.at("count.steps"), 20);  // 1e-3 s over 0.5 · 0.01 m / 100 m/s
}

TEST(FluidParticipant, a_frame_that_cannot_be_written_is_told_at_a_later_commit) {
  const Case c;
  const TemporaryFolder folder;
  strake::Setup setup = entering();
  setup.run_folder = folder.path();
  FluidParticipant<2> participant(c.parameters, c.common, setup);
  std::filesystem::create_directory(folder / "frames/fluid-000001.h5");  // a place that is taken
  participant.advance(nth(0), at_speed(nth(0)));
  participant.commit(true);
  try {
    participant.flush();
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::cannot_write);
  }
  participant.advance(nth(1), at_speed(nth(1)));
  EXPECT_THROW(participant.commit(false), Error);
}

TEST(FluidParticipant, the_volume_is_measured_where_a_frame_is_due_and_at_the_end) {
  const Case c = collapse({"output.every=0.05", "end_time=0.14"});
  FluidParticipant<2> participant(c.parameters, c.common, strake::Setup{});
  for (int k = 0; k < 7; ++k) {
    const auto monitor = participant.advance(nth(k, 0.02), {}).monitor;
    participant.commit(false);
    const bool due = k == 2 || k == 4 || k == 6;  // past 0.05 s and 0.1 s, and the end
    EXPECT_EQ(monitor.contains("water.volume"), due) << k;
    if (due) {
      EXPECT_NEAR(monitor.at("check.volume_drift"), 0, 0.05);
    }
  }
}

TEST(FluidParticipant, the_front_of_a_collapsing_column_runs_ahead_and_its_head_sinks) {
  std::string text = small_tank("[-0.15, -0.1]");
  text +=
      "quantity = \"front\"\n[[output.probe]]\nname = \"head\"\nof = \"fluid\"\nat = [-0.15, -0.1]\n"
      "quantity = \"height\"\n";
  CaseFile file = CaseFile::parse(
      text, "case.toml",
      {"fluid.water=[[-0.15,-0.1],[0.0,0.0]]", "fluid.scheme.time_step=inf", "coupling.surface.window=0.02"});
  const CommonKeys common = read_common(file);
  FluidParticipant<2> participant(read(file, common), common, strake::Setup{});
  double place = 0, height = 0.1;
  for (int k = 0; k < 5; ++k) {
    const auto monitor = participant.advance(nth(k, 0.02), {}).monitor;
    participant.commit(false);
    EXPECT_GT(monitor.at("p"), place) << k;
    EXPECT_LT(monitor.at("head"), height + 1e-4) << k;
    place = monitor.at("p");
    height = monitor.at("head");
    EXPECT_FALSE(monitor.contains("p.impulse"));
  }
  EXPECT_LT(place, 0.15);
}

TEST(FluidParticipant, a_sensor_that_covers_nothing_is_refused) {
  for (const char* at : {"[0.12, 0.002]", "[0.0, -0.05]"}) {  // beside the body, in the water
    const Case c({}, at);
    for (const strake::Setup& setup : {entering(), strake::Setup{}})
      EXPECT_THROW(FluidParticipant<2>(c.parameters, c.common, setup), Error) << at;
  }
}

// The floor carries the weight of the water, more than ½ρV² of a slow plate that is still above it.
TEST(FluidParticipant, a_sensor_on_a_wall_beside_a_body_reads_the_wall_and_finds_no_contact) {
  constexpr double slow = 0.2;
  const Case c({}, "[0.0, -0.1]");
  strake::Setup setup = entering();
  setup.partner_initial = {moving("displacement", {0, 0, 0}), moving("velocity", {0, -slow, 0})};
  FluidParticipant<2> beside(c.parameters, c.common, setup), alone(c.parameters, c.common, strake::Setup{});
  const Advanced read = beside.advance(nth(0), at_speed(nth(0), slow)), expected = alone.advance(nth(0), {});
  EXPECT_GT(read.monitor.at("p"), 0.5 * 1000 * slow * slow);
  EXPECT_NEAR(read.monitor.at("p"), expected.monitor.at("p"), 1);
  EXPECT_TRUE(read.monitor.contains("p:running_impulse")) << "from the first step";
  EXPECT_FALSE(read.monitor.contains("p:contact"));
  EXPECT_FALSE(read.monitor.contains("body:contact"));
}

TEST(FluidParticipant, frames_hold_water_and_wet_rows_and_are_listed) {
  const Case c;
  strake::Setup setup = entering();
  const TemporaryFolder folder;
  setup.run_folder = folder.path();
  {
    FluidParticipant<2> participant(c.parameters, c.common, setup);
    participant.advance(nth(0), at_speed(nth(0)));
    participant.commit(true);
  }
  EXPECT_TRUE(std::filesystem::exists(setup.run_folder / "fluid.xdmf"));
  EXPECT_TRUE(std::filesystem::exists(setup.run_folder / "frames"));
}

TEST(FluidParticipant, the_headline_names_method_particles_and_the_numbers_of_the_entry) {
  const Case c;
  const auto lines = describe(c.parameters, c.common, 6.26, 0.4);
  EXPECT_EQ(lines.at(0), "MPS-LES 2-D, improved   300 water particles   l0 10 mm   Re 2.5e6   Fr 3.2");
  const std::string at_rest = "MPS-LES 2-D, improved   300 water particles   l0 10 mm";
  EXPECT_EQ(describe(c.parameters, c.common).at(0), at_rest);
  EXPECT_EQ(describe(c.parameters, c.common, 1e-27, 0.4).at(0), at_rest)
      << "round-off of a table of the motion";
}

TEST(FluidParticipant, the_log_names_the_turbulence_model_and_the_walls_that_absorb) {
  Case c;
  c.parameters.scheme.turbulence = Turbulence::k;
  c.parameters.absorbing_bottom = true;
  const auto lines = describe(c.parameters, c.common);
  EXPECT_NE(lines.at(1).find("no echo from the bottom"), std::string::npos) << lines.at(1);
  EXPECT_NE(lines.at(4).find("SPS by an equation for k"), std::string::npos) << lines.at(4);
}

}  // namespace participant_test
}  // namespace strake::fluid
