#pragma once

#include "fluid/particles/state.hpp"
#include "fluid/ranks/subdomain.hpp"

#include <cstdint>
#include <span>
#include <string>

namespace strake::fluid {

/// Sums over all of the water; per metre of depth in 2-D.
template <int dim>
struct WaterAccount {
  double kinetic = 0;                        // [J] ½ Σ m u²
  double potential = 0;                      // [J] −Σ m g·(x − x0), x0 the corner of the tank
  double largest_speed = 0;                  // [m/s]
  std::int64_t inner = 0, surface = 0;       // particles
  Vector<dim> centre = Vector<dim>::Zero();  // [m] of mass
};
/// Computes the sums over the particles in `water`, by their numbers. mass: of each [kg].
template <int dim>
WaterAccount<dim> account_of(const State<dim>&, std::span<const std::int64_t> water, double mass,
                             const Vector<dim>& gravity, const Vector<dim>& corner);

/// Adds up the sums of all ranks.
template <int dim>
WaterAccount<dim> together(WaterAccount<dim> own, const RankExchange<dim>&);

/// Returns the front of the water layer along a floor, x [m]. From `at`, on the floor, particles within 2 l0
/// above it are followed towards +x until a gap of more than 2 l0. The front is the x of the last one plus
/// l0/2, or `at` itself where there is none. Drops that fly ahead do not count.
template <int dim>
double front(const Vectors<dim>& position, std::span<const std::int64_t> water, const Vector<dim>& at,
             double spacing);

/// Returns the height at which the water over `at` ends [m above `at`]. Particles within l0 of `at` along x
/// (and z) are followed upwards until a gap of more than 2 l0. The level is the highest one's height plus
/// l0/2.
template <int dim>
double level(const Vectors<dim>& position, std::span<const std::int64_t> water, const Vector<dim>& at,
             double spacing);

/// Returns the wetted length over `at` [m], which a wave gauge measures:
///   Σ V_i w(x_i − x) over the particles above `at`.
/// w is the hat of half-width 2 l0, with ∫w = 1 over the stretch between low and high, the tank's sides. The
/// value is smooth, while `level` goes by whole particles. Air under a breaking wave does not count.
template <int dim>
double wetted_height(const Vectors<dim>& position, std::span<const std::int64_t> water, const Vector<dim>& at,
                     const Vector<dim>& low, const Vector<dim>& high, double spacing);

/// Whether one of these three may read a particle at `from_gauge`, seen from its `at` [m].
template <int dim>
bool gauge_reads(const std::string& quantity, const Vector<dim>& from_gauge, double spacing);

}  // namespace strake::fluid
