#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/ranks/ranks.hpp"
#include "fluid/ranks/subdomain.hpp"
#include "fluid/scheme/acoustic_substepping.hpp"
#include "fluid/scheme/interface_motion.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace strake::fluid {

/// Air over the water that is not at the pressure of the open air.
struct SurfaceAir {
  Eigen::VectorXd pressure;         // on the surface over each water particle [Pa]; empty: 0
  std::vector<std::uint8_t> aired;  // 1: wet point of a body with air between it and the water; empty: none

  double above(Eigen::Index particle) const { return pressure.size() > 0 ? pressure[particle] : 0; }
};

/// What the stages of a step read and write, whatever the scheme. All that outlives a step is in `state`.
template <int dim>
struct StepData {
  /// On several ranks `state` is the whole, or where it can be a rank's share of the water. Throws
  /// Error(case_file) when a body leaves the tank or overlaps the water.
  StepData(const Parameters&, const InterfaceMesh& partner, const Points& initial_velocity, PairData,
           const Ranks&);

  /// Neighbour rows of the largest radius at the present positions. Pairs around a body's corner have the
  /// length of that way.
  void search_neighbours();
  const Neighbours& near_density() { return search.within(density_lattice.radius); }
  const Neighbours& near_gradient() { return search.within(gradient_lattice.radius); }
  /// Computes u += Δt (ν∇²u + ∇·τ + g) of the water, and adds gravity's impulse to its account.
  void accelerate();
  /// Moves bodies and tank to the end of the step. Volume coupling has placed its particles at the start.
  void move_boundaries();
  /// Throws Error(solver_fault) that names the first water particle whose position or velocity is not finite.
  void check_finite() const;
  std::string where() const;  // "fluid, step 12 (t = 0.0042 s)"

  Parameters p;
  LatticeConstants density_lattice, gradient_lattice, divergence_lattice, laplacian_lattice;
  double mass;                    // of a water particle [kg]
  std::int64_t shared_water = 0;  // at the start, where `state` has a share of so much water; 0: the whole
  State<dim> state;
  Boundary<dim> boundary;
  NeighbourSearch<dim> search;
  std::map<std::string, double> seconds;  // wall clock of each stage

  std::unique_ptr<Subdomain<dim>> subdomain;  // of this rank; null: there is one rank
  RankExchange<dim> ranks;
  double dt = 0;  // Δt [s]
  AcousticSubstepping substepping;
  const InterfaceMotion* motion = nullptr;
  const Neighbours* far = nullptr;            // of the last `search_neighbours`
  Vector<dim> gravity = Vector<dim>::Zero();  // [m/s²]
  const Vectors<dim>* viscous = nullptr;      // ν∇²u + ∇·τ at every particle [m/s²]
  SurfaceAir air;
  std::vector<std::uint8_t> newly_connected;  // scratch of `follow_air`

 private:
  State<dim> start(const InterfaceMesh& partner, const Ranks&);
  void lengthen_around_corners();
};

}  // namespace strake::fluid
