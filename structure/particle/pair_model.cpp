#include "structure/particle/pair_model.hpp"

#include <cmath>

namespace strake::structure {
namespace {

constexpr int d = 2;  // space dimension of the factors 2d/n0 and d/n0

struct Stretch {
  Eigen::Vector2d u, e;  // u_ij [m] without rotation (37), direction e_ij of the present bond
};

//   (37) u_ij = r_ij − R_ij r⁰_ij, R_ij by ½(θ_i + θ_j): the product of both particles' half turns.
Stretch stretch(const Eigen::Matrix2Xd& u, const Eigen::Matrix2Xd& half, const Eigen::Vector2d& r0,
                Eigen::Index i, Eigen::Index j) {
  const Eigen::Vector2d r = r0 + u.col(j) - u.col(i);
  const double c = half(0, i) * half(0, j) - half(1, i) * half(1, j);
  const double s = half(0, i) * half(1, j) + half(1, i) * half(0, j);
  return {r - Eigen::Vector2d(c * r0.x() - s * r0.y(), s * r0.x() + c * r0.y()), r.normalized()};
}

}  // namespace

PairModel::PairModel(const Material& material, const Bonds& bonds, double volume)
    : material_(material),
      bonds_(bonds),
      volume_(volume),
      influence_(3 * static_cast<int>(std::lround(bonds.r0.colwise().lpNorm<Eigen::Infinity>().maxCoeff() /
                                                  std::sqrt(volume)))) {}

//   R1   θ_i = atan2(Σ w⁰ (r⁰×r)/|r⁰|², Σ w⁰ (r⁰·r)/|r⁰|²); the ratio normalises by the particle's own n_i
//   (41) (ε_rr)_i = (d/n0) Σ_j (u^n_ij·e_ij)/|r⁰_ij| w⁰_ij
PairModel::Kinematics PairModel::kinematics(const Eigen::Matrix2Xd& u) const {
  const Eigen::Index n = bonds_.size();
  Kinematics k{Eigen::Matrix2Xd(2, n), Eigen::VectorXd(n)};
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    double cosine = 0, sine = 0;
    for (Eigen::Index b = bonds_.start[static_cast<std::size_t>(i)];
         b < bonds_.start[static_cast<std::size_t>(i) + 1]; ++b) {
      const Eigen::Index j = bonds_.neighbour[static_cast<std::size_t>(b)];
      const Eigen::Vector2d r0 = bonds_.r0.col(b), r = r0 + u.col(j) - u.col(i);
      const double w = bonds_.weight[b] / r0.squaredNorm();
      cosine += w * r0.dot(r);
      sine += w * (r0.x() * r.y() - r0.y() * r.x());
    }
    const double length = std::hypot(cosine, sine);
    const double half = std::sqrt(0.5 * (1 + cosine / length));
    k.half_turn.col(i) << half, 0.5 * sine / length / half;
  }
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    double sum = 0;
    for (Eigen::Index b = bonds_.start[static_cast<std::size_t>(i)];
         b < bonds_.start[static_cast<std::size_t>(i) + 1]; ++b) {
      const Eigen::Index j = bonds_.neighbour[static_cast<std::size_t>(b)];
      const Stretch s = stretch(u, k.half_turn, bonds_.r0.col(b), i, j);
      sum += s.u.dot(s.e) / bonds_.r0.col(b).norm() * bonds_.weight[b];
    }
    k.trace[i] = d / bonds_.n0 * sum;
  }
  return k;
}

//   (39),(40) σ_ij + τ_ij = 2μ_s u_ij/|r⁰_ij|
//   (42) f_i += V (2d/n0) Σ_j (σ_ij + τ_ij)/|r⁰_ij| w⁰_ij
//   (41) p_i = −λ_s (ε_rr)_i     (43) f_i −= V (2d/n0) Σ_j ½(p_i + p_j) e_ij/|r⁰_ij| w⁰_ij
Eigen::Matrix2Xd PairModel::force(const Eigen::Matrix2Xd& u) const {
  const Eigen::Index n = bonds_.size();
  const Kinematics k = kinematics(u);
  const double factor = volume_ * 2 * d / bonds_.n0;
  const double mu2 = 2 * material_.lame_mu(), lambda = material_.lame_lambda();
  Eigen::Matrix2Xd f(2, n);
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (Eigen::Index b = bonds_.start[static_cast<std::size_t>(i)];
         b < bonds_.start[static_cast<std::size_t>(i) + 1]; ++b) {
      const Eigen::Index j = bonds_.neighbour[static_cast<std::size_t>(b)];
      const Eigen::Vector2d r0 = bonds_.r0.col(b);
      const double length = r0.norm();
      const Stretch s = stretch(u, k.half_turn, r0, i, j);
      const double pressure = -lambda * 0.5 * (k.trace[i] + k.trace[j]);
      sum += (mu2 / length * s.u - pressure * s.e) * (bonds_.weight[b] / length);
    }
    f.col(i) = factor * sum;
  }
  return f;
}

// The energy whose gradient (42),(43) are for small strains:
//   U = Σ_bonds (2dμ_s V/n0) w⁰ |u_ij|²/|r⁰_ij|² + Σ_bonds (dμ_s V/(2n0)) w⁰ (θ_i − θ_j)² + Σ_i ½ λ_s V
//   (ε_rr)_i²
// The second sum is there because θ is not an unknown of its own: with c = 2dμ_s V/n0 the linear forces are
// those of ½ Σ_bonds k|u_j − u_i|² − ½ c Σ_i n_i θ_i², and the difference to the first sum is c/8 Σ_i Σ_j w⁰
// (θ_i − θ_j)².
double PairModel::energy(const Eigen::Matrix2Xd& u) const {
  const Kinematics k = kinematics(u);
  const double spring = d * material_.lame_mu() * volume_ / bonds_.n0;  // half of a bond: each is met twice
  double total = 0;
  for (Eigen::Index i = 0; i < bonds_.size(); ++i) {
    double sum = 0;
    for (Eigen::Index b = bonds_.start[static_cast<std::size_t>(i)];
         b < bonds_.start[static_cast<std::size_t>(i) + 1]; ++b) {
      const Eigen::Index j = bonds_.neighbour[static_cast<std::size_t>(b)];
      const Stretch s = stretch(u, k.half_turn, bonds_.r0.col(b), i, j);
      // θ_j − θ_i by twice the sine of its half: the same for small differences, and without a branch cut
      const double turn = 2 * (k.half_turn(0, i) * k.half_turn(1, j) - k.half_turn(1, i) * k.half_turn(0, j));
      sum += bonds_.weight[b] * (s.u.squaredNorm() / bonds_.r0.col(b).squaredNorm() + 0.25 * turn * turn);
    }
    total += spring * sum + 0.5 * material_.lame_lambda() * volume_ * k.trace[i] * k.trace[i];
  }
  return total;
}

}  // namespace strake::structure
