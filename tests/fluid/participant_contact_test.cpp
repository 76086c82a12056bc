#include "tests/fluid/participant_case.hpp"
#include "tests/fluid/plate_case.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace strake::fluid {
namespace participant_contact_test {

TEST(FluidParticipant, a_sensor_or_the_body_itself_waits_for_contact) {
  const auto waits = [](const std::string& probe) {
    const Case c({}, probe);
    FluidParticipant<2> participant(c.parameters, c.common, entering());
    return participant.advance(nth(0), at_speed(nth(0))).monitor.contains("count.awaiting_contact");
  };
  EXPECT_TRUE(waits("[0.0, 0.002]"));
  const std::string gauge = "[0.0, -0.05]\nquantity = \"level\"\n";
  EXPECT_TRUE(waits(gauge)) << "any point of the body tells contact";
  EXPECT_FALSE(waits(gauge + "[[output.probe]]\nname = \"mid\"\nof = \"structure\"\nat = [0, 0]"))
      << "the structure does";
}

/// Contact [s] that a monitor names, as the plate comes down at 2 m/s; < 0: none until its gap is closed.
double contact_of(const Case& c, const strake::Setup& setup, const std::string& name) {
  FluidParticipant<2> participant(c.parameters, c.common, setup);
  for (int k = 0; k < contact_window + 10; ++k) {
    const auto monitor = participant.advance(nth(k), at_speed(nth(k))).monitor;
    participant.commit(false);
    if (!monitor.contains(name)) continue;
    EXPECT_FALSE(monitor.contains("count.awaiting_contact"));
    return monitor.at(name);
  }
  return -1;
}

TEST(FluidParticipant, a_body_from_rest_has_the_contact_of_one_with_a_speed) {
  strake::Setup from_rest = entering();
  from_rest.partner_initial.back() = moving("velocity", {0, 0, 0});
  const double contact = contact_of(Case(), entering(), "p:contact");
  EXPECT_GT(contact, 0);
  // The water is not the same to the last bit: the body's speed comes in the first window.
  EXPECT_NEAR(contact_of(Case({"structure.free.y=true"}), from_rest, "p:contact"), contact, window);
  EXPECT_EQ(contact_of(Case(), from_rest, "p:contact"), -1) << "a body that does not move is not awaited";
}

TEST(FluidParticipant, a_table_that_begins_nearly_at_rest_gives_the_speed_of_entry) {
  const TemporaryFolder folder;
  put(folder / "way.csv", "t [s],vy [m/s]\n0,-1e-4\n1e-5,-2\n0.01,-2\n");
  const Case c({"structure.motion.file=" + (folder / "way.csv").string()});
  strake::Setup setup = entering();
  setup.partner_initial.back() = moving("velocity", {0, -1e-4, 0});
  EXPECT_NEAR(contact_of(c, setup, "p:contact"), contact_of(Case(), entering(), "p:contact"), window);
  FluidParticipant<2> driven(c.parameters, c.common, setup),
      constant(Case().parameters, Case().common, entering());
  EXPECT_EQ(driven.description().lines.front(), constant.description().lines.front()) << "Re and Fr";
  double gap = 0;
  for (int k = 0; k < contact_window + 20; ++k) {
    gap = driven.advance(nth(k), at_speed(nth(k))).monitor.at("check.momentum_gap");
    driven.commit(false);
  }
  EXPECT_GT(gap, 0);
  EXPECT_LT(gap, 0.1) << "over the momentum at 2 m/s; over that at t = 0 it is 20 000 times as large";
}

TEST(FluidParticipant, a_body_without_probes_finds_its_contact_itself) {
  const std::string gauge = "[0.0, -0.05]\nquantity = \"level\"",
                    of_body =
                        "[0.0, 0.002]\n[[output.probe]]\nname = \"mid\"\nof = \"structure\"\nat = [0, 0]";
  const double contact = contact_of(Case(), entering(), "p:contact");
  EXPECT_NEAR(contact_of(Case({}, gauge), entering(), "body:contact"), contact, 2 * window);
  EXPECT_EQ(contact_of(Case(), entering(), "body:contact"), -1) << "its sensor tells contact";
  EXPECT_EQ(contact_of(Case({}, of_body), entering(), "body:contact"), -1) << "so do probes of the structure";
}

/// The last check of the momentum account, as plates at these places along x come down at 2 m/s.
double momentum_gap_of(const std::vector<double>& places, const std::vector<std::string>& sets) {
  const auto n = plate().position.cols(), count = static_cast<Eigen::Index>(places.size());
  strake::Setup setup = entering();
  InterfaceMesh& mesh = setup.partner_mesh;
  mesh.position = plate().position.replicate(1, count);
  mesh.faces = plate().faces.replicate(1, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    mesh.position.middleCols(k * n, n).row(0).array() += places[static_cast<std::size_t>(k)];
    mesh.faces.middleCols(k * n, n).array() += static_cast<int>(k * n);
  }
  const auto on_all = [&](const std::string& quantity, double y) -> Field {
    return {quantity, quantity == "velocity" ? "m/s" : "m", false,
            Eigen::Vector3d(0, y, 0).replicate(1, n * count)};
  };
  setup.partner_initial = {on_all("displacement", 0), on_all("velocity", -speed)};
  const Case c(sets, "[0.0, -0.1]");
  FluidParticipant<2> participant(c.parameters, c.common, setup);
  double gap = 0;
  for (int k = 0; k < contact_window + 10; ++k) {
    const Window w = nth(k);
    gap = participant.advance(w, {{{w.t + w.dt, {on_all("displacement", -speed * (w.t + w.dt))}}}})
              .monitor.at("check.momentum_gap");
    participant.commit(false);
  }
  return gap;
}

// The middle plane between two plates is as a smooth wall.
TEST(FluidParticipant, the_momentum_account_of_two_plates_is_compared_with_the_water_that_both_move) {
  const double one = momentum_gap_of({0}, {});
  const double two = momentum_gap_of(
      {-0.15, 0.15}, {"fluid.tank=[[-0.3, -0.1], [0.3, 0.1]]", "fluid.water=[[-0.3, -0.1], [0.3, 0.0]]"});
  EXPECT_GT(one, 1e-4);
  EXPECT_NEAR(two, one, 0.1 * one);
}

/// The last accounts of a plate that goes down edge-on for 20 ms. low: place of its lower edge at the start
/// [m]; half: half the width of the tank [m]; down: its speed [m/s]; rolls: of the tank [rad/s]; wide: its
/// thickness [m].
std::map<std::string, double> edge_on(double low, const std::string& half, const std::string& submerged,
                                      double down = speed, double rolls = 0, double wide = 0.01) {
  Case c({"fluid.tank=[[-" + half + ", -0.1], [" + half + ", 0.1]]",
          "fluid.water=[[-" + half + ", -0.1], [" + half + ", 0.0]]", "fluid.submerged=" + submerged,
          "fluid.scheme.time_step=1e-4", "coupling.surface.window=1e-4"},
         "[0.0, -0.09]\nquantity = \"level\"");
  strake::Setup setup;
  setup.interface = "surface";
  setup.partner_mesh = rectangle(-0.5 * wide, low, wide, 0.1, 0.01);
  const auto all = [&](const std::string& quantity, const std::string& unit, double y) {
    return Field{quantity, unit, false,
                 Eigen::Vector3d(0, y, 0).replicate(1, setup.partner_mesh.position.cols())};
  };
  setup.partner_initial = {all("displacement", "m", 0), all("velocity", "m/s", -down)};
  if (rolls > 0)
    c.parameters.motion.table =
        MotionTable({0, 1}, {MotionColumn::rate}, {std::vector<double>{rolls, rolls}});
  FluidParticipant<2> participant(c.parameters, c.common, setup);
  std::map<std::string, double> monitor;
  for (int k = 0; k < 200; ++k) {
    const Window w = nth(k, 1e-4);
    monitor =
        participant.advance(w, {{{w.t + w.dt, {all("displacement", "m", -down * (w.t + w.dt))}}}}).monitor;
    participant.commit(false);
  }
  return monitor;
}

// Half a spacing does not show the water the plate's width. The gap was compared with what gravity gives the
// whole tank, so no alarm came.
TEST(FluidParticipant, a_plate_that_enters_edge_on_raises_the_alarm_of_its_momentum) {
  const auto last = edge_on(0.002, "0.15", "false");
  EXPECT_GT(last.at("check.momentum_gap"), 0.1);
  EXPECT_TRUE(last.contains("alarm.momentum.time"));
}

// It was compared with the weight of all the water, so that it was three times smaller in the wider tank.
TEST(FluidParticipant, the_momentum_gap_of_a_body_in_the_water_does_not_depend_on_the_tank) {
  const double narrow = edge_on(-0.035, "0.15", "true").at("check.momentum_gap"),
               wide = edge_on(-0.035, "0.45", "true").at("check.momentum_gap");
  EXPECT_GT(narrow, 0.1);
  EXPECT_NEAR(wide / narrow, 1, 0.3) << wide << " and " << narrow;
}

// The loads on the two sides of a plate cancel. The gap was compared with what little remained, and raised an
// alarm.
TEST(FluidParticipant, the_momentum_of_a_tank_that_moves_is_compared_with_that_of_gravity_and_walls) {
  const auto last = edge_on(-0.035, "0.15", "true", 0, 0.2);
  EXPECT_LT(last.at("check.momentum_gap"), 0.02);
  EXPECT_FALSE(last.contains("alarm.momentum.time"));
}

// The same in water at rest, where nothing else is left.
TEST(FluidParticipant, the_momentum_beside_a_wall_in_still_water_is_compared_with_a_weight) {
  EXPECT_LT(edge_on(-0.035, "0.15", "true", 0, 0, 0.04).at("check.momentum_gap"), 0.1);  // 0.1: bad
}

TEST(FluidParticipant, a_body_that_has_blown_up_is_named_with_its_speed) {
  const Case c;
  FluidParticipant<2> participant(c.parameters, c.common, entering());
  const std::string text = text_of_error(
      [&] {
        participant.advance(nth(0), {{{window, {moving("displacement", {0, 100, 0})}}}});
      },
      ExitCode::solver_fault);
  EXPECT_NE(text.find("blown up beside a body at 5e+06 m/s"), std::string::npos) << text;
  EXPECT_NE(text.find("look at the structure first"), std::string::npos) << text;
}

TEST(FluidParticipant, an_outline_that_is_walked_clockwise_is_refused) {
  const Case c;
  strake::Setup turned = entering();
  turned.partner_mesh.faces = turned.partner_mesh.faces.colwise().reverse().eval();
  expect_refused([&] { FluidParticipant<2>(c.parameters, c.common, turned); }, "encloses -0.002 m^2");
}

}  // namespace participant_contact_test
}  // namespace strake::fluid
