#pragma once

#include "structure/body/mass.hpp"
#include "structure/body/parameters.hpp"

#include <Eigen/Geometry>

namespace strake::structure {

/// Where a rigid body is and how it moves. Its frame turns about the point C, the centre of gravity unless a
/// pivot is given: x(X) = C + d + R (X − C).
struct RigidState {
  double time = 0;                                           // [s]
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();    // d [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();        // of C [m/s]
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  // R
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();            // angular velocity in body axes [rad/s]
  double angle = 0;                                          // [rad] about z, whole turns counted
  double work = 0;                                           // [J] done on the body so far
};

/// Forces on a body's points, constant over a window. Stored are their sum and Σ r⊗f with r = X − C in the
/// reference configuration, which gives the moment in every orientation.
struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // [N]
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();  // [N m]
  void add(const Eigen::Vector3d& r, const Eigen::Vector3d& f) {
    force += f;
    moment += r * f.transpose();
  }
};
/// Σ (R r)×f of a wrench: the moment in world axes, for R a rotation or the mean of two.
Eigen::Vector3d moment_of(const Wrench&, const Eigen::Matrix3d& R);

/// The equations of motion of a rigid body some of whose motions are prescribed.
///
/// Trapezoidal rule with the window's mean force f (cases/VALIDATION.md, "Piston and column"):
///   m (v' − v) = f Δt, d' = d + ½ (v + v') Δt.
/// Rotation by the rule of Simo & Wong with Cayley's map: with the body's angular velocity Ω,
///   R' = R cay(w), w = ½ (Ω + Ω') Δt,    R'JΩ' − RJΩ = Δt Σ ½(R + R') r × f
/// so that angular momentum changes by exactly the loads' impulse, and, since R'r − Rr = w × ½(R + R')r with
/// w in world axes, the kinetic energy by exactly the loads' work Σ f·(x' − x).
class RigidBody {
 public:
  explicit RigidBody(const Parameters&);

  RigidState start() const;
  /// Gravity is added to the loads here. Throws Error(solver_fault) when it turns too far in one window.
  RigidState advance(const RigidState&, double dt, const Wrench& loads) const;
  double kinetic_energy(const RigidState&) const;  // [J]

  const MassProperties& mass() const { return mass_; }
  const Eigen::Vector3d& centre() const { return centre_; }  // C [m]
  bool is_free() const { return free_.any(); }

 private:
  void prescribe(RigidState&, double time) const;
  void turn(const RigidState& from, RigidState& to, double dt, const Wrench& loads) const;
  bool turns_freely() const { return free_.angle || free_.rotation; }
  Eigen::Vector3d velocity_of_gravity_centre(const RigidState&) const;

  MassProperties mass_;
  FreeMotion free_;
  Eigen::Vector3d centre_, arm_;  // C, and from C to the centre of gravity [m]
  Eigen::Matrix3d inertia_;       // about C [kg m²]
  Eigen::Vector3d velocity_, gravity_;
  double gravity_ramp_, angular_velocity_;
  std::optional<MotionTable> motion_;
};

}  // namespace strake::structure
