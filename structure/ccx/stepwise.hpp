#pragma once

#include "structure/ccx/solver.hpp"

#include <memory>
#include <string>

namespace strake::structure::ccx {

/// One call of CalculiX per window, whatever the load will be: each goes on from the restart file that the
/// last committed window left (*RESTART), under the window's mean force. That file is part of the state, so
/// going back and checkpoints are exact. A call costs a start of the program, its reading and writing of the
/// file, and two factorisations.
class Stepwise final : public CalculixSolver {
 public:
  Stepwise(const Parameters&, deck::Model);
  void advance(double t, double dt, const Load&) override;
  /// As an observer at rest sees it.
  Energy energy() const override;
  int steps() const override { return state_.steps; }
  void save() override { saved_ = state_; }
  void restore() override { state_ = saved_; }
  void write(Archive&) const override;
  void read(const Archive&) override;
  std::vector<std::string> lines() const override;

 private:
  struct State {
    Now now;
    std::shared_ptr<const std::string> restart;    // CalculiX's file; none at the start
    double strain = 0, kinetic = 0, external = 0;  // [J], kinetic relative to the supports
    /// CalculiX adds up the strain energies of all steps' ends: the difference of two is the last one's.
    double printed_strain = 0;  // [J] of the model, as thick as it is
    int steps = 0;
  };
  const Now& now() const override { return state_.now; }
  void begin_at(Now) override;
  Eigen::Vector3d momentum(const Now&) const;  // [kg m/s] relative to the supports

  State state_, saved_;
};

}  // namespace strake::structure::ccx
