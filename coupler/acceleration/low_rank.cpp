#include "coupler/acceleration/low_rank.hpp"

#include <Eigen/SVD>

#include <algorithm>

namespace strake {
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
