#include "coupler/acceleration/accelerator.hpp"

#include "proto/error.hpp"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace strake {
namespace accelerator_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// H(x) = A x + b with A random of a given spectral radius.
struct Linear {
  MatrixXd a;
  VectorXd b;
  VectorXd operator()(const VectorXd& x) const { return a * x + b; }
};

/// Largest |eigenvalue|, by Gelfand's formula lim ‖A^k‖^(1/k). A is squared fifty times.
double spectral_radius(MatrixXd a) {
  double logarithm = 0;
  for (int squared = 0; squared < 50; ++squared) {
    const double size = a.norm();
    logarithm += std::ldexp(std::log(size), -squared);
    a /= size;
    a = (a * a).eval();
  }
  return std::exp(logarithm);
}

Linear random_linear(int n, double radius, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Linear h = {MatrixXd::NullaryExpr(n, n, [&] { return normal(random); }),
              VectorXd::NullaryExpr(n, [&] { return normal(random); })};
  h.a *= radius / spectral_radius(h.a);
  return h;
}

/// Evaluations of H until the residual has fallen to `tolerance` of the first.
int iterations(Accelerator& accelerator, const Linear& h, double tolerance, int most = 500) {
  accelerator.start_window();
  VectorXd x = VectorXd::Zero(h.b.size());
  double first = 0;
  for (int k = 1; k <= most; ++k) {
    const VectorXd hx = h(x);
    if (k == 1) first = (hx - x).norm();
    if ((hx - x).norm() <= tolerance * first) return k;
    x = accelerator.next(x, hx);
  }
  return most + 1;
}

TEST(IqnIls, SolvesALinearProblemOfSizeNInNPlusTwoIterations) {
  for (const int n : {2, 5, 10, 20})
    for (const double radius : {0.5, 1.5, 5.0, 50.0})
      for (unsigned seed = 0; seed < 10; ++seed) {
        const auto accelerator = make_accelerator({"iqn-ils", 0.1, 8, 1e-3});
        // 1e-8: secants of a random map are ill-conditioned by orders of magnitude over round-off.
        EXPECT_LE(iterations(*accelerator, random_linear(n, radius, seed), 1e-8), n + 2)
            << "n " << n << ", radius " << radius << ", seed " << seed;
      }
}

TEST(IqnIls, UsesTheColumnsOfEarlierWindowsAtOnce) {
  const auto accelerator = make_accelerator({"iqn-ils", 0.1, 8, 1e-6});
  Linear h = random_linear(5, 3, 1);
  EXPECT_EQ(iterations(*accelerator, h, 1e-8), 7);
  h.b = random_linear(5, 3, 2).b;  // another window: the same map, another load
  EXPECT_EQ(iterations(*accelerator, h, 1e-8), 2);
  EXPECT_EQ(accelerator->last_step().columns, 5);
}

TEST(IqnIls, ForgetsWindowsBeyondTheNumberToReuse) {
  const auto accelerator = make_accelerator({"iqn-ils", 0.1, 2, 1e-6});
  for (unsigned window = 0; window < 5; ++window) {
    Linear h = random_linear(4, 2, 3);
    h.a *= 1 + 0.03 * window;  // each window has columns of its own, and earlier ones do not mislead
    iterations(*accelerator, h, 1e-8);
  }
  accelerator->start_window();
  EXPECT_EQ(accelerator->state().secants.windows.size(), 2u);
}

TEST(IqnIls, KeepsItsColumnsOverWindowsThatConvergeAtOnce) {
  const auto accelerator = make_accelerator({"iqn-ils", 0.1, 2, 1e-6});
  iterations(*accelerator, random_linear(4, 2, 3), 1e-8);
  const auto columns = accelerator->state().secants.columns();
  for (int quiet = 0; quiet < 10; ++quiet) {
    accelerator->start_window();
    accelerator->finish_window(VectorXd::Ones(4), VectorXd::Ones(4));
  }
  ASSERT_EQ(accelerator->state().secants.windows.size(), 1u);
  EXPECT_EQ(accelerator->state().secants.columns(), columns);
}

