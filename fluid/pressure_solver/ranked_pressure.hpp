#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/pressure_solver/conjugate_gradients.hpp"
#include "fluid/pressure_solver/grid_ranks.hpp"
#include "fluid/pressure_solver/multilevel.hpp"
#include "fluid/pressure_solver/ranked_unknowns.hpp"
#include "fluid/ranks/shared_grid.hpp"

#include <Eigen/Core>

#include <memory>

namespace strake::fluid {

/// Solves the pressure equation on all ranks together, by conjugate gradients with the preconditioner of one
/// rank. Each rank sweeps over its own particles; the first grid's equation is left to a SharedGrid. The
/// solution is that of one rank within the tolerance, and the same for any number of threads.
template <int dim>
class RankedPressure {
 public:
  /// spacing: l0 [m].
  RankedPressure(const Subdomain<dim>& own, std::unique_ptr<SharedGrid> grid, double spacing)
      : subdomain_(own), grid_(std::move(grid)), spacing_(spacing) {}
  /// Solves the equation of the local particles, where copies have no rows, and zero as diagonal and right
  /// side. guess: of the pressure of each, copies included. may_be_sealed: blocks without P = 0 and without
  /// compressibility are looked for, and closed in the system.
  /// solution: one pressure per particle, right for own ones. Returns whether there are such blocks.
  bool solve(PressureSystem&, const Vectors<dim>& position, const Eigen::VectorXd& guess, bool may_be_sealed,
             const Scheme&, PressureSolution& solution);

 private:
  const Subdomain<dim>& subdomain_;
  GridRanks<dim> grid_;
  double spacing_;
  RankedUnknowns<dim> unknowns_;
  Multilevel<dim> multilevel_;
  ConjugateGradients cg_;
};

}  // namespace strake::fluid
