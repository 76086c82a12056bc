#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "proto/interface.hpp"

namespace strake {

struct AcceleratorParameters {
  std::string kind = "iqn-ils";     // "constant" | "aitken" | "iqn-ils"
  double initial_relaxation = 0.1;  // ω while nothing better is known; of `constant` always
  int reused_windows = 8;           // earlier windows whose columns IQN-ILS keeps
  double filter = 1e-2;  // a column whose new direction is a smaller part of it than this is left out
};

/// All that an accelerator remembers: copied to rewind, saved to resume.
struct AcceleratorState {
  /// Differences between successive iterations of one window, oldest first.
  struct Secants {
    Eigen::MatrixXd residual;  // Δ(H(x) − x)
    Eigen::MatrixXd image;     // ΔH(x)
  };
  int iteration = 0;      // iterations seen in this window
  double relaxation = 0;  // last ω; 0: none yet
  Eigen::VectorXd previous_residual, previous_image;
  std::vector<Secants>
      windows;  // oldest first; the last one belongs to the current window when iteration > 1

  void save(Archive&) const;
  void load(const Archive&);
};

/// What the last call of `next` did.
struct AcceleratorStep {
  double relaxation = 0;         // ω, where one was used
  int columns = 0, dropped = 0;  // IQN-ILS: used, and left out by the filter
};

/// Next iterate of the fixed point x = H(x).
class Accelerator {
 public:
  virtual ~Accelerator() = default;
  /// x, hx: what went in and what came out, any length, the same in all calls. Throws Error(solver_fault)
  /// when either is not finite.
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
  /// Takes note of an iteration; from the second of a window on, state_ holds the previous one.
  virtual void learn(const Eigen::VectorXd& residual, const Eigen::VectorXd& image);
  virtual Eigen::VectorXd iterate(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) = 0;
  AcceleratorState state_;
  AcceleratorStep step_;

 private:
  void observe(const Eigen::VectorXd& x, const Eigen::VectorXd& hx);
};

/// Throws Error(case_file) for an unknown kind.
std::unique_ptr<Accelerator> make_accelerator(const AcceleratorParameters&);

}  // namespace strake
