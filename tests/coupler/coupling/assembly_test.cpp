// Several bodies as one structure: what the scheme sees of them, and what each of them is given.
#include "coupler/coupling/assembly.hpp"

#include "coupler/coupling/window_report.hpp"
#include "proto/error.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace assembly_test {

using Eigen::VectorXd;

/// A square of unit width whose lower left corner is at (x, 0): it moves down by the load on it.
class Square : public models::Model<double> {
 public:
  std::vector<Sample> told;
  double shorter = 0;  // [s]; 0: it takes every window

  explicit Square(double x, bool sends_velocity, double speed = 0, double y = 0)
      : sends_velocity_(sends_velocity) {
    description_.prescribed = speed != 0;
    InterfaceMesh mesh = {"square", 2, Points::Zero(3, 4), Eigen::MatrixXi(2, 4), {}};
    mesh.position.row(0) << x, x + 1, x + 1, x;
    mesh.position.row(1) << y, y, y + 1, y + 1;
    mesh.faces << 0, 1, 2, 3, 1, 2, 3, 0;
    description_.initial = {models::y_field("displacement", "m", VectorXd::Zero(4)),
                            models::y_field("velocity", "m/s", VectorXd::Constant(4, speed))};
    description_.columns = {{"energy", "J"}, {"mid.y", "m"}};
    begin(mesh, 0);
  }

 private:
  Advanced step(const Window& window, const Input& input) override {
    told = input.samples;
    Advanced answer;
    if (shorter > 0 && window.dt > shorter) {
      answer.retry_smaller_dt = true;
      answer.dt_limit = shorter;
      answer.why = "too fast";
      return answer;
    }
    now_ = committed_ + find(told.back().fields, "force")->value.row(1).sum();
    answer.output = {models::y_field("displacement", "m", VectorXd::Constant(4, now_))};
    if (sends_velocity_)
      answer.output.push_back(models::y_field("velocity", "m/s", VectorXd::Constant(4, 7)));
    answer.monitor = {{"energy", now_},   {"mid.y", now_},     {"mid.y:first_peak", 3}, {"seconds.step", 1},
                      {"count.steps", 2}, {"memory.peak", 10}, {"check.drift", now_},   {"ranks.0.busy", 4}};
    return answer;
  }
  bool sends_velocity_;
};

Input load(const VectorXd& y, double time) {
  return {.samples = {{time, {models::y_field("force", "N", y)}}}};
}

struct Two {
  Square left{0, true}, right{3, false, 1};
  Assembly both{{{"left", &left}, {"right", &right}}, {"mid"}, 0.5};
};

TEST(Assembly, IsOneMeshAndOneMotion) {
  Two two;
  ASSERT_EQ(two.both.mesh().position.cols(), 8);
  EXPECT_EQ(two.both.mesh().position(0, 5), 4);
  EXPECT_EQ(two.both.mesh().faces(0, 4), 4);
  EXPECT_EQ(two.both.mesh().parts[1].name, "right");
  EXPECT_EQ(two.both.mesh().parts[1].first_point, 4);
  const auto& initial = two.both.description().initial;
  EXPECT_EQ(find(initial, "velocity")->value(1, 0), 0);
  EXPECT_EQ(find(initial, "velocity")->value(1, 4), 1);
}

TEST(Assembly, FindsTheVelocityOfABodyThatMovesFromTheStartBesideOneThatSendsIts) {
  Square left(0, true), right(3, false);  // at rest, as it seems
  Assembly both{{{"left", &left}, {"right", &right}}, {"mid"}, 0.5};
  const VectorXd push = VectorXd::Constant(8, -0.01);
  constexpr double dt = 0.1;
  Advanced answer;
  for (int k = 0; k < 5; ++k) {
    answer = both.advance({k * dt, dt}, load(push, (k + 1) * dt));
    both.commit(false);
  }
  const auto& velocity = find(answer.output, "velocity")->value;
  EXPECT_DOUBLE_EQ(velocity(1, 0), 7) << "its own";
  EXPECT_NEAR(velocity(1, 4), -0.4, 1e-12) << "-0.04 m in each window";
}

