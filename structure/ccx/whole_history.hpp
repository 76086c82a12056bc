#pragma once

#include "coupler/participant/interface_record.hpp"
#include "structure/ccx/solver.hpp"

#include <string>
#include <vector>

namespace strake::structure::ccx {

/// One call of CalculiX for a whole run: before the first window it computes all of a load that is known,
/// which windows then look up. The load that comes must be that one.
class WholeHistory final : public CalculixSolver {
 public:
  /// The forces of a record on the case's own interface points, or, of the case's own load alone, none.
  WholeHistory(const Parameters&, deck::Model, const InterfaceRecord&);
  void advance(double t, double dt, const Load&) override;
  /// In the frame of the supports; nothing is known of the load's work inside a window.
  Energy energy() const override;
  bool follows_work() const override { return false; }
  int steps() const override { return state_.steps; }
  void save() override { saved_ = state_; }
  void restore() override { state_ = saved_; }
  void write(Archive&) const override;
  void read(const Archive&) override;
  std::vector<std::string> lines() const override;

 private:
  struct State {
    Now now;
    double strain = 0, kinetic = 0;  // [J] relative to the supports
    int steps = 0;
  };
  const Now& now() const override { return state_.now; }
  void begin_at(Now) override;
  void require_known(double t, double dt, const Load&) const;
  void compute();
  void go_to(double time);

  std::vector<Window> windows_;
  std::vector<Points> force_;      // 3×points [N] mean over each
  double largest_ = 0;             // [N]
  std::vector<Printed> computed_;  // at the start and the end of each window; empty: not yet
  std::vector<BodyField> drawn_;   // the start and every wanted_.field_every-th
  State state_, saved_;
};

/// Windows of a case without a fluid, and no force in them.
InterfaceRecord no_load(const Parameters&);

}  // namespace strake::structure::ccx
