#include "structure/particle/pair_model.hpp"

#include <cmath>

namespace strake::structure {
namespace {

constexpr int d = 2;  // space dimension of the factors 2d/n0 and d/n0

struct Stretch {
  Eigen::Vector2d u, e;  // u_ij [m] without rotation (S23), direction e_ij of the present bond
};

//   (S23) u_ij = r_ij − R_ij r⁰_ij, R_ij by ½(θ_i + θ_j): the product of both particles' half turns.
Stretch stretch(const Eigen::Matrix2Xd& u, const Eigen::Matrix2Xd& half, const Eigen::Vector2d& r0,
                Eigen::Index i, Eigen::Index j) {
  const Eigen::Vector2d r = r0 + u.col(j) - u.col(i);
  const double c = half(0, i) * half(0, j) - half(1, i) * half(1, j);
  const double s = half(0, i) * half(1, j) + half(1, i) * half(0, j);
  return {r - Eigen::Vector2d(c * r0.x() - s * r0.y(), s * r0.x() + c * r0.y()), r.normalized()};
}

Eigen::Matrix2Xd half_turns(const Eigen::VectorXd& turn) {
  Eigen::Matrix2Xd half(2, turn.size());
  half.row(0) = (0.5 * turn.array()).cos();
  half.row(1) = (0.5 * turn.array()).sin();
  return half;
}

}  // namespace

PairModel::PairModel(const Lattice<2>& lattice, const Bonds<2>& bonds, Rotation rotation)
    : bonds_(bonds),
      volume_(lattice.cell_volume()),
      lambda_(lattice.material(0).poisson != 0 ? lattice.material(0).lame_lambda() : 1.0),
      relative_lambda_(bonds.size()),
      mu_(bonds.weight.size()),
      rotation_(rotation),
      influence_(3 * static_cast<int>(std::lround(bonds.r0.colwise().lpNorm<Eigen::Infinity>().maxCoeff() /
                                                  lattice.spacing))) {
  for (Eigen::Index i = 0; i < bonds.size(); ++i) {
    relative_lambda_[i] = lattice.material(i).lame_lambda() / lambda_;
    const double mine = lattice.material(i).lame_mu();
    for (Eigen::Index b = bonds.first(i); b < bonds.end(i); ++b) {
      const double other = lattice.material(bonds.to(b)).lame_mu();
      mu_[b] = mine == other ? mine : 2 * mine * other / (mine + other);
    }
  }
}

//   R1   θ_i = atan2(Σ w⁰ (r⁰×r)/|r⁰|², Σ w⁰ (r⁰·r)/|r⁰|²); the ratio normalises by the particle's own n_i
Eigen::Matrix2Xd PairModel::turn_of_neighbours(const Eigen::Matrix2Xd& u) const {
  const Eigen::Index n = bonds_.size();
  Eigen::Matrix2Xd half_turn(2, n);
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    double cosine = 0, sine = 0;
    for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b) {
      const Eigen::Index j = bonds_.to(b);
      const Eigen::Vector2d r0 = bonds_.r0.col(b), r = r0 + u.col(j) - u.col(i);
      const double w = bonds_.weight[b] / r0.squaredNorm();
      cosine += w * r0.dot(r);
      sine += w * (r0.x() * r.y() - r0.y() * r.x());
    }
    const double length = std::hypot(cosine, sine);
    if (length == 0) {  // no bond is left
      half_turn.col(i) << 1, 0;
      continue;
    }
    const double half = std::sqrt(0.5 * (1 + cosine / length));
    half_turn.col(i) << half, 0.5 * sine / length / half;
  }
  return half_turn;
}

//   (S25) (ε_rr)_i = (d/n0) Σ_j (u^n_ij·e_ij)/|r⁰_ij| w⁰_ij
PairModel::Kinematics PairModel::kinematics(const Eigen::Matrix2Xd& u, Eigen::Matrix2Xd half_turn) const {
  const Eigen::Index n = bonds_.size();
  Kinematics k{std::move(half_turn), Eigen::VectorXd(n)};
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    double sum = 0;
    for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b) {
      const Eigen::Index j = bonds_.to(b);
      const Stretch s = stretch(u, k.half_turn, bonds_.r0.col(b), i, j);
      sum += s.u.dot(s.e) / bonds_.r0.col(b).norm() * bonds_.weight[b];
    }
    k.trace[i] = d / bonds_.n0 * sum;
  }
  return k;
}

