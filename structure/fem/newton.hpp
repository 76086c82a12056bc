#pragma once

#include "structure/fem/mesh/rank_division.hpp"

#include <Eigen/Core>

#include <functional>

namespace strake::structure::fem {

/// What is to be solved: r(x) = 0.
struct Equilibrium {
  /// r(x), zero in fixed unknowns, and the size of the forces that balance in it, against which it is
  /// measured.
  struct Residual {
    Eigen::VectorXd value;
    double scale = 0, floor = 0;  // floor: what round-off alone leaves
  };
  std::function<Residual(const Eigen::VectorXd& x)> residual;
  std::function<Eigen::VectorXd(const Eigen::VectorXd& r)> correction;  // A⁻¹ r with the tangent A at hand
  std::function<bool(const Eigen::VectorXd& x)> refresh;                // a new tangent at x; false: singular
  RankDivision division = {};                                           // of the unknowns
};

struct NewtonResult {
  Eigen::VectorXd x;
  int iterations = 0;
  bool converged = false, refreshed = false;
  double residual = 0, wanted = 0;  // [N]
};

/// Solves by modified Newton. It keeps the tangent while each correction at least halves the residual;
/// otherwise it computes a new one at the present x. With a new tangent it searches along the line until the
/// residual does no more work on the step. Every decision rests on residuals, none on time.
NewtonResult solve(const Equilibrium&, Eigen::VectorXd start, double tolerance, int max_iterations = 40);

}  // namespace strake::structure::fem
