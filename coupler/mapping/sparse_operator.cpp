#include "coupler/mapping/sparse_operator.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Matrix = SparseOperator::Matrix;

// Matrices with fewer entries than this are multiplied by one thread. Waking threads takes longer, and they
// then wait actively for more work: that time is lost to the solvers on the same machine.
constexpr Index entries_for_threads = 2'000'000;

/// Multiplies by the matrix. The number of components is a template argument where it is known at compile
/// time; 0: it is not.
template <int components>
void gather(const Matrix& weights, const double* value, double* mapped, Index n_components) {
  const Index c = components > 0 ? components : n_components;
  const auto* begin = weights.outerIndexPtr();
  const auto* column = weights.innerIndexPtr();
  const double* weight = weights.valuePtr();
  const Index rows = weights.rows();
#pragma omp parallel for schedule(static) if (weights.nonZeros() >= entries_for_threads)
  for (Index i = 0; i < rows; ++i) {
    double* sum = mapped + i * c;
    if constexpr (components == 3) {
      double x = 0, y = 0, z = 0;
      for (Index k = begin[i]; k < begin[i + 1]; ++k) {
        const double* v = value + 3 * static_cast<Index>(column[k]);
        x += weight[k] * v[0];
        y += weight[k] * v[1];
        z += weight[k] * v[2];
      }
      sum[0] = x;
      sum[1] = y;
      sum[2] = z;
    } else {
      std::fill(sum, sum + c, 0.0);
      for (Index k = begin[i]; k < begin[i + 1]; ++k)
        for (Index d = 0; d < c; ++d) sum[d] += weight[k] * value[c * column[k] + d];
    }
  }
}

/// Multiplies by a matrix whose rows are a single 1. This is a copy, of many points at once where they follow
/// one another. A sum that begins with 0 turns −0 into 0, and so does this. The test whether all values are
/// finite is done in the same pass.
bool select(const Matrix& weights, const double* value, double* mapped, Index c) {
  constexpr Index in_cache = 512, few = 4;  // points
  const auto* column = weights.innerIndexPtr();
  double none = 0;
  for (Index i = 0, end; i < weights.rows(); i = end) {
    for (end = i + 1; end < weights.rows() && end < i + in_cache && column[end] == column[end - 1] + 1;)
      ++end;
    const Index n = c * (end - i);
    const double* from = value + c * static_cast<Index>(column[i]);
    double* to = mapped + c * i;
    if (end - i < few) {
      for (Index k = 0; k < n; ++k) {
        to[k] = from[k] + 0.0;
        none += 0 * to[k];
      }
    } else {
      Eigen::Map<Eigen::ArrayXd> run(to, n);
      run = Eigen::Map<const Eigen::ArrayXd>(from, n) + 0.0;
      none += (run * 0).sum();
    }
  }
  return none == 0;
}

bool is_selection(const Matrix& matrix) {
  if (matrix.nonZeros() != matrix.rows()) return false;
  for (Index i = 0; i < matrix.rows(); ++i)
    if (matrix.outerIndexPtr()[i] != i || matrix.valuePtr()[i] != 1) return false;
  return true;
}

bool is_identity(const Matrix& selection) {
  if (selection.rows() != selection.cols()) return false;
  for (Index i = 0; i < selection.rows(); ++i)
    if (selection.innerIndexPtr()[i] != i) return false;
  return true;
}

}  // namespace

SparseOperator::SparseOperator(Matrix&& matrix) {
  const auto shared = std::make_shared<Matrix>();
  shared->swap(matrix);
  shared->makeCompressed();
  selects_ = is_selection(*shared);
  is_identity_ = selects_ && is_identity(*shared);
  matrix_ = shared;
}

/// Rows in ascending order of columns, with no copy of the matrix in between.
SparseOperator SparseOperator::transposed() const {
  const Matrix& matrix = *matrix_;
  Matrix transpose(matrix.cols(), matrix.rows());
  transpose.resizeNonZeros(matrix.nonZeros());
  int* begin = transpose.outerIndexPtr();  // begin[j + 1] first counts, then runs through row j
  for (Index k = 0; k < matrix.nonZeros(); ++k) ++begin[matrix.innerIndexPtr()[k] + 1];
  int next = 0;
  for (Index j = 0; j < transpose.rows(); ++j) next += std::exchange(begin[j + 1], next);
  for (Index i = 0; i < matrix.rows(); ++i)
    for (Matrix::InnerIterator w(matrix, i); w; ++w) {
      const int place = begin[w.col() + 1]++;
      transpose.innerIndexPtr()[place] = static_cast<int>(i);
      transpose.valuePtr()[place] = w.value();
    }
  return SparseOperator(std::move(transpose));
}

Index SparseOperator::empty_rows() const {
  Index empty = 0;
  for (Index i = 0; i < matrix_->rows(); ++i)
    if (matrix_->outerIndexPtr()[i] == matrix_->outerIndexPtr()[i + 1]) ++empty;
  return empty;
}

SparseOperator SparseOperator::embedded(const Place& rows, const Place& columns) const {
  const Matrix& block = *matrix_;
  assert(rows.first + block.rows() <= rows.size && columns.first + block.cols() <= columns.size);
  Matrix whole(rows.size, columns.size);
  whole.resizeNonZeros(block.nonZeros());
  const auto last = static_cast<int>(block.nonZeros());
  for (Index i = 0; i <= rows.size; ++i) {
    const Index own = i - rows.first;
    whole.outerIndexPtr()[i] = own <= 0 ? 0 : own < block.rows() ? block.outerIndexPtr()[own] : last;
  }
  for (Index k = 0; k < block.nonZeros(); ++k) {
    whole.innerIndexPtr()[k] = block.innerIndexPtr()[k] + static_cast<int>(columns.first);
    whole.valuePtr()[k] = block.valuePtr()[k];
  }
  return SparseOperator(std::move(whole));
}

Values SparseOperator::operator*(const Values& value) const {
  assert(value.cols() == matrix_->cols());
  if (is_identity_) return value;
  const Index components = value.rows();
  MatrixXd mapped(components, matrix_->rows());
  bool finite = false;
  if (selects_ && matrix_->nonZeros() < entries_for_threads)
    finite = select(*matrix_, value.data(), mapped.data(), components);
  else if (components == 3)
    gather<3>(*matrix_, value.data(), mapped.data(), components);
  else if (components == 1)
    gather<1>(*matrix_, value.data(), mapped.data(), components);
  else
    gather<0>(*matrix_, value.data(), mapped.data(), components);
  Values values(std::move(mapped));
  if (finite) values.mark_finite();
  return values;
}

}  // namespace strake
