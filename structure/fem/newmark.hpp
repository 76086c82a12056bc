#pragma once

#include <Eigen/Core>

namespace strake::structure::fem {

/// Generalised-α (Chung & Hulbert 1993) with spectral radius ρ at infinite frequency:
///   M a_m + f(u_α) = F,  a_m = (1−α_m) a1 + α_m a0,  u_α = (1−α_f) u1 + α_f u0,
///   u1 = u0 + dt v0 + dt² [(½−β) a0 + β a1],  v1 = v0 + dt [(1−γ) a0 + γ a1],
///   α_m = (2ρ−1)/(ρ+1), α_f = ρ/(ρ+1), β = ¼(1−α_m+α_f)², γ = ½−α_m+α_f.
///
/// ρ = 1 gives α_m = α_f = ½, β = ¼, γ = ½. Then a0 and a1 enter only by their mean (v1−v0)/dt, with v1 =
/// 2(u1−u0)/dt − v0: Newmark's trapezoidal rule with F the mean force of the step, and no acceleration to
/// remember. The work F·(u1−u0) is then exactly the change of kinetic and strain energy.
struct TimeScheme {
  explicit TimeScheme(double rho) {
    alpha_m = (2 * rho - 1) / (rho + 1);
    alpha_f = rho / (rho + 1);
    gamma = 0.5 - alpha_m + alpha_f;
    beta = 0.25 * (1 - alpha_m + alpha_f) * (1 - alpha_m + alpha_f);
    mid_point = rho == 1;
  }
  /// dt² ∂a_m/∂u1.
  double inertia() const { return (1 - alpha_m) / beta; }
  /// a_m for the increment `leap` = u1 − u0 − dt v0.
  Eigen::VectorXd mean_acceleration(const Eigen::VectorXd& leap, const Eigen::VectorXd& a0, double dt) const {
    if (mid_point) return (2 / (dt * dt)) * leap;
    return (inertia() / (dt * dt)) * leap + (alpha_m - (1 - alpha_m) * (1 / (2 * beta) - 1)) * a0;
  }
  Eigen::VectorXd velocity(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1, const Eigen::VectorXd& v0,
                           const Eigen::VectorXd& a0, double dt) const {
    if (mid_point) return (2 / dt) * (u1 - u0) - v0;
    return (gamma / (beta * dt)) * (u1 - u0) + (1 - gamma / beta) * v0 + dt * (1 - gamma / (2 * beta)) * a0;
  }
  Eigen::VectorXd acceleration(const Eigen::VectorXd& leap, const Eigen::VectorXd& a0, double dt) const {
    if (mid_point) return a0;
    return (1 / (beta * dt * dt)) * leap - (1 / (2 * beta) - 1) * a0;
  }

  double alpha_m = 0.5, alpha_f = 0.5, beta = 0.25, gamma = 0.5;
  bool mid_point = true;
};

}  // namespace strake::structure::fem
