#pragma once

#include "fluid/particles/kernel.hpp"

#include <array>

namespace strake::fluid {

/// Sums of a lattice under a flat free surface, with which the least-squares scheme compares a particle.
/// "First" is the layer at the surface, half a spacing below it, "second" the one beneath that.
template <int dim>
class SurfaceLattice {
 public:
  SurfaceLattice(const LatticeConstants& laplacian, double spacing);

  double spacing;        // l0 [m]
  double weights;        // Σ w_L of the full lattice
  double first_weights;  // Σ w_L of the first layer
  double first_moment;   // |Σ w_L r| of the first layer [m]
  double second_moment;  // of the second [m]
  double volume;         // Σ W, W of volume_weight, of the full lattice without the particle itself

  /// Returns the depth of a particle under a flat surface [m] (F38). filled: the part of the ball of the
  /// Laplacian's radius that water fills, (Σ W + 1)/(volume + 1). Smooth water under y = d fills it to
  /// ∫_{y<d} W / ∫ W. The depths that this gives are corrected linearly, to be exact for the lattice's first
  /// and second layer. The sum counts water, so stretched water lies as deep as its volume is.
  double depth(double filled) const;

 private:
  static constexpr int layers = 62;  // of the radius
  std::array<double, layers + 1> filled_;
  double first_seen_, second_seen_;  // depth by ∫_{y<d} W / ∫ W of the first two layers [m]
  double layer_;                     // [m]
  double seen(double filled) const;
};

/// W = (1−q)⁴ (1+4q), q = r/radius: smooth, so that disorder hardly changes its sum (Wendland's C2 function).
inline double volume_weight(double q) {
  const double s = 1 - q, s2 = s * s;
  return s > 0 ? s2 * s2 * (1 + 4 * q) : 0.0;
}

}  // namespace strake::fluid
