#include "coupler/acceleration/shared_columns.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>

#include <algorithm>
#include <cassert>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Rows that are worked on together: those of all columns stay in the second-level cache. Sums are taken
// within a strip, then over the strips in order.
constexpr Index strip = 1024;

// A direction this much shorter than its vector is the round-off of the projection.
constexpr double no_direction = 1e-14;

template <class Work>
void for_each_strip(Index n, const Work& work) {
  for (Index first = 0; first < n; first += strip) work(first, std::min(strip, n - first));
}

Index count(const SharedColumns& columns) {
  return static_cast<Index>(columns.size());
}

}  // namespace

VectorXd transposed_times(const SharedColumns& columns, const Eigen::Ref<const VectorXd>& v) {
  VectorXd product = VectorXd::Zero(count(columns));
  for_each_strip(v.size(), [&](Index first, Index n) {
    for (Index j = 0; j < count(columns); ++j)
      product[j] += columns[static_cast<std::size_t>(j)]->segment(first, n).dot(v.segment(first, n));
  });
  return product;
}

void add_times(const SharedColumns& columns, const VectorXd& a, Eigen::Ref<VectorXd> v) {
  for_each_strip(v.size(), [&](Index first, Index n) {
    for (Index j = 0; j < count(columns); ++j)
      v.segment(first, n) += a[j] * columns[static_cast<std::size_t>(j)]->segment(first, n);
  });
}

VectorXd subtract_and_project(const SharedColumns& columns, const VectorXd& a, Eigen::Ref<VectorXd> v) {
  VectorXd product = VectorXd::Zero(count(columns));
  for_each_strip(v.size(), [&](Index first, Index n) {
    for (Index j = 0; j < count(columns); ++j)
      v.segment(first, n) -= a[j] * columns[static_cast<std::size_t>(j)]->segment(first, n);
    for (Index j = 0; j < count(columns); ++j)
      product[j] += columns[static_cast<std::size_t>(j)]->segment(first, n).dot(v.segment(first, n));
  });
  return product;
}

SharedColumns combine(const SharedColumns& columns, const MatrixXd& m) {
  if (columns.empty() || m.cols() == 0) return {};
  assert(m.rows() == count(columns));
  const Index n = columns.front()->size();
  std::vector<VectorXd> product(static_cast<std::size_t>(m.cols()), VectorXd(n));
  MatrixXd from(std::min(strip, n), m.rows()), to(std::min(strip, n), m.cols());
  for_each_strip(n, [&](Index first, Index rows) {
    for (Index j = 0; j < m.rows(); ++j)
      from.col(j).head(rows) = columns[static_cast<std::size_t>(j)]->segment(first, rows);
    to.topRows(rows).noalias() = from.topRows(rows) * m;
    for (Index j = 0; j < m.cols(); ++j)
      product[static_cast<std::size_t>(j)].segment(first, rows) = to.col(j).head(rows);
  });
  SharedColumns result;
  for (VectorXd& column : product) result.push_back(std::make_shared<const VectorXd>(std::move(column)));
  return result;
}

MatrixXd to_matrix(const SharedColumns& columns) {
  if (columns.empty()) return {};
  MatrixXd matrix(columns.front()->size(), count(columns));
  for (Index j = 0; j < matrix.cols(); ++j) matrix.col(j) = *columns[static_cast<std::size_t>(j)];
  return matrix;
}

SharedColumns to_columns(const MatrixXd& matrix) {
  SharedColumns columns;
  for (Index j = 0; j < matrix.cols(); ++j)
    columns.push_back(std::make_shared<const VectorXd>(matrix.col(j)));
  return columns;
}

