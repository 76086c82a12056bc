#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/periodic.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/ranks/subdomain.hpp"
#include "fluid/viscosity/wall_law.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace strake::fluid {

/// The layer particles of walls and bodies for the viscous terms. Entry k is particle first + k.
template <int dim>
struct WallLayers {
  std::int64_t first = 0;            // particles [first, n) are layers, those before are water
  Vectors<dim> normal;               // of the face, into the water; zero: none (corner, structure particle)
  Eigen::VectorXd depth;             // of the particle behind the face [m]
  Vectors<dim> velocity;             // of the face in front of the particle [m/s]
  std::vector<std::int32_t> master;  // particle of the same face's first layer; −1: is one itself
  std::vector<std::uint8_t> slip;    // 1: the face is smooth

  std::int64_t size() const { return static_cast<std::int64_t>(master.size()); }
  /// Layer particles without a normal, at rest.
  void resize(std::int64_t first_row, std::int64_t rows);
  /// Has the next `describe_layers` describe all of them anew.
  void forget() { first = -1; }
};

/// Describes the layers of tank and bodies where they are now. slip: of all faces but those of structure
/// particles.
template <int dim>
void describe_layers(const Boundary<dim>&, const State<dim>&, bool slip, double spacing, WallLayers<dim>&);

/// The data that the viscous terms read.
template <int dim>
struct ViscousFlow {
  const Vectors<dim>& position;
  const Vectors<dim>& velocity;                // layers: of their wall
  const Neighbours &near, &far;                // reach radius_gradient, radius_laplacian
  const WallLayers<dim>& walls;                // the particles that are no water
  std::span<const std::uint8_t> wet = {};      // 0: a dry layer, without stress; empty: all wet
  std::span<const std::uint8_t> surface = {};  // 1: free surface; empty: none is
  Periodic<dim> periodic = {};                 // directions in which the flow repeats itself
  std::span<const double> wall_distance = {};  // [m], read with wall damping alone
  RankExchange<dim> ranks = {};                // the other ranks that compute this water

  bool dry(std::int64_t row) const { return !wet.empty() && !wet[static_cast<std::size_t>(row)]; }
};

/// Velocities that continue the water's flow behind the faces, for the viscous terms at the layers. Distances
/// d are from the face, positive in the water and −depth at the layer; u_w is the face's velocity.
///   no slip  u = u_w + d Σ w d_i (u_i − u_w)/Σ w d_i²: the line through u_w that fits the water best
///   slip     the same for the normal component; the mean Σ w u_i/Σ w for the others, whose slope is zero
/// Sums are over the water i within `radius` of the face's first layer. The velocity is exact for a flow that
/// is linear in the distance. In a corner it is u_w, or the point reflection 2 u_w − Σ w u_i/Σ w where it is
/// smooth. Dry layer particles, and those without water near, keep u_w.
///
/// With a wall law, faces without slip are smooth here where the water next to them is outside the viscous
/// sublayer. Their friction acts on that water instead, on particle i in proportion to w:
///   a_i = Σ_k τ_k w_ik/(l0 Σ_i w_ik), τ = −u_τ² t, t along the mean velocity Σ w u_i/Σ w (fluid/THEORY.md
///   (F76)).
/// Where the water does not cover the face, Σ w is that of a covered one.
template <int dim>
struct VelocityBehind {
  Vectors<dim> velocity;           // of each layer particle [m/s]
  Vectors<dim> slope, mean;        // of the water before each first layer, relative to u_w: [1/s], [m/s]
  std::vector<std::uint8_t> slip;  // of each layer particle: 1: treated as smooth
  Vectors<dim> friction;  // of each first layer particle on the water, τ/(l0 Σ w) [m/s²]; empty: none acts

  void extend(const ViscousFlow<dim>&, double radius, const std::optional<WallLaw>& = {});

  /// Adds the friction to the acceleration of the water, and the opposite to that of the layers.
  void add_friction(const ViscousFlow<dim>&, double radius, Vectors<dim>& acceleration) const;

 private:
  void find_friction(const ViscousFlow<dim>&, double radius, const WallLaw&);
  Eigen::VectorXd distance_, weight_;  // of the water before each first layer: mean from the face [m], Σ w
};

}  // namespace strake::fluid
