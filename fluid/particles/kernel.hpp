#pragma once

namespace strake::fluid {

/// Computes w(r) = r_e/r − 1 for 0 < r < r_e, else 0 (Koshizuka & Oka 1996; fluid/THEORY.md (F13)). r,
/// radius: same unit.
inline double weight(double r, double radius) {
  return r < radius && r > 0 ? radius / r - 1.0 : 0.0;
}

/// Constants of one operator's radius on the full square or cubic lattice of spacing l0 (fluid/THEORY.md
/// (F15)).
struct LatticeConstants {
  double radius = 0;   // [m]
  double n0 = 0;       // Σ w
  double lambda0 = 0;  // [m²] Σ r² w / Σ w
  int neighbours = 0;  // N0
};
/// radius_in_spacings: r_e / l0; spacing: l0 [m].
template <int dim>
LatticeConstants lattice_constants(double radius_in_spacings, double spacing);

}  // namespace strake::fluid
