#pragma once

#include "coupler/coupling/scheme.hpp"

/// What the files of Scheme share, for scheme.cpp and scheme_evaluate.cpp alone.
namespace strake {

/// One evaluation of H. All but `wet`, the fluid's points, is on the structure's mesh.
struct Scheme::Iterate {
  StructureSample guess, answer;  // x, which the fluid is given (see guess_of), and H(x), the structure's
  std::vector<Field> load_guess;  // parallel: what the structure is given
  std::vector<Field> load;  // what the fluid answers; serial: what the structure is given, but for `attached`
  std::vector<Field> load_before;      // of the iteration before, in the first one of the window before
  Values attached, attached_before;    // what attachments add to the load; 3×0 without any
  Samples history, history_before;     // the load over the window, if the structure takes it; likewise
  StructureSamples structure_history;  // the structure's last answers over it, if the fluid takes them
  std::vector<Field> wet;              // the fluid's answer on its own mesh
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // [N] whole load on the structure
  Advanced from_fluid, from_structure;
};

/// Adds the force of attachments, 3×n or 3×0, to the force among the fields.
void add_attached(std::vector<Field>&, const Values& attached);

/// v_(n+1) = 2 (u_(n+1) − u_n)/dt − v_n, the end velocity of an interface that moves with constant
/// acceleration (cases/VALIDATION.md, "Piston and column"). From the structure's committed motion, so that
/// what one window leaves unconverged does not add up in the next.
Eigen::MatrixXd followed_velocity(const Motion& committed, const Values& displacement, double dt);

}  // namespace strake
