#pragma once

#include "structure/body/parameters.hpp"

#include <vector>

namespace strake::structure {

enum class BeamTheory {
  euler_bernoulli,
  timoshenko
};  // Timoshenko with shear factor 5/6 and rotatory inertia

/// The lowest `count` bending frequencies [Hz] of the plate as a beam in plane strain, without rigid motions.
/// The yardstick that a run prints beside its own numbers.
std::vector<double> beam_frequencies(const Plate&, const Material&, BeamTheory, int count);

/// "f1 698.9 Hz (Euler-Bernoulli), 686.0 Hz (Timoshenko)", for the lines of a solver.
std::string beam_line(const Plate&, const Material&);

}  // namespace strake::structure
