// Participants that are coupled to points of the structure: the same fixed point as with the fluid.

#include "coupler/coupling/attachments.hpp"

#include "coupler/attachments/local_attachment.hpp"
#include "coupler/coupling/scheme.hpp"
#include "proto/error.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace strake {
namespace attachments_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double mass = 2, added_mass = 3, stiffness = 20, start_at = 0.5;

SparseOperator at_point(Eigen::Index point, Eigen::Index of) {
  SparseOperator::Matrix weights(1, of);
  weights.insert(0, point) = 1;
  return SparseOperator(std::move(weights));
}

/// A spring of length zero, anchored where its point was undeformed.
std::unique_ptr<LocalAttachment> spring(double k, double x0) {
  SpringParameters p{.anchor = {{0, 0, 0}}, .stiffness = k, .damping = 0, .length = {0}, .slack = false};
  const Motion initial{models::y_field("displacement", "m", VectorXd::Constant(1, x0)).value,
                       MatrixXd(MatrixXd::Zero(3, 1))};
  return std::make_unique<LocalAttachment>("spring", models::line_of_points("spring", 1), initial,
                                           std::make_unique<SpringLaw>(p));
}

SchemeParameters settings(bool parallel, int iterations = 40) {
  SchemeParameters p;
  p.parallel = parallel;
  p.convergence.relative = 1e-12;
  p.convergence.absolute = 1e-13;
  p.convergence.max_iterations = iterations;
  return p;
}

/// A mass with added mass on a spring, its end after `windows` windows of one period; the spring is in the
/// structure, attached to it, or half here and half there.
double end_after(int windows, double attached_part, bool parallel) {
  const double period = 2 * std::numbers::pi * std::sqrt((mass + added_mass) / stiffness);
  const auto one = [](double value) { return MatrixXd(MatrixXd::Constant(1, 1, value)); };
  const VectorXd x0 = VectorXd::Constant(1, start_at), v0 = VectorXd::Zero(1);
  models::AddedMass fluid(one(added_mass), v0, models::Rule::trapezoidal);
  fluid.place(x0);
  models::Oscillators structure(one(mass), one((1 - attached_part) * stiffness), x0, v0,
                                models::Rule::trapezoidal);
  const auto attached = spring(attached_part * stiffness, start_at);
  Scheme scheme(fluid, structure, nearest_neighbour(structure.mesh(), fluid.mesh()), settings(parallel), 0,
                {{"spring", attached.get(), at_point(0, 1)}});
  const double dt = 0.8 * period / windows;
  for (int w = 0; w < windows; ++w) {
    const WindowReport report = scheme.advance({w * dt, dt});
    EXPECT_TRUE(report.converged);
    scheme.commit(false);
  }
  return structure.state().x(0);
}

TEST(Attachments, AnAttachedSpringIsTheStructuresOwn) {
  for (const bool parallel : {false, true}) {
    const double own = end_after(40, 0, parallel);
    EXPECT_NEAR(end_after(40, 1, parallel), own, 1e-9);
    EXPECT_NEAR(end_after(40, 0.5, parallel), own, 1e-9);
  }
}

TEST(Attachments, TheCoupledMotionIsOfSecondOrderInTheWindow) {
  const double exact = start_at * std::cos(0.8 * 2 * std::numbers::pi);
  const double coarse = end_after(40, 1, false) - exact, fine = end_after(80, 1, false) - exact;
  EXPECT_LT(std::abs(coarse), 0.02 * start_at);
  EXPECT_NEAR(coarse / fine, 4, 0.1);
}

/// Sends what a test tells it to.
class Answering final : public models::Model<int> {
 public:
  Advanced answer;
  int committed = 0, rewound = 0;
  std::vector<Sample> told;
  explicit Answering(Eigen::Index n) { begin(models::line_of_points("winch", n), 0); }
  void announce(std::vector<Field> fields) { description_.initial = std::move(fields); }
  void rewind() override { ++rewound; }
  void commit(bool) override { ++committed; }

 private:
  Advanced step(const Window&, const Input& input) override {
    told.push_back(input.samples.back());
    return answer;
  }
};

