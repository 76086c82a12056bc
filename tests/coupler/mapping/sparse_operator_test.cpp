#include "coupler/mapping/sparse_operator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace strake {
namespace sparse_operator_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Matrix = SparseOperator::Matrix;

Matrix selection(const std::vector<int>& column, Index columns) {
  Matrix matrix(static_cast<Index>(column.size()), columns);
  for (std::size_t i = 0; i < column.size(); ++i) matrix.insert(static_cast<Index>(i), column[i]) = 1;
  return matrix;
}

/// The sum that an operator is, term by term.
MatrixXd sums(const Matrix& matrix, const MatrixXd& value) {
  MatrixXd mapped = MatrixXd::Zero(value.rows(), matrix.rows());
  for (Index i = 0; i < matrix.rows(); ++i)
    for (Matrix::InnerIterator w(matrix, i); w; ++w) mapped.col(i) += w.value() * value.col(w.col());
  return mapped;
}

bool same_bits(const Values& a, const MatrixXd& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

TEST(SparseOperator, ASelectionIsTheSumBitByBit) {
  constexpr int n = 3000;
  std::vector<int> ascending(n), shuffled, runs;
  std::iota(ascending.begin(), ascending.end(), 0);
  shuffled = runs = ascending;
  std::swap(ascending.front(), ascending.back());  // else it is the identity
  std::mt19937 random(1);
  std::shuffle(shuffled.begin(), shuffled.end(), random);
  for (int i = 0; i < n; ++i)
    runs[static_cast<std::size_t>(i)] = (i / 7 * 11 + i % 7) % n;  // some twice, some never
  for (const auto& column : {ascending, shuffled, runs})
    for (const Index components : {1, 2, 3, 6}) {
      MatrixXd value = MatrixXd::Random(components, n);
      value(0, 5) = -0.0;  // which a sum makes 0
      Matrix matrix = selection(column, n), same = matrix;
      const Values mapped = SparseOperator(std::move(matrix)) * value;
      EXPECT_TRUE(same_bits(mapped, sums(same, value))) << components;
      EXPECT_TRUE(mapped.known_finite());
    }
}

TEST(SparseOperator, TheIdentitySharesTheNumbers) {
  std::vector<int> column(700);
  std::iota(column.begin(), column.end(), 0);
  Values value = MatrixXd::Random(3, 700);
  const SparseOperator all(selection(column, 700));
  EXPECT_EQ((all * value).data(), value.data());
  EXPECT_EQ((all.transposed() * value).data(), value.data());
  EXPECT_FALSE((all * value).known_finite());
  EXPECT_TRUE(value.check_finite());
  EXPECT_TRUE((all * value).known_finite());
  const SparseOperator part(selection(column, 701));
  EXPECT_TRUE(same_bits(part * Values(MatrixXd::Ones(3, 701)), MatrixXd::Ones(3, 700)));
}

TEST(SparseOperator, ASelectionSeesWhatIsNotFinite) {
  std::vector<int> column(700);
  std::iota(column.begin(), column.end(), 0);
  std::swap(column[600], column[601]);
  const SparseOperator all(selection(column, 700)), one(selection({3}, 700));
  for (const Index bad : {0, 3, 511, 512, 699}) {
    MatrixXd value = MatrixXd::Ones(3, 700);
    value(1, bad) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE((all * value).known_finite()) << bad;
    EXPECT_EQ((one * value).known_finite(), bad != 3);
  }
}

TEST(SparseOperator, OtherWeightsAreSummed) {
  Matrix matrix(3, 4);
  matrix.insert(0, 1) = 1;
  matrix.insert(0, 3) = 0.5;
  matrix.insert(2, 0) = 1;
  const MatrixXd value = MatrixXd::Random(3, 4);
  Matrix same = matrix;
  const SparseOperator w(std::move(matrix));
  EXPECT_TRUE(same_bits(w * value, sums(same, value)));
  EXPECT_EQ(w.empty_rows(), 1);
  EXPECT_EQ(w.transposed().empty_rows(), 1);
  const MatrixXd back = MatrixXd::Random(3, 3);
  EXPECT_TRUE(same_bits(w.transposed() * back, sums(Matrix(same.transpose()), back)));
}

}  // namespace sparse_operator_test
}  // namespace strake