//   (S24) σ_ij + τ_ij = 2μ_s u_ij/|r⁰_ij|
//   (S26) f_i += V (2d/n0) Σ_j (σ_ij + τ_ij)/|r⁰_ij| w⁰_ij
//   (S25) p_i = −λ_s (ε_rr)_i     (S26) f_i −= V (2d/n0) Σ_j ½(p_i + p_j) e_ij/|r⁰_ij| w⁰_ij
//   R2   M_i = ½ Σ_j r_ij × F^τ_ij, and since σ_ij and the pressure pull along r_ij, r_ij × F_ij is the same
Vectors<2> PairModel::force(const Eigen::Matrix2Xd& u, const Kinematics& k, Eigen::VectorXd* torque) const {
  const Eigen::Index n = bonds_.size();
  const double factor = volume_ * 2 * d / bonds_.n0;
  Eigen::Matrix2Xd f(2, n);
#pragma omp parallel for schedule(static) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double moment = 0;
    for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b) {
      const Eigen::Index j = bonds_.to(b);
      const Eigen::Vector2d r0 = bonds_.r0.col(b);
      const double length = r0.norm();
      const Stretch s = stretch(u, k.half_turn, r0, i, j);
      const double pressure =
          -lambda_ * 0.5 * (relative_lambda_[i] * k.trace[i] + relative_lambda_[j] * k.trace[j]);
      const Eigen::Vector2d pull = (2 * mu_[b] / length * s.u - pressure * s.e) * (bonds_.weight[b] / length);
      sum += pull;
      if (torque) {
        const Eigen::Vector2d r = r0 + u.col(j) - u.col(i);
        moment += 0.5 * (r.x() * pull.y() - r.y() * pull.x());
      }
    }
    f.col(i) = factor * sum;
    if (torque) (*torque)[i] = factor * moment;
  }
  return f;
}

Vectors<2> PairModel::force(const Vectors<2>& u) const {
  return force(u, kinematics(u, turn_of_neighbours(u)), nullptr);
}

Vectors<2> PairModel::force(const Vectors<2>& u, const Eigen::VectorXd& turn, Eigen::VectorXd& torque) const {
  torque.resize(bonds_.size());
  return force(u, kinematics(u, half_turns(turn)), &torque);
}

// The energy whose gradient (S26) is for small strains:
//   U = Σ_bonds (2dμ_s V/n0) w⁰ |u_ij|²/|r⁰_ij|² + Σ_bonds b (dμ_s V/(2n0)) w⁰ (θ_i − θ_j)² + Σ_i ½ λ_s V
//   (ε_rr)_i²
// R2 has b = 0. R1 has b = 1, because there θ is not an unknown of its own: with c = 2dμ_s V/n0 the linear
// forces are those of ½ Σ_bonds k|u_j − u_i|² − ½ c Σ_i n_i θ_i², and the difference to the first sum is c/8
// Σ_i Σ_j w⁰ (θ_i − θ_j)².
double PairModel::bond_energy(const Eigen::Matrix2Xd& u, const Kinematics& k, double bending) const {
  const double spring = d * volume_ / bonds_.n0;  // times μ_s: half of a bond, each is met twice
  double total = 0;
  for (Eigen::Index i = 0; i < bonds_.size(); ++i) {
    double sum = 0;
    for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b) {
      const Eigen::Index j = bonds_.to(b);
      const Stretch s = stretch(u, k.half_turn, bonds_.r0.col(b), i, j);
      // θ_j − θ_i by twice the sine of its half: the same for small differences, and without a branch cut
      const double turn = 2 * (k.half_turn(0, i) * k.half_turn(1, j) - k.half_turn(1, i) * k.half_turn(0, j));
      sum += mu_[b] * bonds_.weight[b] *
             (s.u.squaredNorm() / bonds_.r0.col(b).squaredNorm() + bending * 0.25 * turn * turn);
    }
    total += spring * sum + 0.5 * lambda_ * relative_lambda_[i] * volume_ * k.trace[i] * k.trace[i];
  }
  return total;
}

double PairModel::energy(const Vectors<2>& u) const {
  return bond_energy(u, kinematics(u, turn_of_neighbours(u)), 1);
}

double PairModel::energy(const Vectors<2>& u, const Eigen::VectorXd& turn) const {
  return bond_energy(u, kinematics(u, half_turns(turn)), 0);
}

}  // namespace strake::structure
