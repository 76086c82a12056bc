#include "fluid/particles/kernel.hpp"

#include <cassert>
#include <cmath>

namespace strake::fluid {

// Computes n0 = Σ w(|r|) and λ = Σ |r|² w / Σ w over all lattice points but the origin (fluid/THEORY.md
// (F15)).
template <int dim>
LatticeConstants lattice_constants(double radius_in_spacings, double spacing) {
  static_assert(dim == 2 || dim == 3);
  assert(radius_in_spacings > 1 && spacing > 0);
  const int reach = static_cast<int>(std::ceil(radius_in_spacings));
  const int reach_z = dim == 3 ? reach : 0;
  LatticeConstants constants;
  constants.radius = radius_in_spacings * spacing;
  double moment = 0;  // Σ r² w in spacings²
  for (int z = -reach_z; z <= reach_z; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const double squared = x * x + y * y + z * z;
        const double w = weight(std::sqrt(squared), radius_in_spacings);
        if (w <= 0) continue;
        constants.n0 += w;
        moment += squared * w;
        ++constants.neighbours;
      }
  constants.lambda0 = moment / constants.n0 * spacing * spacing;
  return constants;
}

template LatticeConstants lattice_constants<2>(double, double);
template LatticeConstants lattice_constants<3>(double, double);

}  // namespace strake::fluid
