#pragma once

#include "fluid/simulation/simulation.hpp"
#include "proto/interface.hpp"

#include <vector>

namespace strake::fluid {

/// The motion of the interface points over a window (cases/VALIDATION.md, "Piston and column"). Between two
/// known places x_n and x_{n+1} the points move with constant acceleration:
///   v_{n+1} = 2 (x_{n+1} − x_n)/dt − v_n.
/// Where the partner also sends a velocity, they move on the cubic through both places and velocities. With
/// several samples each stretch is one such curve.
class WindowMotion {
 public:
  /// displacement, velocity: committed ones at window.t, 3×m [m], [m/s]. Throws Error(solver_fault) when a
  /// sample has no displacement, or one of another size.
  WindowMotion(const Window&, const std::vector<Sample>&, const Points& displacement, const Points& velocity);
  /// Returns the motion at the end of a step from t0 to t1 [s]. The acceleration is the mean of the step.
  InterfaceMotion step(double t0, double t1) const;

 private:
  struct Knot {
    double time = 0;
    Points displacement, velocity;
  };
  Knot at(double t) const;
  std::vector<Knot> knots_;
};

}  // namespace strake::fluid
