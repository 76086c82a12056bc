#pragma once

#include "fluid/mps/pressure_equation.hpp"

// Solvers of libraries, to measure ours against. Each starts from solution.pressure.

namespace strake::fluid {

/// Conjugate gradients of Eigen with an incomplete Cholesky factor.
void solve_incomplete_cholesky(const PressureSystem&, double tolerance, int max_iterations,
                               PressureSolution&);
/// Cholesky factors of CHOLMOD.
void solve_cholmod(const PressureSystem&, PressureSolution&);
/// Conjugate gradients of hypre with one BoomerAMG cycle. Throws where hypre was not built.
void solve_hypre(const PressureSystem&, double tolerance, int max_iterations, PressureSolution&);
/// Whether hypre was there when this program was built.
bool has_hypre();

}  // namespace strake::fluid
