#pragma once

#include "tests/method/coupling/coupling_models.hpp"

#include <cmath>

/// cases/VALIDATION.md, "Piston and column": a piston of mass m on a spring k carries an incompressible
/// column of length ℓ with an open end, all per unit area: (m + ρℓ) x'' + k x = 0. Both sides by the
/// trapezoidal rule, the force is the window's mean. μ = ρℓ/m.
namespace strake::models {

constexpr double piston_stiffness = 1e6, piston_mass = 100, piston_start = 0.01;  // [N/m/m²], [kg/m²], [m]

inline double piston_period(double mu) {
  return 2 * M_PI * std::sqrt((1 + mu) * piston_mass / piston_stiffness);
}

/// The column starts where the piston is.
inline AddedMass piston_column(double mu) {
  AddedMass column(Eigen::MatrixXd::Constant(1, 1, mu * piston_mass), Eigen::VectorXd::Constant(1, 0.0),
                   Rule::trapezoidal);
  column.place(Eigen::VectorXd::Constant(1, piston_start));
  return column;
}

inline Oscillators piston_spring(bool send_velocity = false) {
  return {Eigen::MatrixXd::Constant(1, 1, piston_mass),
          Eigen::MatrixXd::Constant(1, 1, piston_stiffness),
          Eigen::VectorXd::Constant(1, piston_start),
          Eigen::VectorXd::Constant(1, 0.0),
          Rule::trapezoidal,
          send_velocity};
}

}  // namespace strake::models
