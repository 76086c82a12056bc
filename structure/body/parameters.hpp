#pragma once

#include "proto/case/case_keys.hpp"
#include "proto/motion.hpp"
#include "structure/body/closed_surface.hpp"
#include "structure/body/shape.hpp"
#include "structure/body/solid.hpp"
#include "structure/material/material.hpp"

#include <Eigen/Core>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace strake::structure {

enum class Analysis { dynamic, statics, modal };  // case file: dynamic | static | modal
enum class LoadKind { none, traction, point };

/// Rectangle in the xy-plane (2-D, plane strain): the short form of one box.
struct Plate {
  double length = 0, thickness = 0;                  // [m] along x, along y
  Eigen::Vector3d bottom = Eigen::Vector3d::Zero();  // [m] middle of the lower face
  double angle = 0;                                  // [deg] about `bottom`, counter-clockwise
  double hollow = 0;                                 // [m] of the lower face's ends under its middle
  Support left = Support::free, right = Support::free;
};

/// Load of the case itself, beside the fluid's: [structure.load].
struct CaseLoad {
  LoadKind kind = LoadKind::none;
  Eigen::Vector3d value = Eigen::Vector3d::Zero();  // traction [Pa] on `face`, or point force [N/m]
  std::string face = "top";                         // top | bottom | left | right
  Eigen::Vector3d at = Eigen::Vector3d::Zero();     // [m] point force
  double ramp = 0;                                  // [s] value · ½(1 − cos(πt/ramp)); 0: at once
};

/// Strains of a finite element: of its displacement alone, with others beside them that cure locking, or
/// those of a plate that is one cell thick.
enum class StrainField { automatic, compatible, enhanced, solid_shell };
/// Factors (CHOLMOD, UMFPACK), or conjugate gradients with algebraic multigrid (Trilinos ML).
enum class LinearMethod { automatic, direct, cg_amg };
struct FemKeys {
  int degree = 2;
  int refinement = 3;    // cells through the thickness = 2^refinement; along the length graded to the clamps
  double cell_size = 0;  // [m] along parts made of boxes; 0: by the thickness
  double rho_infinity = 1;   // spectral radius of generalised-alpha; 1: Newmark, trapezoidal
  double tolerance = 1e-10;  // Newton, relative
  StrainField strain = StrainField::automatic;
  LinearMethod linear_solver = LinearMethod::automatic;
};
enum class ParticleModel { pair, total_lagrangian };
/// Where a clamped end's first fixed column of particles stands (structure/THEORY.md, section 5.3).
enum class ClampColumn { inside, outside };
/// How a particle of the pair model turns: with its neighbourhood (R1), or as an unknown of its own (R2).
enum class Rotation { kinematic, dynamic };
struct ParticleKeys {
  double spacing = 0.005;  // [m] surface coupling; volume coupling uses fluid.spacing
  ParticleModel model = ParticleModel::total_lagrangian;  // in volume coupling the default is pair
  Rotation rotation = Rotation::kinematic;                // pair model
  double radius = 2.1;                                    // [spacing]
  double hourglass = 1.0;                                 // alpha of structure/THEORY.md (S21)
  ClampColumn clamp =
      ClampColumn::inside;  // pair model: outside, as in structure/THEORY.md, sections 5.2 and 5.3
  double safety = 0.8;      // sub-step = safety × elastic limit
};
/// What breaks a body (structure/THEORY.md, section 6): [structure.failure].
enum class FailureCriterion { none, bond_strain, max_principal, von_mises };
struct FailureKeys {
  FailureCriterion criterion = FailureCriterion::none;
  double fracture_energy = 0;  // [J/m²] G_c
  double strength = 0;         // [Pa] f_t
  double critical_strain = 0;  // bond_strain; 0: from the fracture energy
};
struct Damping {
  double mass = 0;       // [1/s] Rayleigh, mass-proportional
  double stiffness = 0;  // [s]   Rayleigh, stiffness-proportional
};

