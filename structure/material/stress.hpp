#pragma once

#include <Eigen/Core>

#include <cmath>

namespace strake::structure {

/// Cauchy stress xx, xy, xz, yy, yz, zz [Pa]: the order in which ParaView takes six components.
using Stress = Eigen::Matrix<double, 6, 1>;

/// √(3/2 s:s) of the deviator s [Pa].
template <class Vector>
double von_mises(const Vector& s) {
  return std::sqrt(0.5 * (std::pow(s[0] - s[3], 2) + std::pow(s[3] - s[5], 2) + std::pow(s[5] - s[0], 2)) +
                   3 * (s[1] * s[1] + s[2] * s[2] + s[4] * s[4]));
}

/// Of each column.
inline Eigen::MatrixXd von_mises_of(const Eigen::Ref<const Eigen::MatrixXd>& stress) {
  Eigen::MatrixXd result(1, stress.cols());
  for (Eigen::Index i = 0; i < stress.cols(); ++i) result(0, i) = von_mises(stress.col(i));
  return result;
}

}  // namespace strake::structure
