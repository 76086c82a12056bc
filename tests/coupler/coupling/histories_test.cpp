// What a fluid is given over a window of a structure that sends samples inside it.

#include "coupler/coupling/scheme.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace strake {
namespace histories_test {

using Eigen::VectorXd;

Field along_y(const std::string& quantity, const std::string& unit, double y) {
  return models::y_field(quantity, unit, VectorXd::Constant(1, y));
}

/// Keeps every input, and answers without a load.
class Listener final : public models::Model<int> {
 public:
  explicit Listener(bool history) {
    begin(models::line_of_points("fluid", 1), 0);
    description_.history = history;
  }
  std::vector<Input> heard;

 private:
  Advanced step(const Window&, const Input& input) override {
    heard.push_back(input);
    Advanced answer;
    answer.output = {along_y("force", "N", 0)};
    return answer;
  }
};

/// Is at 0.4 m in the middle of each window and at 1 m at its end.
class Teller final : public models::Model<int> {
 public:
  explicit Teller(bool velocity) : velocity_(velocity) {
    begin(models::line_of_points("structure", 1), 0);
    description_.initial = {along_y("displacement", "m", 0)};
    if (velocity) description_.initial.push_back(along_y("velocity", "m/s", 0));
  }
  std::vector<bool> asked;

 private:
  Advanced step(const Window& w, const Input& input) override {
    asked.push_back(input.wants_history);
    Advanced answer;
    const auto fields = [&](double y) {
      std::vector<Field> sent = {along_y("displacement", "m", y)};
      if (velocity_) sent.push_back(along_y("velocity", "m/s", 10 * y));
      return sent;
    };
    answer.output = fields(1);
    if (input.wants_history) answer.history = {{w.t + 0.5 * w.dt, fields(0.4)}, {w.t + w.dt, fields(1)}};
    return answer;
  }
  bool velocity_;
};

/// Two iterations in each window of 1 s, the guess moved half way between them.
SchemeParameters half_way() {
  SchemeParameters made;
  made.predictor = Predictor::constant;
  made.accelerator.kind = "constant";
  made.accelerator.initial_relaxation = 0.5;
  made.convergence = {0, 1e-12, Measure::increment, 2, 2, Unconverged::accept};
  return made;
}

std::vector<std::pair<double, double>> places(const Input& input,
                                              const std::string& quantity = "displacement") {
  std::vector<std::pair<double, double>> all;
  for (const Sample& sample : input.samples)
    if (const Field* field = find(sample.fields, quantity)) all.emplace_back(sample.time, field->value(1, 0));
  return all;
}

using Places = std::vector<std::pair<double, double>>;

TEST(Histories, OfTheStructureLeadToTheGuessAndKeepTheStart) {
  Listener fluid(true);
  Teller structure(true);
  Scheme scheme(fluid, structure, nearest_neighbour(structure.mesh(), fluid.mesh()), half_way());
  scheme.advance({0, 1});
  ASSERT_EQ(fluid.heard.size(), 2u);
  EXPECT_EQ(places(fluid.heard[0]), (Places{{0, 0}, {1, 0}}));  // nothing is known inside yet
  // The guess 0.5 m is half a metre less than the answer; in the middle half of that.
  EXPECT_EQ(places(fluid.heard[1]), (Places{{0, 0}, {0.5, 0.4 - 0.25}, {1, 0.5}}));
  EXPECT_EQ(places(fluid.heard[1], "velocity"), (Places{{0, 0}, {0.5, 4 - 2.5}, {1, 5}}));
  EXPECT_EQ(structure.asked, (std::vector<bool>{true, true}));
  EXPECT_FALSE(fluid.heard[0].wants_history);
  scheme.commit(false);
  scheme.advance({1, 1});
  EXPECT_EQ(places(fluid.heard[2]), (Places{{0, 0}, {0.5, 0.4}, {1, 1}, {2, 1}}));
  scheme.commit(false);
  scheme.advance({2, 1});  // three samples before the window stay
  EXPECT_EQ(places(fluid.heard[4]), (Places{{1, 1}, {1.5, 0.4}, {2, 1}, {3, 1}}));
}

TEST(Histories, HoldAVelocityInsideTheWindowOnlyWhereTheStructureSendsIt) {
  Listener fluid(true);
  Teller structure(false);
  Scheme scheme(fluid, structure, nearest_neighbour(structure.mesh(), fluid.mesh()), half_way());
  scheme.advance({0, 1});
  EXPECT_EQ(places(fluid.heard[1]), (Places{{0, 0}, {0.5, 0.4 - 0.25}, {1, 0.5}}));
  EXPECT_EQ(places(fluid.heard[1], "velocity").size(), 2u);  // at the start, and that which the end implies
}

TEST(Histories, AreNotAskedForWhereTheFluidTakesNone) {
  Listener fluid(false);
  Teller structure(true);
  Scheme scheme(fluid, structure, nearest_neighbour(structure.mesh(), fluid.mesh()), half_way());
  scheme.advance({0, 1});
  EXPECT_EQ(places(fluid.heard[1]), (Places{{1, 0.5}}));
  EXPECT_EQ(structure.asked, (std::vector<bool>{false, false}));
}

}  // namespace histories_test
}  // namespace strake