TEST(Assembly, FindsThatVelocityAfterAResumeToo) {
  const VectorXd push = VectorXd::Constant(8, -0.01);
  constexpr double dt = 0.1;
  for (const int resumed_at : {0, 1, 2, 3}) {
    Square left(0, true), right(3, false);
    std::optional<Assembly> both(std::in_place, std::vector<Body>{{"left", &left}, {"right", &right}},
                                 std::set<std::string>{}, 0.5);
    StructureSample now{0, fields_of_structure(*both).motion, {}};
    Archive checkpoint;
    both->save(checkpoint);
    Advanced answer;
    for (int k = 0; k < 5; ++k) {
      if (k == resumed_at) {
        both.emplace(std::vector<Body>{{"left", &left}, {"right", &right}}, std::set<std::string>{}, 0.5);
        both->load(checkpoint, now, k);
      }
      answer = both->advance({k * dt, dt}, load(push, (k + 1) * dt));
      both->commit(false);
      both->save(checkpoint);
      now = StructureSample::of({(k + 1) * dt, answer.output});
    }
    EXPECT_NEAR(find(answer.output, "velocity")->value(1, 4), -0.4, 1e-12) << "resumed at " << resumed_at;
  }
}

TEST(Assembly, ResumesFromACheckpointWithoutItsVelocity) {
  Two two;
  two.both.load({}, {0.1, Motion{Points::Zero(3, 8), Points::Constant(3, 8, 3)}, {}}, 2);
  const Advanced next = two.both.advance(Window{0.1, 0.1}, load(VectorXd::Zero(8), 0.2));
  EXPECT_DOUBLE_EQ(find(next.output, "velocity")->value(1, 4), -3) << "v = 2 (u - u_0)/dt - v_0";
}

TEST(Assembly, IsPrescribedWhereEachOfItsBodiesIs) {
  Square one{0, true, 2}, other{3, true, 1};
  EXPECT_TRUE(Assembly({{"one", &one}, {"other", &other}}, {}, 0.5).description().prescribed);
  EXPECT_FALSE(Two().both.description().prescribed);
}

TEST(Assembly, GivesEachBodyItsPartOfTheLoad) {
  Two two;
  VectorXd y(8);
  y << 1, 0, 0, 0, 2, 2, 0, 0;
  const Advanced answer = two.both.advance(Window{0, 0.5}, load(y, 0.5));
  EXPECT_EQ(find(two.left.told.front().fields, "force")->value.cols(), 4);
  const Values& u = find(answer.output, "displacement")->value;
  EXPECT_EQ(u(1, 0), 1);
  EXPECT_EQ(u(1, 7), 4);
  // The right one sends no velocity: v = 2 u/dt − v_0.
  const Values& v = find(answer.output, "velocity")->value;
  EXPECT_EQ(v(1, 0), 7);
  EXPECT_EQ(v(1, 4), 2 / 0.5 * 4 - 1);
}

TEST(Assembly, NamesColumnsAndAddsCounts) {
  Two two;
  std::vector<std::string> names;
  for (const Column& column : two.both.description().columns) names.push_back(column.name);
  EXPECT_EQ(names, (std::vector<std::string>{"left.energy", "mid.y", "right.energy", "mid.y"}));
  VectorXd y = VectorXd::Zero(8);
  y[0] = -3;
  const Advanced answer = two.both.advance(Window{0, 0.5}, load(y, 0.5));
  EXPECT_EQ(answer.monitor.at("left.energy"), -3);
  EXPECT_EQ(answer.monitor.at("mid.y:first_peak"), 3);
  EXPECT_EQ(answer.monitor.at("seconds.right.step"), 1);
  EXPECT_EQ(answer.monitor.at("count.steps"), 4);
  EXPECT_EQ(answer.monitor.at("memory.peak"), 20);
  EXPECT_EQ(answer.monitor.at("check.drift"), 0);
  ASSERT_EQ(rank_shares(answer.monitor, "right").size(), 1U) << "whose ranks";
  EXPECT_EQ(rank_shares(answer.monitor, "right").front().busy, 4);
  EXPECT_TRUE(rank_shares(answer.monitor).empty());
}

TEST(Assembly, TakesAllBackTogether) {
  Two two;
  VectorXd y = VectorXd::Ones(8);
  two.right.shorter = 0.1;
  const Advanced refused = two.both.advance(Window{0, 0.5}, load(y, 0.5));
  EXPECT_TRUE(refused.retry_smaller_dt);
  EXPECT_EQ(refused.dt_limit, 0.1);
  EXPECT_EQ(refused.why, "right: too fast");
  two.both.rewind();
  EXPECT_EQ(two.left.state(), 0);
  const Window window{0, 0.1};
  const Advanced first = two.both.advance(window, load(y, 0.1));
  two.both.rewind();
  const Advanced again = two.both.advance(window, load(y, 0.1));
  EXPECT_EQ(find(first.output, "velocity")->value, find(again.output, "velocity")->value);
  two.both.commit(false);
  // v_0 of the next window is that of the one before: 2 · 4/0.1 − 1 = 79.
  const Advanced next = two.both.advance(Window{0.1, 0.1}, load(y, 0.2));
  EXPECT_DOUBLE_EQ(find(next.output, "velocity")->value(1, 4), 2 * 4 / 0.1 - 79);
}

