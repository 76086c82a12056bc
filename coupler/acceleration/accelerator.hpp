#pragma once

#include "coupler/acceleration/secants.hpp"
#include "coupler/acceleration/shared_columns.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <memory>
#include <string>
#include <vector>

namespace strake {

struct AcceleratorParameters {
  std::string kind = "iqn-ils";     // "constant" | "aitken" | "iqn-ils" | "iqn-imvj"
  double initial_relaxation = 0.1;  // ω while nothing better is known; of `constant` always
  int reused_windows = 8;           // earlier windows whose columns IQN-ILS keeps
  double filter = 1e-2;             // columns that bring less than this that is new are left out
  std::string filter_kind = "QR2";  // less beside the column itself; "QR1": beside all the others
  int max_columns = 50;             // two vectors each: what bounds the memory
};

/// All that an accelerator remembers: copied to rewind, saved to resume.
struct AcceleratorState {
  int iteration = 0;      // iterations seen in this window
  double relaxation = 0;  // last ω; 0: none yet
  Eigen::VectorXd previous_residual, previous_image;
  Secants secants;               // of IQN-ILS and IQN-IMVJ
  Eigen::VectorXd residual_sum;  // Σ_k |r_b^k| of each block in this window
  LowRank jacobian;              // of IQN-IMVJ, of the windows before this one
  // Of IQN-ILS.
  int careful = 0;                           // windows from this one on whose columns may mislead
  double steepest = 0, steepest_before = 0;  // max |Δr|/|Δx| of this window and of the one before
  double first = 0, unexplained = 0;         // of this window: |r_1|; |r + ΔR α| / |r| of the last step

  void save(Archive&) const;
  void load(const Archive&);
};

/// One field of the accelerated vector where several stand one below the other, as in parallel coupling.
struct AcceleratorBlock {
  std::string name;       // "displacement", "force", "pressure", …: for messages
  Eigen::Index size = 0;  // values
};

/// What the last call of `next` did.
struct AcceleratorStep {
  double relaxation = 0;         // ω, where one was used
  int columns = 0, dropped = 0;  // quasi-Newton: used, and left out by the filter
};

/// Next iterate of the fixed point x = H(x).
class Accelerator {
 public:
  virtual ~Accelerator() = default;
  /// Sets the fields of the vector in their order, before the first call of `next`. Without it the vector is
  /// one interface motion. Fields of different units have equal weight in the least-squares problem.
  void set_blocks(std::vector<AcceleratorBlock>);
  /// x: input of the coupled map, hx: its output, of any length, the same in all calls. Throws
  /// Error(solver_fault) when either is not finite.
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& hx);
  /// The last iteration of a window, after which no next iterate is wanted: its secant serves the windows to
  /// come.
  void finish_window(const Eigen::VectorXd& x, const Eigen::VectorXd& hx);
  /// Keep what is reusable, drop the rest.
  virtual void start_window();
  const AcceleratorStep& last_step() const { return step_; }
  const AcceleratorState& state() const { return state_; }
  void set_state(AcceleratorState state) { state_ = std::move(state); }

 protected:
  /// Records an iteration; from the second of a window on, state_ has the previous one.
  virtual void learn(const Eigen::VectorXd& residual, const Eigen::VectorXd& image);
  virtual Eigen::VectorXd iterate(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) = 0;
  AcceleratorState state_;
  AcceleratorStep step_;
  std::vector<AcceleratorBlock> blocks_;

 private:
  void observe(const Eigen::VectorXd& x, const Eigen::VectorXd& hx);
};

/// Throws Error(case_file) for an unknown kind.
std::unique_ptr<Accelerator> make_accelerator(const AcceleratorParameters&);

}  // namespace strake
