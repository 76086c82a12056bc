#pragma once

#include "fluid/parameters/tank_motion.hpp"
#include "proto/box.hpp"
#include "proto/case/case_keys.hpp"

#include <Eigen/Core>

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace strake::fluid {

enum class Source { divergence, mixed };
enum class DensityAt { star, old };
enum class Gradient { min_pressure, pairwise, corrected, least_squares };
enum class SecondCriterion { none, arc };
enum class AntiPenetration { none, average, collision };
enum class Turbulence { none, statics, k };
enum class SpsForm { joint, stress_pair };
enum class Preconditioner { automatic, jacobi, multilevel };
enum class WallSlip { no_slip, free_slip };

/// The scheme, fluid/THEORY.md (F13)–(F68). Defaults are preset "improved"; the paper's values are in read().
struct Scheme {
  double radius_density = 2.1, radius_gradient = 2.1, radius_divergence = 2.1,
         radius_laplacian = 3.1;  // [l0]
  double time_step = 2e-6;        // [s] largest
  double cfl = 0.6;               // max |u| dt / l0
  double acoustic_cfl = 0;        // c dt / l0; 0: sound sets no limit
  Source source = Source::mixed;
  DensityAt density_at = DensityAt::old;
  double gamma = 0.0;  // drift term per step; used when tau = 0
  double tau = 0.02;   // [s] gamma = dt / tau; 0: gamma is used
  Gradient gradient = Gradient::least_squares;
  double beta = 0.97;
  SecondCriterion second = SecondCriterion::arc;
  bool negative_pressure = false;  // a closed tank always has it
  AntiPenetration anti_penetration = AntiPenetration::collision;
  double collision_distance = 0.5;  // [l0]; 0.85 where pressure alone does not keep particles apart
  double restitution = 0.2;
  bool collision_conserve = true;
  Preconditioner preconditioner = Preconditioner::automatic;
  double pressure_tolerance = 1e-8;  // ‖b − A p‖₂ / ‖b‖₂
  int pressure_max_iterations = 5000;
  double filter = 4.0;  // of what ∇u does not explain, δ: viscosity filter · l0 · |δ|; pairwise · √(P/ρ)
  double shifting = 5.0;  // A of fluid/THEORY.md (F49); 0: off
  Turbulence turbulence = Turbulence::statics;
  SpsForm sps = SpsForm::joint;
  double c_nu = 0.08, c_eps = 1.0;  // C_s = (c_nu³/c_eps)^¼
  bool wall_damping = false;
};

/// Returns the scheme with that pressure gradient and the defaults that belong to it. Shifting and filter are
/// for least-squares alone. Volume coupling with `pairwise` gets the filter back when the case is read.
inline Scheme with_gradient(Scheme scheme, Gradient gradient) {
  scheme.gradient = gradient;
  if (gradient != Gradient::least_squares) {
    scheme.shifting = 0;
    scheme.filter = 0;
    scheme.cfl = 0.2;
    scheme.collision_distance = 0.85;
  }
  return scheme;
}

/// The velocity of the water at t = 0, value + gradient x, x from the origin of the case.
struct InitialVelocity {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();     // [m/s]
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();  // ∂u_i/∂x_j [1/s]
  bool is_zero() const { return value.isZero(0) && gradient.isZero(0); }
  Eigen::Vector3d at(const Eigen::Vector3d& x) const { return value + gradient * x; }
};

/// [fluid.air]: an ideal gas whose compression is adiabatic (fluid/THEORY.md (F77)).
struct AirKeys {
  bool layer = false;          // air between a body and the water is computed
  double pressure = 101325;    // p0 [Pa], of the open air
  double density = 1.204;      // ρ0 [kg/m³]
  double gamma = 1.4;          // ratio of specific heats [1]
  double viscosity = 1.82e-5;  // µ [Pa s]
  double film = 1e-5;          // δ [m]: each column keeps the air ρ0 δ
  int columns = 1;             // of air in a spacing, in the plane
  bool friction = true;
};

struct Parameters {
  int dimension = 2;
  double spacing = 0.01;                 // l0 [m]
  double density = 1000;                 // [kg/m^3]
  double kinematic_viscosity = 1e-6;     // [m²/s]
  Eigen::Vector3d gravity{0, -9.81, 0};  // [m/s²]
  double gravity_ramp = 0;               // [s] g · ½(1 − cos(πt/ramp)); 0: at once
  double sound_speed = 1500;             // [m/s]; infinity: incompressible
  double sound_depth =
      std::numeric_limits<double>::infinity();  // [m] of the water that has it, see SoundLayer
  Box tank, water;                              // [m]; a polygon's and several shapes' bounding box
  std::vector<Eigen::Vector3d> tank_polygon;    // [m] counter-clockwise; empty: the tank is the box
  std::vector<std::vector<Eigen::Vector3d>>
      water_shapes;                     // [m] two corners of a box, or a polygon; empty: the box
  bool submerged = false;               // no water inside a body at the start
  InitialVelocity initial_velocity;     // of the water, in addition to that of the tank
  bool open_top = true;                 // box: no lid; polygon: no wall from its last corner to its first
  std::array<bool, 3> periodic{};       // axes along which the tank repeats itself
  WallSlip wall = WallSlip::free_slip;  // of tank and bodies
  bool absorbing_bottom = false, absorbing_sides = false;  // walls that let sound out
  TankMotion motion;                                       // of the tank
  double end_time = 0;                                     // [s] of the run: how far the tank may move
  std::string interface = "surface";                       // surface | volume
  Scheme scheme;
  AirKeys air;
  std::vector<ProbeKeys> probes;  // those of the fluid
  int threads = 2;
  int ranks = 1;  // processes that compute the water together
  std::string launcher = "mpirun -n {ranks}";

  /// Whether the water starts at rest under a level surface, on the floor and from side to side of the tank.
  /// Its pressure is ρg times the depth then. With a ramp gravity starts at nothing.
  bool starts_level() const {
    const auto reaches = [&](int axis) {
      const double slack = 1e-6 * spacing;
      return water.min[axis] < tank.min[axis] + slack &&
             (axis == 1 || water.max[axis] > tank.max[axis] - slack);
    };
    const bool is_box = water_shapes.empty() || (water_shapes.size() == 1 && water_shapes[0].size() == 2);
    return is_box && initial_velocity.is_zero() && gravity_ramp == 0 && gravity.x() == 0 && gravity.y() < 0 &&
           gravity.z() == 0 && reaches(0) && reaches(1) && (dimension == 2 || reaches(2));
  }
};

}  // namespace strake::fluid
