#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/scheme/interface_motion.hpp"
#include "proto/interface.hpp"

#include <map>
#include <memory>
#include <string>

namespace strake::fluid {

/// What one step did.
struct StepReport {
  double cfl = 0;  // max |u| dt / l0
  int pressure_iterations = 0;
  double divergence_max = 0;  // [1/s] largest |∇·u| of inner fluid particles after correction
};

/// 0.25 l0 / (2 √(gH)) [s], H the depth of the water at the start, or with the least-squares gradient
/// 0.05 √(l0/g); infinity without gravity.
double column_step(const Parameters&);
/// The same in a tank whose water feels `field` = |g − a| [m/s²].
double column_step(const Parameters&, double field);
/// acoustic_cfl l0 / c [s]; infinity where sound sets no limit.
double acoustic_step(const Parameters&);

/// The MPS-LES method on owned particles: one object, one case. Knows nothing of files, messages or
/// processes.
template <int dim>
class Simulation {
 public:
  /// partner: the structure's mesh (surface: closed outline with faces; volume: solid points with mass;
  /// empty: none). Throws Error(case_file) when the body does not fit the tank or overlaps the water.
  Simulation(const Parameters&, const InterfaceMesh& partner, const Points& initial_velocity);
  ~Simulation();

  /// rest: of the window after this step [s]. Steps of one window may share a frozen configuration
  /// (acoustic_substepping.hpp): the last of them then moves the particles of `state`.
  StepReport step(double dt, const InterfaceMotion&, double rest = 0);
  /// Mean force of the last step on the interface points, 3×m [N] (per metre of depth in 2-D),
  /// fluid/THEORY.md (F51), (F58), (F59).
  const Points& interface_force() const;
  const InterfaceMesh& interface() const;
  double stable_dt() const;  // [s] at the present state
  const State<dim>& state() const;
  void set_state(const State<dim>&);      // invalidates neighbour lists and factorisations
  bool is_removed(std::int64_t i) const;  // particle i has left the tank
  /// Wall seconds per stage since construction: neighbours, predictor, density, pressure, corrector, load.
  const std::map<std::string, double>& seconds() const;
  /// Pressure of a sensor: −(force · n)/area over the interface points within diameter/2 of X (reference),
  /// [Pa]; or, when there is no body, the mean pressure of the wall row within diameter/2.
  double sensor_pressure(const Eigen::Vector3d& at, double diameter) const;
  /// Force of the water on the tank floor (the walls' lower side), [N]: the C1 check.
  Eigen::Vector3d floor_force() const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace strake::fluid