/// Mass properties that replace those of the homogeneous body. A rigid body uses all of them, an elastic body
/// only the lumped mass. In two dimensions per metre of depth.
struct BodyMass {
  double mass = 0;                              // [kg] 0: density times volume
  double inertia = 0;                           // [kg m²] about z through the centre; 0: of the shape
  std::optional<Eigen::Vector3d> inertia_axes;  // [kg m²] about x, y and z, three dimensions
  std::optional<Eigen::Vector3d> centre;        // [m] of gravity; otherwise of the shape
  double lumped_mass = 0;  // [kg] in one point, added to all that; of an elastic body: of
                           // the frame that its supports stand in
  Eigen::Vector3d lumped_at = Eigen::Vector3d::Zero();  // [m]
};

/// The motions that follow from the loads: of a rigid body, or of the frame of an elastic body's supports.
/// All other motions are prescribed.
struct FreeMotion {
  bool x = false, y = false, z = false;
  bool angle = false;     // about z
  bool rotation = false;  // about all axes, three dimensions
  bool any() const { return x || y || z || angle || rotation; }
  bool translates() const { return x || y || z; }
};

/// Velocity relative to the supports at t = 0 of all that is not constrained. It is the sum of the terms of
/// [structure.initial_velocity].
struct InitialVelocity {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();  // [m/s]
  std::vector<Eigen::Vector3d> of_part;             // [m/s] of each part of the solid; empty: none
  /// Velocity [m/s] over a coordinate [m]. It uses a motion table whose time is the coordinate and whose
  /// places are the velocities, with the same spline.
  std::optional<MotionTable> profile;
  Eigen::Index along = 0;  // axis of that coordinate
};

/// When CalculiX is called. `window`: for each window, from its restart file. `once`: for a whole run whose
/// load is known beforehand.
enum class CalculixCalls { automatic, window, once };
struct CalculixKeys {
  CalculixCalls calls = CalculixCalls::automatic;
  double answer_within = 600;  // [s] of wall clock for an increment
};

/// Everything a structure solver needs, without the case file.
struct Parameters {
  int dimension = 2;
  int ranks = 1;  // processes that compute the body together
  std::string launcher = "mpirun -n {ranks}";
  std::string kind = "fem";           // the running program: fem | particle | ccx | rigid | replay
  std::string interface = "surface";  // surface | volume
  double fluid_density = 1000;        // [kg/m^3] for the contact pressure ½ρV²
  double fluid_spacing = 0.01;        // [m]
  double surface_spacing = 0.01;      // [m] of the interface points; default fluid.spacing
  Eigen::Vector3d velocity =
      Eigen::Vector3d::Zero();  // [m/s] of the supports, and of the whole body at t = 0
  Eigen::Vector3d gravity =
      Eigen::Vector3d::Zero();  // [m/s^2] body force; from fluid.gravity, with fluid.gravity_ramp
  double gravity_ramp = 0;      // [s]
  Shape shape;                  // plate: `plate` below
  Plate plate;
  std::vector<std::string> loaded_faces;  // by name, that the water loads; empty: all
  bool loaded_by_old_key = false;         // structure.wet named them
  Solid solid;                   // of elastic bodies whatever their shape, and of a rigid one made of boxes
  ClosedSurface closed_surface;  // of a rigid body from an STL file, ShapeKind::surface
  Material material;             // of parts that have none of their own
  BodyMass body;
  FreeMotion free;
  InitialVelocity initial;
  double angular_velocity = 0;           // [rad/s] about z; of a free body at t = 0
  std::optional<Eigen::Vector3d> pivot;  // [m] about which it turns; otherwise the centre of gravity
  std::optional<MotionTable> motion;     // structure.motion.file
  CaseLoad load;
  Analysis analysis = Analysis::dynamic;
  Damping damping;
  FemKeys fem;
  ParticleKeys particle;
  FailureKeys failure;
  bool stays_intact = false;  // the case has a criterion that this kind of structure does not offer
  CalculixKeys ccx;
  std::filesystem::path replay_run;                   // structure.replay.run
  std::filesystem::path load_run;                     // fluid.replay.run: whose recorded load comes
  bool fluid_none = false;                            // fluid.solver = "none"
  double end_time = 0, window = 0, output_every = 0;  // [s]
  std::vector<ProbeKeys> probes;
  std::filesystem::path run_folder;  // of the run; empty: nothing stays
  std::string body_name;             // of several in one water, its name; empty: one structure
  int threads = 2;
};

/// The body of the elastic solvers: `solid`, or the plate where there is none.
Solid elastic_solid(const Parameters&);

}  // namespace strake::structure
