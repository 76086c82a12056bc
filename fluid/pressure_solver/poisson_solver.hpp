#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/pressure_solver/conjugate_gradients.hpp"
#include "fluid/pressure_solver/multilevel.hpp"
#include "fluid/pressure_solver/pressure_system.hpp"

#include <Eigen/Core>

#include <string>

namespace strake::fluid {

/// What a pressure equation is solved with, and why.
struct PressureChoice {
  Preconditioner preconditioner = Preconditioner::jacobi;  // never automatic
  double compressible_share = 0;  // smallest part of a diagonal that is not held by differences
  double jacobi_iterations = 0;   // at most so many would the diagonal need; infinity: no bound
  std::string text() const;       // "multilevel: …", for the log
};

/// The choice for one system: what the scheme names; for `automatic` the diagonal where the bound
/// ln(2/ε) / ln((√κ+1)/(√κ−1)), κ = (2−s)/s, s the compressible share, is below what the grids cost, else the
/// grids. A function of the matrix alone.
PressureChoice choose_pressure_solver(const PressureSystem&, const Scheme&);
/// The same before there is a matrix: of rows inside the water, s = 1/(1 + 2d (c Δt)²/λ).
template <int dim>
PressureChoice expected_pressure_solver(const Parameters&, double dt);

/// Solves the pressure equation again and again, with the preconditioner that the scheme
/// names, in memory that it keeps. A solution is a function of system, places, guess and
/// scheme alone, to the last bit: nothing is carried from one solve to the next, and the number of threads
/// does not show (sums run in fixed blocks).
template <int dim>
class PoissonSolver {
 public:
  /// radius: reach of the Laplacian [m].
  explicit PoissonSolver(double radius) : radius_(radius) {}
  /// position: of all particles of the system. A residual that is not finite or too large is returned, not
  /// thrown: the caller knows time and CFL. The reference stays valid until the next solve.
  const PressureSolution& solve(const PressureSystem&, const Vectors<dim>& position,
                                const Eigen::VectorXd& guess, const Scheme&);
  /// Of the last solve.
  const PressureChoice& choice() const { return choice_; }
  /// Memory that nothing is kept in between two solves.
  SharedMemory& memory() { return cg_.memory(); }
  std::size_t bytes() const { return multilevel_.bytes() + cg_.bytes(); }

 private:
  double radius_;
  PressureChoice choice_;
  PressureSolution solution_;
  Multilevel<dim> multilevel_;
  ConjugateGradients cg_;
};

}  // namespace strake::fluid
