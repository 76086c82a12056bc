#pragma once

#include "structure/fem/element/assembly.hpp"
#include "structure/fem/linear/linear_solver.hpp"

#include <vector>

namespace strake::structure::fem {

/// The lowest `count` natural frequencies [Hz], ascending, of K x = (2πf)² M x with the fixed unknowns
/// constrained. `slowness` [s]: the time a wave needs along the body; it sets the shift. `tolerance`: of the
/// squares of the frequencies, relative. The solver is for matrices of the pattern of K and M. Of several
/// ranks each iterates with vectors of the whole body, and computes its part of the products.
std::vector<double> natural_frequencies(const Matrix& stiffness, const Matrix& mass,
                                        const std::vector<int>& fixed, const RankDivision&, int count,
                                        double slowness, LinearSolver, double tolerance = 1e-12);

}  // namespace strake::structure::fem
