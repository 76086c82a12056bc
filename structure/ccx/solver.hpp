#pragma once

#include "structure/body/parameters.hpp"
#include "structure/ccx/output.hpp"
#include "structure/ccx/runner.hpp"
#include "structure/deck/deck.hpp"
#include "structure/solver/solver.hpp"

#include <string>
#include <vector>

namespace strake::structure::ccx {

/// CalculiX as a structure, on the mesh of the finite elements: an umpire that nobody here wrote. It has no
/// interface for single steps; how it is called is what `Stepwise` and `WholeHistory` differ in. All here is
/// relative to the supports, which move at a constant velocity V, as in fem/solver.hpp.
class CalculixSolver : public Solver {
 public:
  /// Throws Error(case_file) when CalculiX is not installed or has no such material.
  CalculixSolver(const Parameters&, deck::Model);
  const InterfaceMesh& interface() const final { return interface_; }
  Points displacement() const final;
  Points velocity() const final;
  Eigen::Vector3d displacement_at(const Eigen::Vector3d& X) const final;
  Eigen::Vector3d velocity_at(const Eigen::Vector3d& X) const final;
  Frame frame() const final;
  void solve_static() final;
  std::vector<double> frequencies(int count) final;

 protected:
  /// What the wanted nodes do at the end of a window, and the whole body as it is drawn.
  struct Now {
    double time = 0;                // [s]
    Points displacement, velocity;  // 3×k
    BodyField body;
  };
  virtual const Now& now() const = 0;
  virtual void begin_at(Now) = 0;
  Now at_rest() const;
  std::string headline() const;
  deck::Story story() const;
  std::string at_time(double t) const;  // "t = 0.0042 s"
  /// The load of a window. It is the fluid's mean force on the interface points, 3×k [N], plus the case's own
  /// load at mid-window. Throws Error(solver_fault) if it is not finite.
  deck::WindowLoad load_of(const Window&, const Points& force) const;

  Parameters parameters_;
  deck::Model model_;
  deck::Wanted wanted_;
  double thickness_;  // [m] of the model, 1 where forces are per metre of it or in space
  Runner runner_;

 private:
  Points at_points(const deck::Weights& weights, const Points& values) const;
  Eigen::Vector3d at_probe(const Eigen::Vector3d& X, const Points& values) const;

  std::string version_;
  InterfaceMesh interface_;
  std::vector<Eigen::Index> column_;  // n: of a node in the wanted ones, or -1
  std::vector<int> corner_;           // nodes that are drawn
  Eigen::MatrixXi drawn_cell_;        // 4 or 8 × m, into corner_
};

}  // namespace strake::structure::ccx
