#pragma once

#include <vector>

#include "structure/fem/assembly.hpp"

namespace strake::structure::fem {

/// The lowest `count` natural frequencies [Hz], ascending, of K x = (2πf)² M x with the fixed unknowns held.
/// `slowness` [s]: the time a wave needs along the body; it sets the shift.
std::vector<double> natural_frequencies(const Matrix& stiffness, const Matrix& mass,
                                        const std::vector<int>& fixed, int count, double slowness);

}  // namespace strake::structure::fem
