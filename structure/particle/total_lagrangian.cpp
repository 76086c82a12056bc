#include "structure/particle/total_lagrangian.hpp"

#include "structure/material.hpp"

#include <cmath>

namespace strake::structure {
namespace {

using Map2 = Eigen::Map<const Eigen::Matrix2d>;

}  // namespace

TotalLagrangian::TotalLagrangian(const Material& material, const Bonds& bonds, double volume,
                                 double hourglass)
    : material_(material),
      bonds_(bonds),
      volume_(volume),
      penalty_(hourglass * material.young * volume * bonds.second_moment.cwiseInverse()),
      influence_(2 * static_cast<int>(std::lround(bonds.r0.colwise().lpNorm<Eigen::Infinity>().maxCoeff() /
                                                  std::sqrt(volume)))) {}

//   f_i = Σ_j w⁰ [(V P_i A_i⁻¹ + V P_j A_j⁻¹) r⁰_ij + κ_i e_ij − κ_j e_ji]
// With H = F − 1 and u_ij = u_j − u_i, e_ij = u_ij − H_i r⁰_ij and e_ji = −u_ij + H_j r⁰_ij, hence
//   f_i = Σ_j w⁰ [(T_i + T_j) r⁰_ij + (κ_i + κ_j) u_ij],   T_i = V P_i A_i⁻¹ − κ_i H_i.
Eigen::Matrix2Xd TotalLagrangian::force(const Eigen::Matrix2Xd& u) const {
  const Eigen::Index n = bonds_.size();
  Eigen::Matrix4Xd T = displacement_gradient(bonds_, u);
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Matrix2d H = Map2(T.col(i).data()), A = Map2(bonds_.shape_inverse.col(i).data());
    const Eigen::Matrix2d F = Eigen::Matrix2d::Identity() + H;
    Eigen::Map<Eigen::Matrix2d>(T.col(i).data()) =
        volume_ * first_piola_kirchhoff<2>(material_, F) * A - penalty_[i] * H;
  }

  Eigen::Matrix2Xd f(2, n);
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    double fx = 0, fy = 0;
    const double ux = u(0, i), uy = u(1, i);
    for (Eigen::Index b = bonds_.start[static_cast<std::size_t>(i)];
         b < bonds_.start[static_cast<std::size_t>(i) + 1]; ++b) {
      const Eigen::Index j = bonds_.neighbour[static_cast<std::size_t>(b)];
      const double w = bonds_.weight[b], x = bonds_.r0(0, b), y = bonds_.r0(1, b);
      const double kappa = penalty_[i] + penalty_[j];
      fx += w * ((T(0, i) + T(0, j)) * x + (T(2, i) + T(2, j)) * y + kappa * (u(0, j) - ux));
      fy += w * ((T(1, i) + T(1, j)) * x + (T(3, i) + T(3, j)) * y + kappa * (u(1, j) - uy));
    }
    f(0, i) = fx;
    f(1, i) = fy;
  }
  return f;
}

double TotalLagrangian::energy(const Eigen::Matrix2Xd& u) const {
  const Eigen::Matrix4Xd H = displacement_gradient(bonds_, u);
  double total = 0;
  for (Eigen::Index i = 0; i < bonds_.size(); ++i) {
    const Eigen::Matrix2d Hi = Map2(H.col(i).data()), F = Eigen::Matrix2d::Identity() + Hi;
    double hourglass = 0;
    for (Eigen::Index b = bonds_.start[static_cast<std::size_t>(i)];
         b < bonds_.start[static_cast<std::size_t>(i) + 1]; ++b) {
      const Eigen::Index j = bonds_.neighbour[static_cast<std::size_t>(b)];
      hourglass += bonds_.weight[b] * (u.col(j) - u.col(i) - Hi * bonds_.r0.col(b)).squaredNorm();
    }
    total += volume_ * energy_density<2>(material_, F) + 0.5 * penalty_[i] * hourglass;
  }
  return total;
}

}  // namespace strake::structure