/// Three points that stand, under a load of 1, 2, 3 N.
struct Standing {
  models::AddedMass fluid{MatrixXd::Zero(3, 3), VectorXd::Zero(3), models::Rule::trapezoidal};
  models::Oscillators structure{MatrixXd::Identity(3, 3), MatrixXd::Zero(3, 3), VectorXd::Zero(3),
                                VectorXd::Zero(3), models::Rule::trapezoidal};
  Answering winch{1};
  Scheme scheme(const SparseOperator& weights, int iterations = 40) {
    return Scheme(fluid, structure, nearest_neighbour(structure.mesh(), fluid.mesh()),
                  settings(false, iterations), 0, {{"winch", &winch, weights}});
  }
};

TEST(Attachments, ForceIsSharedAsTheMotionIsInterpolatedAndReported) {
  Standing still;
  SparseOperator::Matrix weights(1, 3);
  weights.insert(0, 0) = 0.25;
  weights.insert(0, 1) = 0.75;
  still.winch.answer.output = {models::y_field("force", "N", VectorXd::Constant(1, 8))};
  still.winch.answer.monitor = {{"pull", 8}, {"seconds.solve", 0.5}};
  Scheme scheme = still.scheme(SparseOperator(std::move(weights)));
  const WindowReport report = scheme.advance({0, 0.1});
  scheme.commit(false);
  const MatrixXd load = report.from_attachments.at(0).value;
  EXPECT_NEAR(load(1, 0), 2, 1e-14);
  EXPECT_NEAR(load(1, 1), 6, 1e-14);
  EXPECT_EQ(load(1, 2), 0);
  EXPECT_EQ(report.force(1, 0), 0) << "the record's force is that of the water";
  EXPECT_EQ(report.attachments.at("winch.pull"), 8);
  EXPECT_EQ(report.attachments.at("winch.force.y"), 8);
  EXPECT_EQ(report.attachments.at("seconds.winch.solve"), 0.5);
  // u = f dt²/(2 m), and the winch hears of its own mean, to the tolerance.
  EXPECT_NEAR(report.displacement(1, 1), 0.03, 1e-12);
  EXPECT_NEAR(find(still.winch.told.back().fields, "displacement")->value(1, 0), 0.25 * 0.01 + 0.75 * 0.03,
              1e-10);
  EXPECT_EQ(still.winch.committed, 1);
  EXPECT_EQ(still.winch.rewound + 1, static_cast<int>(still.winch.told.size()));
}

TEST(Attachments, OneThatWantsAShorterWindowIsNamedAndAllAreTakenBack) {
  Standing still;
  still.winch.answer.retry_smaller_dt = true;
  still.winch.answer.dt_limit = 0.03;
  still.winch.answer.why = "the drum is too fast";
  Scheme scheme = still.scheme(at_point(1, 3));
  const WindowReport report = scheme.advance({0, 0.1});
  EXPECT_TRUE(report.retry);
  EXPECT_EQ(report.dt_limit, 0.03);
  EXPECT_NE(report.why.find("winch asks for a shorter window"), std::string::npos) << report.why;
  EXPECT_EQ(still.winch.rewound, 1);
}

TEST(Attachments, WrongAnswersNameTheAttachment) {
  const auto problem = [](const auto& act) {
    try {
      act();
    } catch (const Error& error) {
      return error.where() + ": " + error.problem();
    }
    return std::string("nothing was thrown");
  };
  Standing other;
  other.winch.announce({models::y_field("displacement", "m", VectorXd::Zero(1))});
  EXPECT_NE(problem([&] { other.scheme(at_point(0, 3)); }).find("attachments.winch: announces other fields"),
            std::string::npos);
  Standing wide;
  EXPECT_NE(problem([&] {
              wide.scheme(SparseOperator(SparseOperator::Matrix(2, 3)));
            }).find("sent a mesh of 1 points, it is attached at 2"),
            std::string::npos);
  Standing nan;
  nan.winch.answer.output = {models::y_field("force", "N", VectorXd::Constant(1, std::nan("")))};
  Scheme scheme = nan.scheme(at_point(0, 3));
  EXPECT_NE(problem([&] { scheme.advance({0, 0.1}); }).find("winch, window 1"), std::string::npos);
}

}  // namespace attachments_test
}  // namespace strake
