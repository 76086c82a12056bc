#pragma once

#include "fluid/diagnostics/guard.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/ranks/ranks.hpp"
#include "fluid/ranks/subdomain.hpp"
#include "fluid/scheme/interface_motion.hpp"
#include "proto/interface.hpp"

#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace strake::fluid {

/// Measures of one step.
struct StepReport {
  double cfl = 0;  // max |u| dt / l0
  int pressure_iterations = 0;
  double divergence_max = 0;  // [1/s] largest |∇·u| of inner fluid particles after correction
};

/// Returns the limit of the step by the column's weight [s]; infinity without gravity. It is
/// 0.25 l0 / (2 √(gH)), H the depth of the water at the start, or with the least-squares gradient 0.05
/// √(l0/g).
double column_step(const Parameters&);
/// Returns the same in a tank whose water feels `field` = |g − a| [m/s²].
double column_step(const Parameters&, double field);
/// Returns acoustic_cfl l0 / c [s]; infinity where sound sets no limit.
double acoustic_step(const Parameters&);

/// The particle method and its particles: one object, one case. It uses no files, messages or processes.
template <int dim>
class Simulation {
 public:
  /// partner: the structure's mesh (surface: closed outline with faces; volume: solid points with mass;
  /// empty: none). Throws Error(case_file) when the body does not fit the tank or overlaps the water.
  /// On several ranks all of them call the same functions with the same arguments. Throws Error(case_file)
  /// for what is computed on one rank alone.
  Simulation(const Parameters&, const InterfaceMesh& partner, const Points& initial_velocity,
             const Ranks& = {});
  ~Simulation();

  /// Advances by one step. rest: of the window after this step [s]. Steps of one window may share a frozen
  /// configuration (acoustic_substepping.hpp): the last of them then moves the particles of `state`.
  StepReport step(double dt, const InterfaceMotion&, double rest = 0);
  /// Returns the mean force of the last step on the interface points, 3×m [N] (per metre of depth in 2-D).
  /// Sources: fluid/THEORY.md (F51), (F58), (F59).
  const Points& interface_force() const;
  const InterfaceMesh& interface() const;
  double stable_dt() const;  // [s] at the present state
  /// Returns the state. On several ranks it is the part of this rank, with ghosts.
  const State<dim>& state() const;
  void set_state(const State<dim>&);  // of the whole fluid; neighbours are searched anew
  /// All that the simulation needs to go on from here.
  struct Snapshot {
    State<dim> state;
    std::shared_ptr<const Division> division;  // null: one rank
  };
  Snapshot snapshot() const;
  void restore(const Snapshot&);
  /// Returns the state of the whole fluid. On several ranks all of them call it together; the first one gets
  /// it, the others get no particles. For tests: it has the length of the whole.
  State<dim> whole() const;
  /// Returns the share of a rank in the state of the whole fluid, see Subdomain::share. All ranks call it
  /// together.
  State<dim> share_of(const Snapshot&) const;
  /// The same as `set_state` on several ranks: each has what Subdomain::ranges_of_part names.
  void set_share(State<dim>);
  std::int64_t particles() const;                            // of the whole fluid
  bool is_removed(const State<dim>&, std::int64_t i) const;  // particle i has left the tank
  const RankExchange<dim>& ranks() const;
  /// Returns wall seconds per stage since construction: neighbours, predictor, density, pressure, corrector,
  /// load, shift.
  const std::map<std::string, double>& seconds() const;
  /// Returns the pressure of a sensor, −(force · n)/area over the wet points within diameter/2 of `at` [Pa].
  /// Distances are those of the reference. In volume coupling it is the mean of `carried_pressure` over the
  /// structure particles there. Without a body it is −(force · n)/area over the wall particles whose faces
  /// lie there.
  double sensor_pressure(const Eigen::Vector3d& at, double diameter) const;
  /// Returns the force of the water on the tank floor (the walls' lower side) [N].
  Eigen::Vector3d floor_force() const;
  /// Returns the pieces of the bodies' faces where they are now, with the load of the last step. In volume
  /// coupling there are none.
  std::vector<FacePiece> face_pieces() const;
  /// Returns the highest pressure of the last step on a piece of the bodies' faces, −(force · n)/area [Pa].
  Extreme highest_pressure() const;
  /// Air under the body now [kg], in two dimensions [kg/m]; 0 where none is computed.
  double air_mass() const;
  /// Energy of that air against the open air [J], in two dimensions [J/m].
  double air_energy() const;
  /// Columns of air, their area seen from above [m², in two dimensions m], and the half width of the largest
  /// field [m].
  struct AirExtent {
    std::int64_t columns = 0;
    double area = 0, half_width = 0;
  };
  AirExtent air_extent() const;
  /// The air under the body at a place of the reference: the nearest column's gap [m] and pressure less that
  /// of the open air [Pa], both 0 where the water touches the face. distance: of that column's face [m].
  struct AirAt {
    double gap = 0, pressure = 0, distance = std::numeric_limits<double>::infinity();
  };
  AirAt air_at(const Eigen::Vector3d& reference) const;
  /// The gap [m] and pressure [Pa] of the air before each particle of the first layer of a body; empty: no
  /// air is computed. Both are 0 where there is none.
  struct AirOnFaces {
    Eigen::VectorXd gap, pressure;  // of all particles
  };
  AirOnFaces air_on_faces() const;
  /// Returns the fastest particle of water now: its speed [m/s] and place.
  Extreme fastest() const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace strake::fluid
