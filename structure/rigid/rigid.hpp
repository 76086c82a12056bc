#pragma once

#include "structure/body/parameters.hpp"
#include "structure/rigid/rigid_body.hpp"
#include "structure/solver/solver.hpp"

namespace strake::structure {

/// A body that does not deform: driven with constant speed, by a table, or left to its loads (RigidBody). Its
/// interface points follow it exactly, u = d + (R − 1)(X − C). Driven at constant speed it is the simplest
/// partner of a fluid.
class Rigid final : public Solver {
 public:
  explicit Rigid(const Parameters&);
  const InterfaceMesh& interface() const override { return mesh_; }
  void advance(double t, double dt, const Load&) override;
  Points displacement() const override;
  Points velocity() const override;
  Energy energy() const override;
  int steps() const override { return state_.steps; }
  Eigen::Vector3d displacement_at(const Eigen::Vector3d&) const override;
  Eigen::Vector3d velocity_at(const Eigen::Vector3d&) const override;
  /// Of a body that a table drives or that turns at a constant rate, and that no load moves: its own
  /// displacement, so that its deflection is 0.
  std::optional<Eigen::Vector3d> support_displacement(const Eigen::Vector3d&) const override;
  bool prescribed() const override { return is_driven(); }
  void save() override { saved_ = state_; }
  void restore() override { state_ = saved_; }
  void write(Archive&) const override;
  void read(const Archive&) override;
  Frame frame() const override;
  std::vector<std::string> lines() const override;
  Properties properties() override;
  std::vector<Column> columns() const override;
  std::map<std::string, double> monitor() const override;

 private:
  /// By a table, or turning at a constant rate, and in no direction free.
  bool is_driven() const;
  /// Centre of gravity: place, turn, their rates; the fluid's load, the window's mean, moment about it.
  std::vector<std::pair<Column, double>> report() const;
  struct State {
    RigidState body;
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();  // [N], [N m]
    int steps = 0;
  };
  Parameters parameters_;
  RigidBody body_;
  InterfaceMesh mesh_;
  Points arm_;         // 3×n [m] from C to the interface points, reference
  Points case_force_;  // 3×n [N] of [structure.load] at full value
  State state_, saved_;
};

/// The surface with its displacement and velocity: what solvers without an inside show.
Frame outline_frame(double time, const InterfaceMesh&, const Points& displacement, const Points& velocity);

}  // namespace strake::structure
