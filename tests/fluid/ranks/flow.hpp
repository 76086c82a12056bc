#pragma once

#include "fluid/simulation/simulation.hpp"

namespace strake::fluid {

/// A driven body, or none, and its water. All steps are windows of their own, but for `substeps`.
template <int dim>
struct Flow {
  Parameters p;
  InterfaceMesh body;
  double speed = 0;  // downwards [m/s]
  double dt = 1e-4;
  int steps = 60, substeps = 1;

  Points velocity() const {
    Points v = Points::Zero(3, body.position.cols());
    v.row(1).setConstant(-speed);
    return v;
  }
  /// Makes step k.
  StepReport step(Simulation<dim>& simulation, int k) const {
    const auto m = simulation.interface().position.cols();
    InterfaceMotion motion{Points::Zero(3, m), Points::Zero(3, m), Points::Zero(3, m)};
    motion.velocity.row(1).setConstant(-speed);
    motion.displacement.row(1).setConstant(-speed * (k + 1) * dt);
    return simulation.step(dt, motion, (substeps - 1 - k % substeps) * dt);
  }
  /// Makes all steps; returns the report of the last one.
  StepReport run(Simulation<dim>& simulation) const {
    StepReport report;
    for (int k = 0; k < steps; ++k) report = step(simulation, k);
    return report;
  }
};

}  // namespace strake::fluid
