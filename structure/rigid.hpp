#pragma once

#include "structure/parameters.hpp"
#include "structure/solver.hpp"

namespace strake::structure {

/// A body that moves with its prescribed velocity and does not deform: x = X + V t. The simplest partner of a
/// fluid.
class Rigid final : public Solver {
 public:
  explicit Rigid(const Parameters&);
  const InterfaceMesh& interface() const override { return mesh_; }
  void advance(double t, double dt, const Load&) override;
  Points displacement() const override;
  Points velocity() const override;
  bool sends_velocity() const override { return true; }
  double stable_dt() const override { return std::numeric_limits<double>::infinity(); }
  Energy energy() const override;
  int steps() const override { return state_.steps; }
  Eigen::Vector3d displacement_at(const Eigen::Vector3d&) const override { return velocity_ * state_.time; }
  Eigen::Vector3d velocity_at(const Eigen::Vector3d&) const override { return velocity_; }
  void save() override { saved_ = state_; }
  void restore() override { state_ = saved_; }
  void write(Archive&) const override;
  void read(const Archive&) override;
  Frame frame() const override;
  std::vector<std::string> lines() const override;

 private:
  struct State {
    double time = 0;  // [s]
    int steps = 0;
  };
  Eigen::Vector3d velocity_;  // [m/s]
  double mass_;               // [kg] per metre of depth
  InterfaceMesh mesh_;
  State state_, saved_;
};

/// The outline with its displacement and velocity, as segments: what solvers without an inside show.
Frame outline_frame(double time, const InterfaceMesh&, const Points& displacement, const Points& velocity);

}  // namespace strake::structure
