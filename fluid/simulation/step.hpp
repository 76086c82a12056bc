#pragma once

#include "fluid/air/air_under_body.hpp"
#include "fluid/boundary/collision.hpp"
#include "fluid/pressure_solver/poisson_solver.hpp"
#include "fluid/pressure_solver/ranked_pressure.hpp"
#include "fluid/scheme/fluid_scheme.hpp"
#include "fluid/scheme/step_data.hpp"
#include "fluid/simulation/simulation.hpp"
#include "fluid/viscosity/viscous_stage.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace strake::fluid {

/// The stages of one step, and the memory that they use again; private to Simulation. Stages in which
/// discretisations differ are functions of the scheme.
template <int dim>
struct Simulation<dim>::Work {
  Work(const Parameters&, const InterfaceMesh& partner, const Points& initial_velocity, const Ranks&);

  void begin(double dt, double rest, double stable, const InterfaceMotion&);
  void measure();
  void advance_air();
  void solve_pressure();
  void correct();
  void shift();
  void finish();

  void sort_along_cells();
  void find_stresses();
  void take_load(Load<dim>);
  /// The load on the part of the walls within that reach of a place [N], and its area [m, m²].
  std::array<double, 2> load_on_walls(const Eigen::Vector3d& at, double reach) const;
  void remove_lost();
  void remove(std::int64_t i, std::int64_t number);

  // On several ranks (ranks.cpp).
  void begin_on_ranks(const Ranks&);
  void take_part();        // of the whole state
  void count_particles();  // after those of this rank have changed
  void divide(bool balance);
  void begin_again();   // from another state
  void forget_ranks();  // that have written the state
  void remove_lost_together();
  void sum_collisions();
  CollidingRanks colliding_ranks();
  const Neighbours& pairs_of_ghosts(double distance);
  /// The largest of the ranks' extremes; of equal ones the first in the whole.
  Extreme largest_of_ranks(const Extreme&, std::int64_t place) const;

  struct Solved {
    const PressureSolution& solution;
    bool sealed;  // it has blocks without a fixed pressure
  };
  Solved solve_alone();
  Solved solve_together();
  Solved solve_on_first_rank();
  bool may_be_sealed() const;

  StepData<dim> step;
  std::unique_ptr<FluidScheme<dim>> scheme;
  std::unique_ptr<AirUnderBody<dim>> air;  // null: none is computed
  std::optional<NeighbourSearch<dim>> ghost_search;
  ViscousStage<dim> viscous;
  PressureSystem system;
  PoissonSolver<dim> poisson;

  // On several ranks alone.
  std::unique_ptr<RankedPressure<dim>> shared_pressure;  // null: the first rank solves the whole equation
  Vectors<dim> whole_position;                           // scratch of `solve_on_first_rank`, like the next
  PressureSystem whole_system;
  PressureSolution own_solution;

  StepReport report;
  Vectors<dim> on_points;                   // on the boundary's points [N]
  Points force;                             // the same on the interface's [N]
  Eigen::Matrix2Xd on_solids;               // see carried_pressure; volume coupling
  Vectors<dim> on_walls;                    // on each wall particle, with the dummies behind it [N]
  Vector<dim> floor = Vector<dim>::Zero();  // on the tank floor [N]
  CollisionAccount<dim> collisions;

  // Scratch of one step.
  WallLayers<dim> walls;
  std::vector<double> wall_distance;  // of the water [m], with wall damping
  Eigen::VectorXd guess;              // of the pressure [Pa]
  std::vector<std::uint8_t> wet;      // mask: all but dry bodies
};

}  // namespace strake::fluid
