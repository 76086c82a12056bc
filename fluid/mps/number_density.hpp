#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// Computes n_i = Σ_j w(|r_ij|), no self term (fluid/THEORY.md (F14)). radius: r_e [m].
Eigen::VectorXd number_density(const Neighbours&, double radius);
/// Counts N_i, the neighbours nearer than radius [m].
std::vector<std::int32_t> neighbour_counts(const Neighbours&, double radius);

/// The conditions under which a particle belongs to the free surface (fluid/THEORY.md (F24)).
struct SurfaceTest {
  double beta = 0.97;                              // n < beta n0 is needed, and with `none` enough
  SecondCriterion second = SecondCriterion::none;  // second condition
  double spacing = 0;                              // l0 [m]
  LatticeConstants lattice;                        // of radius_density
};

/// Returns 1 for particles of the free surface, 0 else. Dummies are always 0; the first layers of walls and
/// bodies and structure particles are tested. n: number_density at the same positions. rows: must reach
/// 2.1 l0 for `arc`. previous: flags of the step before, or empty at the start (then every particle counts as
/// surface before). With a second criterion a particle leaves the surface later than it enters it, so that a
/// flag does not flicker.
template <int dim>
std::vector<std::uint8_t> surface_flags(const Vectors<dim>& position, std::span<const Kind> kind,
                                        const Neighbours& rows, const Eigen::VectorXd& n, const SurfaceTest&,
                                        std::span<const std::uint8_t> previous);

}  // namespace strake::fluid