TEST(IqnIls, LeavesOutColumnsThatBringNothingNew) {
  const auto accelerator = make_accelerator({"iqn-ils", 0.1, 8, 1e-3});
  const Linear h = random_linear(3, 2, 5);
  int dropped = 0;
  for (int window = 0; window < 6; ++window) {
    accelerator->start_window();
    VectorXd x = VectorXd::Random(3);
    for (int k = 0; k < 3; ++k) {
      x = accelerator->next(x, h(x));
      dropped += accelerator->last_step().dropped;
    }
    EXPECT_TRUE(x.allFinite());
    EXPECT_LE(accelerator->last_step().columns, 3);
  }
  EXPECT_GT(dropped, 0) << "of two new columns in each window, where three are all that there can be";
}

TEST(Aitken, SolvesAScalarLinearProblemInThreeIterations) {
  for (const double factor : {-10.0, -2.0, -1.0, -0.5, 0.5, 3.0}) {
    const auto accelerator = make_accelerator({"aitken", 0.1, 0, 0});
    const Linear h = {MatrixXd::Constant(1, 1, factor), VectorXd::Constant(1, 1.0)};
    EXPECT_LE(iterations(*accelerator, h, 1e-12), 3) << "factor " << factor;
  }
}

TEST(Aitken, BeginsAWindowWithTheLastFactorUnlessTheInitialOneIsSmaller) {
  const auto accelerator = make_accelerator({"aitken", 0.5, 0, 0});
  const Linear h = {MatrixXd::Constant(1, 1, -3.0), VectorXd::Constant(1, 1.0)};
  iterations(*accelerator, h, 1e-12);
  EXPECT_NEAR(accelerator->state().relaxation, 0.25, 1e-12);
  EXPECT_EQ(iterations(*accelerator, h, 1e-12), 2);
  const auto careful = make_accelerator({"aitken", 0.1, 0, 0});
  iterations(*careful, h, 1e-12);
  careful->start_window();
  careful->next(VectorXd::Zero(1), VectorXd::Ones(1));
  EXPECT_EQ(careful->last_step().relaxation, 0.1);
}

TEST(Constant, RelaxesByItsFactor) {
  const auto accelerator = make_accelerator({"constant", 0.25, 0, 0});
  accelerator->start_window();
  EXPECT_EQ(accelerator->next(VectorXd::Constant(2, 1.0), VectorXd::Constant(2, 5.0)),
            VectorXd::Constant(2, 2.0));
}

TEST(Accelerator, StopsAtAValueThatIsNotFiniteAndNamesIt) {
  for (const char* kind : {"constant", "aitken", "iqn-ils", "iqn-imvj"}) {
    const auto accelerator = make_accelerator({kind, 0.1, 8, 1e-3});
    accelerator->start_window();
    VectorXd bad = VectorXd::Ones(4);
    bad[2] = NAN;
    try {
      accelerator->next(VectorXd::Zero(4), bad);
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::solver_fault);
      EXPECT_NE(e.problem().find("the interface motion that came back is not finite: value 2 of 4"),
                std::string::npos)
          << e.problem();
    }
  }
  EXPECT_THROW(make_accelerator({"newton"}), Error);
}

TEST(Accelerator, NamesTheFieldOfAStackedVectorThatIsNotFinite) {
  const auto accelerator = make_accelerator({"aitken"});
  accelerator->set_blocks({{"area", 3}, {"pressure", 4}});
  accelerator->start_window();
  VectorXd bad = VectorXd::Ones(7);
  bad[5] = INFINITY;
  try {
    accelerator->next(bad, VectorXd::Zero(7));
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(e.problem().find("the pressure that was sent is not finite: value 2 of 4 is inf"),
              std::string::npos)
        << e.problem();
  }
}

TEST(Accelerator, GoesOnBitEqualFromAState) {
  for (const char* kind : {"aitken", "iqn-ils", "iqn-imvj"}) {
    const Linear h = random_linear(6, 3, 9);
    const auto one = make_accelerator({kind, 0.1, 8, 1e-3}), other = make_accelerator({kind, 0.1, 8, 1e-3});
    iterations(*one, h, 1e-6, 20);
    one->start_window();
    VectorXd x = VectorXd::Zero(6);
    for (int k = 0; k < 2; ++k) x = one->next(x, h(x));
    Archive archive;
    one->state().save(archive);
    AcceleratorState state;
    state.load(archive);
    other->set_state(state);
    for (int k = 0; k < 2; ++k) {
      const VectorXd next = one->next(x, h(x));
      EXPECT_EQ(next, other->next(x, h(x)));
      x = next;
    }
  }
}

}  // namespace accelerator_test
}  // namespace strake