TEST(Assembly, GivesTheMeanToABodyThatKnowsNoHistory) {
  Two two;
  Input input;
  for (const auto& [time, value] : {std::pair(0.0, 9.0), {0.1, 1.0}, {0.4, 5.0}})
    input.samples.push_back({time, {models::y_field("force", "N", VectorXd::Constant(8, value))}});
  two.both.advance(Window{0, 0.4}, input);
  ASSERT_EQ(two.left.told.size(), 1U);
  // (0.1 · 1 + 0.3 · 5)/0.4 = 4
  EXPECT_DOUBLE_EQ(find(two.left.told.front().fields, "force")->value(1, 0), 4);
}

std::string refusal(double x_of_right, double nearest, double y_of_right = 0) {
  Square left{0, true}, right{x_of_right, true, 0, y_of_right};
  try {
    Assembly both({{"left", &left}, {"right", &right}}, {}, nearest);
  } catch (const Error& error) {
    return error.where() + ": " + error.problem();
  }
  return "";
}

TEST(Assembly, RefusesBodiesThatOverlapOrAreTooClose) {
  EXPECT_EQ(refusal(1.6, 0.5), "");
  EXPECT_NE(refusal(1.4, 0.5).find("left and right, at (1, 0) m: 0.4 m apart at the start"),
            std::string::npos);
  EXPECT_NE(refusal(0.5, 0.2).find("apart"), std::string::npos);
  EXPECT_NE(refusal(0.9, 0.2, 0.5).find("reaches into"), std::string::npos) << refusal(0.9, 0.2, 0.5);
}

TEST(Assembly, StopsBeforeBodiesMeetInARun) {
  Square lower{0, true}, upper{0, true, 0, 2};
  Assembly both({{"lower", &lower}, {"upper", &upper}}, {}, 0.5);
  VectorXd y = VectorXd::Zero(8);
  y[4] = -0.25;
  both.advance(Window{0, 0.5}, load(y, 0.5));
  EXPECT_NO_THROW(both.commit(false));
  y[4] = -0.5;
  both.advance(Window{0.5, 0.5}, load(y, 1));
  try {
    both.commit(false);
    ADD_FAILURE() << "0.25 m apart";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::solver_fault);
    EXPECT_NE(error.problem().find("0.25 m apart at t = 1 s"), std::string::npos) << error.problem();
  }
}

TEST(BodyGaps, FindABodyInsideAnother) {
  InterfaceMesh mesh = {"two", 2, Points::Zero(3, 8), Eigen::MatrixXi(2, 8), {}};
  mesh.position.row(0) << 0, 9, 9, 0, 4, 5, 5, 4;
  mesh.position.row(1) << 0, 0, 9, 9, 4, 4, 5, 5;
  mesh.faces << 0, 1, 2, 3, 4, 5, 6, 7, 1, 2, 3, 0, 5, 6, 7, 4;
  mesh.parts = {{"hull", 0, 0}, {"tank", 4, 4}};
  const Points still = Points::Zero(3, 8);
  EXPECT_FALSE(closest_bodies(mesh, still, 1));
  const auto inside = body_inside_another(mesh, still);
  ASSERT_TRUE(inside);
  EXPECT_EQ(inside->one, "tank");
  EXPECT_EQ(inside->other, "hull");
}

TEST(BodyGaps, MeasureFromFacesNotFromPoints) {
  // Above a large triangle, far from its corners.
  InterfaceMesh mesh = {"two", 3, Points::Zero(3, 6), Eigen::MatrixXi(3, 2), {}};
  mesh.position << -9, 9, 0, 0, 1, 0,  //
      -9, -9, 9, 0, 0, 1,              //
      0, 0, 0, 0.25, 1, 1;
  mesh.faces << 0, 3, 1, 4, 2, 5;
  mesh.parts = {{"deck", 0, 0}, {"box", 3, 1}};
  const auto gap = closest_bodies(mesh, Points::Zero(3, 6), 1);
  ASSERT_TRUE(gap);
  EXPECT_DOUBLE_EQ(gap->distance, 0.25);
  EXPECT_EQ(gap->one, "box");
}

}  // namespace assembly_test
}  // namespace strake
