#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/pressure_solver/conjugate_gradients.hpp"
#include "fluid/pressure_solver/multilevel.hpp"
#include "fluid/pressure_solver/pressure_system.hpp"
#include "proto/ranks/communicator.hpp"

#include <Eigen/Core>

#include <string>

namespace strake::fluid {

/// The solver of a pressure equation, and the reason for it.
struct PressureChoice {
  Preconditioner preconditioner = Preconditioner::jacobi;  // never automatic
  double compressible_share = 0;  // smallest part of a diagonal that is more than its row's sum
  double jacobi_iterations = 0;   // bound of the iterations with the diagonal; infinity: none
  std::string text() const;       // "multilevel: …", for the log
};

/// Chooses the preconditioner of one system. It is the one that the scheme names. With `automatic` it is the
/// diagonal where its bound of iterations is at most what the grids cost, else the grids. The bound is (F62),
///   ln(2/ε) / ln((√κ+1)/(√κ−1)), κ = (2−s)/s, s the compressible share.
/// With `automatic` the choice is a function of the matrix and the tolerance alone.
PressureChoice choose_pressure_solver(const PressureSystem&, const Scheme&);
/// The same on several ranks, which agree.
PressureChoice choose_pressure_solver(const PressureSystem&, const Scheme&, Communicator&);
/// Chooses the same before there is a matrix, from rows inside the water: s = 1/(1 + 2d (c Δt)²/λ).
template <int dim>
PressureChoice expected_pressure_solver(const Parameters&, double dt);

/// Solves the pressure equation of each step, with the preconditioner of the scheme, in memory that it keeps.
/// A solution is a function of system, places, guess and scheme alone, to the last bit. Nothing is carried
/// from one solve to the next, and the number of threads changes nothing (sums run in fixed blocks).
template <int dim>
class PoissonSolver {
 public:
  /// radius: reach of the Laplacian [m].
  explicit PoissonSolver(double radius) : radius_(radius) {}
  /// Solves one system. position: of all particles of the system. A residual that is not finite or too large
  /// is returned, not thrown: the caller knows time and CFL. The reference stays valid until the next solve.
  const PressureSolution& solve(const PressureSystem&, const Vectors<dim>& position,
                                const Eigen::VectorXd& guess, const Scheme&);
  /// Returns the choice of the last solve.
  const PressureChoice& choice() const { return choice_; }
  /// Returns memory in which nothing is kept between two solves.
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
