#pragma once

#include "fluid/parameters.hpp"
#include "fluid/pressure.hpp"
#include "fluid/state.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace strake::fluid {

/// Solves the pressure equation again and again, with the method that scheme.pressure_solver and
/// .preconditioner name, in memory that it keeps. A solution is a function of system, places, guess and scheme
/// alone, to the last bit: nothing is carried from one solve to the next, and the number of threads does not
/// show (sums run in fixed blocks).
template <int dim>
class PoissonSolver {
 public:
  /// radius: reach of the Laplacian [m]; spacing: l0 [m].
  PoissonSolver(double radius, double spacing) : radius_(radius), spacing_(spacing) {}
  /// position: of all particles of the system. A residual that is not finite or too large is returned, not
  /// thrown: the caller knows time and CFL. The reference stays valid until the next solve.
  const PressureSolution& solve(const PressureSystem&, const Vectors<dim>& position,
                                const Eigen::VectorXd& guess, const Scheme&);
  /// What the last solve used, and why: for the log.
  const std::string& choice() const { return choice_; }

 private:
  double radius_, spacing_;
  std::string choice_;
  PressureSolution solution_;
};

}  // namespace strake::fluid
