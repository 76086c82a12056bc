#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <span>

namespace strake::fluid {

/// Impulses that the anti-penetration step gave to what is not water [N s] (per metre of depth in 2-D).
template <int dim>
struct CollisionAccount {
  Vectors<dim> on_points;                      // dim×m, on the interface points
  Vector<dim> on_walls = Vector<dim>::Zero();  // on the tank
  Vector<dim> on_water = Vector<dim>::Zero();  // ΣJ: what the water got from bodies and tank
  std::int64_t inside = 0;                     // water particles found inside a body
  std::int64_t behind_walls = 0;               // found behind a wall of the tank
};

/// What several ranks need for collisions. owned: 1 for particles whose part the account takes; empty: all.
/// ghosts: returns the pairs of the others among themselves and with layers, up to a distance [m]; they have
/// no rows.
struct CollidingRanks {
  std::span<const std::uint8_t> owned = {};
  std::function<const Neighbours&(double)> ghosts = {};
};

/// Separates pairs of particles nearer than `collision_distance` that approach each other (fluid/THEORY.md
/// (F54)–(F56)):
///   collision  v_i' = v_i − (1+b) q e/m_i, v_j' = v_j + (1+b) q e/m_j,                (F54)
///              q = m_i m_j/(m_i+m_j) (v_i−v_j)·e
///   average    v_i' = v_i + s m_j/(m_i+m_j) (v_j−v_i),                                (F55)
///              s = 2/(1 + pairs of i or j, the larger)
///   both       r' = r + (v'−v) Δt                                                     (F56)
/// Layers of tank and body have infinite mass. Structure particles have their own mass, but their motion is
/// not changed; their impulse is added to the account. Pairs are treated one after the other, the closest
/// first. So the result is the same for any number of threads and any order of the particles, momentum is
/// exact, and no collision creates energy. With the least-squares gradient two particles inside the water
/// collide only below 0.7 l0.
///
/// Afterwards a water particle inside a body is put 0.05 l0 outside its face, and one behind a wall of the
/// tank on the face. Both lose their velocity into the face.
template <int dim>
CollisionAccount<dim> separate_particles(State<dim>& state, const Boundary<dim>&, const Neighbours& near,
                                         const Scheme&, double dt, double spacing, double particle_mass,
                                         const CollidingRanks& = {});

}  // namespace strake::fluid
