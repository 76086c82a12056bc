#pragma once

#include "fluid/kernel.hpp"

namespace strake::fluid {

/// The full lattice's own sums under a flat free surface: what the least-squares scheme knows a surface by.
/// "First" is the row at the surface, "second" the one beneath it.
template <int dim>
struct SurfaceLattice {
  SurfaceLattice(const LatticeConstants& laplacian, const LatticeConstants& gradient, double spacing);

  double spacing;         // l0 [m]
  double weights;         // Σ w_L of the full lattice
  double first_weights;   // Σ w_L of the first row
  double first_moment;    // |Σ w_L r| of the first row [m]
  double second_moment;   // of the second [m]
  double first_crowding;  // |Σ w r/r²| of the first row, gradient's radius [1/m]
  double row_height;      // Σ w y² / Σ w y over the rows beneath the first, gradient's radius [m]
  double volume;          // Σ W, W of volume_weight, of the full lattice
};

/// (1−q)⁴ (1+4q), q = r/radius: smooth, so that disorder hardly changes its sum (Wendland's C2 function).
inline double volume_weight(double q) {
  const double s = 1 - q, s2 = s * s;
  return s > 0 ? s2 * s2 * (1 + 4 * q) : 0.0;
}

}  // namespace strake::fluid
