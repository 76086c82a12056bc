#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/boundary/collision.hpp"
#include "fluid/least_squares/acoustic_substepping.hpp"
#include "fluid/least_squares/scheme.hpp"
#include "fluid/mps/pressure_equation.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/pressure_solver/poisson_solver.hpp"
#include "fluid/simulation/simulation.hpp"
#include "fluid/viscosity/viscous_stage.hpp"

#include <Eigen/Core>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace strake::fluid {

/// Adds the wall seconds of its life to one stage.
class StageClock {
 public:
  StageClock(std::map<std::string, double>& seconds, const char* stage)
      : seconds_(seconds[stage]), start_(std::chrono::steady_clock::now()) {}
  ~StageClock() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_;
};

/// The stages of one step and what they hand to one another: private to simulation.cpp and step.cpp. All that
/// outlives a step is in `state`; the rest is memory used again.
template <int dim>
struct Simulation<dim>::Work {
  Work(const Parameters&, const InterfaceMesh& partner, const Points& initial_velocity);

  void hold_places(double dt, double rest, double stable);
  void sort_along_cells();
  void begin(double dt, const InterfaceMotion&);
  void find_neighbours();
  void find_stresses();
  void predict();
  void filter_velocity();
  void measure_number_density();
  void solve_pressure();
  void correct();
  void shift();
  void load_interface();
  void finish();

  void search_neighbours();
  void classify_rows();
  bool laid_bare(std::int64_t i, const Neighbours& near) const;
  void assemble();
  void correct_fitted();
  double farthest_of_bodies() const;
  void check_finite() const;
  void park_lost();
  std::string where() const;  // "fluid, step 12 (t = 0.0042 s)"
  bool at_star() const { return p.scheme.density_at == DensityAt::star; }
  const Neighbours& near_density() { return search.within(density_lattice.radius); }
  const Neighbours& near_gradient() { return search.within(gradient_lattice.radius); }

  Parameters p;
  LatticeConstants density_lattice, gradient_lattice, divergence_lattice, laplacian_lattice;
  double mass;  // of a water particle [kg]
  State<dim> state;
  Boundary<dim> boundary;
  NeighbourSearch<dim> search;
  std::map<std::string, double> seconds;
  StepReport report;
  Vectors<dim> on_points;                   // on the boundary's points [N]
  Points force;                             // the same on the interface's [N]
  Eigen::Matrix2Xd carried;                 // see carried_pressure; volume coupling
  Vectors<dim> on_walls;                    // on each row of the tank with the dummies behind it [N]
  Vector<dim> floor = Vector<dim>::Zero();  // on the tank floor [N]

  // Scratch of one step.
  double dt = 0;
  Hold hold;
  const InterfaceMotion* motion = nullptr;
  const Neighbours* far = nullptr;
  Vector<dim> gravity;
  ViscousStage<dim> viscous;
  WallRows<dim> walls;
  std::vector<double> wall_distance;  // of the water [m], with wall damping
  Vectors<dim> gradient;
  Eigen::VectorXd level;  // of the pairs of water and body, with the symmetric gradient
  Eigen::VectorXd n, divergence, deviation, guess;
  std::vector<Row> row;
  std::vector<std::uint8_t> solved, moves, wet;  // masks: unknowns; water; all but dry bodies
  std::vector<std::uint8_t> newly_aired;
  PressureSystem system;
  PoissonSolver<dim> poisson{laplacian_lattice.radius};
  CollisionAccount<dim> collisions;
  std::unique_ptr<FittedScheme<dim>> fitted;  // gradient = least-squares
};

}  // namespace strake::fluid