// Classical Gram–Schmidt, done twice: orthogonal to round-off whatever the vector (Giraud, Langou & Rozložník
// 2005, "twice is enough").
void OrthonormalBasis::append(VectorXd vector) {
  const double length = vector.norm();
  VectorXd projection = transposed_times(basis, vector);
  const VectorXd again = subtract_and_project(basis, projection, vector);
  add_times(basis, -again, vector);
  projection += again;
  const double fresh = vector.norm();
  const bool grows = fresh > no_direction * length;
  const Index rows = count(basis), columns = coordinates.cols();
  MatrixXd larger = MatrixXd::Zero(rows + (grows ? 1 : 0), columns + 1);
  larger.topLeftCorner(rows, columns) = coordinates;
  larger.col(columns).head(rows) = projection;
  if (grows) {
    larger(rows, columns) = fresh;
    vector /= fresh;
    basis.push_back(std::make_shared<const VectorXd>(std::move(vector)));
  }
  coordinates = std::move(larger);
}

void OrthonormalBasis::drop_oldest(Index n) {
  coordinates = coordinates.rightCols(coordinates.cols() - n).eval();
}

// T = U S with U orthonormal: V = (Q U) S.
void OrthonormalBasis::compress() {
  constexpr Index least = 8;
  const Index vectors = coordinates.cols();
  if (count(basis) <= vectors + std::max(least, vectors / 2)) return;
  if (vectors == 0) {
    *this = {};
    return;
  }
  const Eigen::HouseholderQR<MatrixXd> qr(coordinates);
  const MatrixXd u = qr.householderQ() * MatrixXd::Identity(count(basis), vectors);
  basis = combine(basis, u);
  coordinates = qr.matrixQR().topRows(vectors).triangularView<Eigen::Upper>();
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

OrthonormalBasis basis_of(const SharedColumns& columns, const VectorXd& scale) {
  OrthonormalBasis basis;
  for (const SharedColumn& column : columns) basis.append(column->cwiseProduct(scale));
  return basis;
}

SharedColumns scaled(const SharedColumns& columns, const VectorXd& scale) {
  SharedColumns result;
  for (const SharedColumn& column : columns)
    result.push_back(std::make_shared<const VectorXd>(column->cwiseProduct(scale)));
  return result;
}

}  // namespace

VectorXd LowRank::times(const VectorXd& v) const {
  VectorXd product = VectorXd::Zero(v.size());
  if (!left.empty()) add_times(left, transposed_times(right, v), product);
  return product;
}

void LowRank::add(const SharedColumns& more_left, const SharedColumns& more_right) {
  left.insert(left.end(), more_left.begin(), more_left.end());
  right.insert(right.end(), more_right.begin(), more_right.end());
}

// Truncates the singular values of the small matrix T_l T_zᵀ, which are those of
//   D J D⁻¹ = Q_l (T_l T_zᵀ) Q_zᵀ, with D L = Q_l T_l and D⁻¹ Z = Q_z T_z
void LowRank::truncate(Index rank, double smallest, const VectorXd& scale) {
  const VectorXd inverse = scale.cwiseInverse();
  const OrthonormalBasis l = basis_of(left, scale), z = basis_of(right, inverse);
  const Eigen::JacobiSVD<MatrixXd> svd(l.coordinates * z.coordinates.transpose(),
                                       Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& value = svd.singularValues();
  Index kept = 0;
  while (kept < std::min(rank, value.size()) && value[kept] > smallest * value[0]) ++kept;
  left = scaled(combine(l.basis, svd.matrixU().leftCols(kept) * value.head(kept).asDiagonal()), inverse);
  right = scaled(combine(z.basis, svd.matrixV().leftCols(kept)), scale);
}

void LowRank::save(Archive& archive, const std::string& name) const {
  if (left.empty()) return;
  archive.real[name + ".left"] = to_matrix(left);
  archive.real[name + ".right"] = to_matrix(right);
}

void LowRank::load(const Archive& archive, const std::string& name) {
  const auto l = archive.real.find(name + ".left"), z = archive.real.find(name + ".right");
  *this = {};
  if (l == archive.real.end() || z == archive.real.end()) return;
  left = to_columns(l->second);
  right = to_columns(z->second);
}

}  // namespace strake
