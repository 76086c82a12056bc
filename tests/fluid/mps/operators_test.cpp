#include "fluid/mps/operators.hpp"

#include "tests/fluid/lattice.hpp"

#include <gtest/gtest.h>
#include <omp.h>

namespace strake::fluid {
namespace operators_test {

constexpr double l0 = 0.01;

template <int dim>
struct Water {
  int side;
  Vectors<dim> position;
  NeighbourSearch<dim> search;
  LatticeConstants near, far;
  const Neighbours* rows;
  Water(int n, double disorder)
      : side(n),
        position(block<dim>(n, l0, disorder)),
        search(3.1 * l0, 0),
        near(lattice_constants<dim>(2.1, l0)),
        far(lattice_constants<dim>(3.1, l0)),
        rows(&search.update(position)) {}
  std::vector<std::int64_t> inside() const { return interior<dim>(side, 4); }
  Vector<dim> slope() const {
    Vector<dim> a;
    for (int d = 0; d < dim; ++d) a[d] = 3.0 - 5.0 * d;
    return a;
  }
  Eigen::VectorXd linear() const { return (position.transpose() * slope()).array() + 7.0; }
  Vectors<dim> velocity(unsigned seed) const {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> value(-1, 1);
    return Vectors<dim>::NullaryExpr(dim, position.cols(), [&] { return value(generator); });
  }
};

// Differences of equal numbers vanish; what is left is round-off of φ over l0.
constexpr double round_off = 1e-11;

template <int dim>
void constants_vanish() {
  const Water<dim> water(dim == 2 ? 15 : 9, 0.2);
  const Eigen::VectorXd phi = Eigen::VectorXd::Constant(water.position.cols(), 3.7);
  const Vectors<dim> u = Vectors<dim>::Constant(dim, water.position.cols(), -2.2);
  const auto correction = gradient_correction<dim>(water.position, *water.rows, water.near);
  EXPECT_EQ(gradient_min_pressure<dim>(water.position, phi, *water.rows, water.near).norm(), 0);
  EXPECT_EQ(gradient_corrected<dim>(water.position, phi, *water.rows, water.near, correction).norm(), 0);
  EXPECT_EQ(divergence<dim>(water.position, u, *water.rows, water.near).norm(), 0);
  EXPECT_EQ(laplacian<dim>(phi, *water.rows, water.far).norm(), 0);
  EXPECT_EQ(laplacian<dim>(u, *water.rows, water.far).norm(), 0);
  for (const auto& g : velocity_gradient<dim>(water.position, u, *water.rows, water.near))
    EXPECT_EQ(g.norm(), 0);
}
TEST(Operators, constants_give_zero_on_a_disordered_block) {
  constants_vanish<2>();
  constants_vanish<3>();
}

template <int dim>
void linear_is_exact() {
  const Water<dim> water(dim == 2 ? 15 : 9, 0.2);
  const auto correction = gradient_correction<dim>(water.position, *water.rows, water.near);
  const auto gradient =
      gradient_corrected<dim>(water.position, water.linear(), *water.rows, water.near, correction);
  Tensor<dim> shear = Tensor<dim>::Zero();
  for (int l = 0; l < dim; ++l)
    for (int m = 0; m < dim; ++m) shear(l, m) = 1.0 + l - 2.0 * m;
  const Vectors<dim> u = shear * water.position;
  const auto tensors = velocity_gradient<dim>(water.position, u, *water.rows, water.near, correction);
  for (const auto i : water.inside()) {
    EXPECT_LT((gradient.col(i) - water.slope()).norm(), round_off * water.slope().norm());
    EXPECT_LT((tensors[static_cast<std::size_t>(i)] - shear).norm(), round_off);
  }
}
TEST(Operators, the_corrected_gradient_is_exact_for_linear_fields_on_a_disordered_block) {
  linear_is_exact<2>();
  linear_is_exact<3>();
}

TEST(Operators, the_plain_gradients_are_exact_for_linear_fields_on_a_lattice) {
  const Water<2> water(15, 0);
  const auto phi = water.linear();
  const auto pairwise = gradient_pairwise<2>(water.position, phi, *water.rows, water.near);
  const auto smallest = gradient_min_pressure<2>(water.position, phi, *water.rows, water.near);
  const Vectors<2> u = phi.transpose().replicate(2, 1);
  const auto div = divergence<2>(water.position, u, *water.rows, water.near);
  for (const auto i : water.inside()) {
    EXPECT_LT((pairwise.col(i) - water.slope()).norm(), 1e-9);
    EXPECT_LT((smallest.col(i) - water.slope()).norm(), 1e-9);
    EXPECT_NEAR(div[i], water.slope().sum(), 1e-9);
  }
}

template <int dim>
void quadratic_laplacian() {
  const Water<dim> water(dim == 2 ? 15 : 9, 0);
  const Eigen::VectorXd phi = water.position.colwise().squaredNorm().transpose();
  for (const auto& lattice : {water.near, water.far})
    for (const auto i : water.inside())
      EXPECT_NEAR(laplacian<dim>(phi, *water.rows, lattice)[i], 2.0 * dim, 1e-9);
}
TEST(Operators, the_laplacian_is_exact_for_a_parabola_on_a_lattice) {
  quadratic_laplacian<2>();
  quadratic_laplacian<3>();
}

TEST(Operators, the_pairwise_gradient_and_the_stress_divergence_sum_to_nothing) {
  const Water<2> water(15, 0.3);
  const auto u = water.velocity(3);
  const Eigen::VectorXd phi = u.row(0).transpose();
  const auto gradient = gradient_pairwise<2>(water.position, phi, *water.rows, water.near);
  EXPECT_LT(gradient.rowwise().sum().norm(), 1e-13 * gradient.cwiseAbs().sum());
  const auto tau = velocity_gradient<2>(water.position, u, *water.rows, water.near);
  const auto force = stress_divergence<2>(water.position, tau, *water.rows, water.near);
  EXPECT_LT(force.rowwise().sum().norm(), 1e-13 * force.cwiseAbs().sum());
}

TEST(Operators, the_min_pressure_gradient_never_pulls) {
  // One particle of high pressure among equals: pushed apart, and its neighbours are pushed away from it.
  const Water<2> water(11, 0);
  Eigen::VectorXd phi = Eigen::VectorXd::Zero(121);
  phi[60] = 1000;
  const auto gradient = gradient_min_pressure<2>(water.position, phi, *water.rows, water.near);
  EXPECT_LT(gradient.col(60).norm(), 1e-9);
  EXPECT_LT(gradient(0, 61), 0);  // acceleration −∇p/ρ points to +x, away from particle 60
  EXPECT_GT(gradient(0, 59), 0);
}

TEST(Operators, the_correction_falls_back_to_the_identity_where_support_is_poor) {
  Water<2> water(9, 0);
  for (int i = 0; i < 81; ++i) water.position.col(i) << i * l0, 0.0;  // a string: no gradient across it
  const auto& rows = water.search.update(water.position);
  for (const auto& c : gradient_correction<2>(water.position, rows, water.near))
    EXPECT_EQ((c - Tensor<2>::Identity()).norm(), 0);
  const Water<2> full(9, 0);
  EXPECT_LT((gradient_correction<2>(full.position, *full.rows, full.near)[40] - Tensor<2>::Identity()).norm(),
            1e-12);
}

TEST(Operators, masked_rows_are_zero_and_masked_columns_are_not_summed) {
  const Water<2> water(11, 0.1);
  const auto phi = water.linear();
  std::vector<std::uint8_t> some(121, 1);
  for (std::size_t i = 0; i < 55; ++i) some[i] = 0;
  const auto all = gradient_pairwise<2>(water.position, phi, *water.rows, water.near);
  const auto rows = gradient_pairwise<2>(water.position, phi, *water.rows, water.near, {some, {}});
  EXPECT_EQ(rows.leftCols(55).norm(), 0);
  EXPECT_EQ((rows.rightCols(66) - all.rightCols(66)).norm(), 0);
  const Vectors<2> part = water.position.rightCols(66);
  NeighbourSearch<2> search(3.1 * l0, 0);
  const auto alone = gradient_pairwise<2>(part, phi.tail(66), search.update(part), water.near);
  const auto columns = gradient_pairwise<2>(water.position, phi, *water.rows, water.near, {some, some});
  EXPECT_EQ((columns.rightCols(66) - alone).norm(), 0);
}

TEST(Operators, results_do_not_depend_on_the_number_of_threads) {
  const Water<2> water(40, 0.2);
  const auto u = water.velocity(5);
  omp_set_num_threads(1);
  const auto one = laplacian<2>(u, *water.rows, water.far);
  omp_set_num_threads(2);
  const auto two = laplacian<2>(u, *water.rows, water.far);
  omp_set_num_threads(1);
  EXPECT_TRUE(one == two);
}

/// Water whose space repeats itself along x with the block's length; its fields depend on y alone.
struct Seam {
  int n = 15;
  Vectors<2> position = block<2>(n, l0, 0);
  NeighbourSearch<2> search{3.1 * l0, 0, Periodic<2>({n * l0, 0})};
  LatticeConstants lattice = lattice_constants<2>(2.1, l0);
  const Neighbours& rows;
  Seam() : rows((search.update(position), search.within(lattice.radius))) {}
  /// Largest difference of a value between a particle beside the seam and that in the middle of its row.
  template <class Value>
  double apart(Value&& value) const {
    const double left = position.row(0).minCoeff(), right = position.row(0).maxCoeff();
    double most = 0;
    for (Eigen::Index i = 0; i < position.cols(); ++i) {
      if (position(0, i) > left + 0.1 * l0 && position(0, i) < right - 0.1 * l0) continue;
      for (Eigen::Index j = 0; j < position.cols(); ++j)
        if (std::abs(position(1, j) - position(1, i)) < 0.1 * l0 &&
            std::abs(position(0, j) - 0.5 * (left + right)) < 0.1 * l0)
          most = std::max(most, (value(i) - value(j)).norm());
    }
    return most;
  }
};

TEST(Operators, a_seam_of_periodic_water_is_as_its_middle) {
  const Seam water;
  const Eigen::VectorXd phi = 1000 * water.position.row(1).transpose().array().square();
  Vectors<2> u = Vectors<2>::Zero(2, phi.size());
  u.row(0) = phi.transpose();
  u.row(1) = 2 * phi.transpose();
  const auto correction = gradient_correction<2>(water.position, water.rows, water.lattice);
  const auto tensors = velocity_gradient<2>(water.position, u, water.rows, water.lattice, correction);
  const Eigen::VectorXd div = divergence<2>(water.position, u, water.rows, water.lattice);
  const auto column = [](const Vectors<2>& all) {
    return [all](Eigen::Index i) { return all.col(i).eval(); };
  };
  const auto tensor = [](const std::vector<Tensor<2>>& all) {
    return [all](Eigen::Index i) { return all[static_cast<std::size_t>(i)]; };
  };
  EXPECT_GT(div.norm(), 1);
  EXPECT_LT(water.apart([&](Eigen::Index i) { return Vector<2>(div[i], 0); }), 1e-9);
  EXPECT_LT(water.apart(tensor(correction)), 1e-9);
  EXPECT_LT(water.apart(tensor(tensors)), 1e-9);
  EXPECT_LT(water.apart(column(gradient_min_pressure<2>(water.position, phi, water.rows, water.lattice))),
            1e-9);
  EXPECT_LT(water.apart(column(gradient_pairwise<2>(water.position, phi, water.rows, water.lattice))), 1e-9);
  EXPECT_LT(
      water.apart(column(gradient_corrected<2>(water.position, phi, water.rows, water.lattice, correction))),
      1e-9);
  EXPECT_LT(water.apart(column(stress_divergence<2>(water.position, tensors, water.rows, water.lattice))),
            1e-7);
}

}  // namespace operators_test
}  // namespace strake::fluid
