#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/periodic.hpp"
#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cstdint>
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

  bool dry(std::int64_t row) const { return !wet.empty() && !wet[static_cast<std::size_t>(row)]; }
};

/// Velocities that continue the water's flow behind the faces, for the viscous terms at the layers. Distances
/// d are from the face, positive in the water and −depth at the layer; u_w is the face's velocity.
///   no slip  u = u_w + d Σ w d_i (u_i − u_w)/Σ w d_i²: the line through u_w that fits the water best
///   slip     the same for the normal component; the mean Σ w u_i/Σ w for the others, whose slope is zero
/// Sums are over the water i within `radius` of the face's first layer. The velocity is exact for a flow that
/// is linear in the distance. In a corner it is u_w, or the point reflection 2 u_w − Σ w u_i/Σ w where it is
/// smooth. Dry layer particles, and those without water near, keep u_w.
template <int dim>
struct VelocityBehind {
  Vectors<dim> velocity;     // of each layer particle [m/s]
  Vectors<dim> slope, mean;  // of the water before each first layer, relative to u_w: [1/s], [m/s]

  void extend(const ViscousFlow<dim>&, double radius);
};

}  // namespace strake::fluid
