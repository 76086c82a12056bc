#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coupler/accelerator.hpp"
#include "coupler/mapping.hpp"
#include "coupler/predictor.hpp"
#include "proto/participant.hpp"

namespace strake {

enum class Measure {
  increment,  // relative to the window's displacement increment: a driven body's travel does not hide its
              // deflection
  value       // relative to the displacement itself, and the force must settle as well
};
enum class Unconverged {
  accept,  // keep the window, count it
  halve,   // ask for a smaller window: WindowReport::retry
  stop     // Error(solver_fault)
};

/// residual = rms(hx − x), per point; converged when <= max(absolute, relative · rms(hx − u_n)).
struct Convergence {
  double relative = 1e-4;
  double absolute = 1e-8;  // [m]
  Measure measure = Measure::increment;
  int min_iterations = 1, max_iterations = 20;  // max 1: explicit coupling
  Unconverged then = Unconverged::accept;
};

struct SchemeParameters {
  bool volume = false;  // motion at the start of the window, W = identity, one iteration, no predictor
  Convergence convergence;
  Predictor predictor = Predictor::quadratic;
  AcceleratorParameters accelerator;
};

/// One coupling iteration: a row of iterations.csv.
struct IterationReport {
  int iteration = 0;
  double residual = 0, threshold = 0;               // [m]
  double relaxation = 0;                            // ω of the step to the next iterate, where one was used
  int columns = 0, dropped = 0;                     // of IQN-ILS in that step
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // [N] whole load on the structure
};

struct WindowReport {
  Window window;
  int number = 0;  // of this window, from 1
  int iterations = 0;
  double residual = 0, threshold = 0;  // [m]
  bool converged = false;              // residual <= threshold; volume coupling has nothing to converge: true
  /// A solver, or Unconverged::halve, wants a shorter window: both solvers have been taken back, call
  /// `advance` again with at most `dt_limit`. Everything below is empty then.
  bool retry = false;
  double dt_limit =
      std::numeric_limits<double>::infinity();  // [s] longest next window that both solvers accept
  double work_fluid = 0,
         work_structure = 0;    // [J] f·Δu of the committed increment on each side of the mapping
  double work_unconverged = 0;  // [J] f·(hx − x): what the accepted residual gave to the structure
  double work_gap() const;      // |W_f − W_s| / max(|W_f|, |W_s|); 0 when both are
  Points displacement, velocity,
      force;  // 3×n on the structure's mesh; velocity empty where the structure sends none
  std::map<std::string, double> fluid, structure;  // Advanced::monitor of each
  /// Both monitors in one, without the reserved prefixes (seconds., count., check., memory.).
  std::map<std::string, double> monitor() const;
  std::vector<IterationReport> log;
};

/// All that the coupling remembers from window to window: what coupler.h5 of a checkpoint holds.
struct CouplingState {
  int windows = 0;  // committed
  double velocity_scale =
      0;  // [s] half the first window: velocities stand in the accelerated vector as lengths
  bool sends_velocity = false;  // the structure, with each window
  MotionHistory motion;         // committed, last is now
  Eigen::MatrixXd force;        // 3×n [N] of the last window on the structure's mesh
  AcceleratorState accelerator;

  void save(Archive&) const;  // names begin with "coupling."
  void load(const Archive&);
};

/// Serial coupling of two participants, fluid first: explicit coupling is implicit coupling with one
/// iteration.
///
/// Per window: `advance` leaves both solvers at the end of the window, uncommitted (unless report.retry);
/// then the caller calls `commit`, or `abandon` to give the window up. With remote participants commit and
/// rewind ride on the next message. After an exception the scheme and its participants are only destroyed.
class Scheme {
 public:
  /// The structure's Description::initial gives motion at t = 0; a structure that sends velocity with each
  /// window has it there as well. Throws Error(case_file) when the mapping does not fit the meshes.
  Scheme(Participant& fluid, Participant& structure, Mapping, SchemeParameters, double start_time = 0);

  WindowReport advance(const Window&);
  void commit(bool write_output);
  void abandon();

  const Mapping& mapping() const { return mapping_; }
  const CouplingState& state() const { return state_; }  // committed
  void set_state(CouplingState);                         // resume: after both participants have resumed

 private:
  struct Iterate;
  /// Fluid, then structure; the longest window [s] of a solver that wants a shorter one (both are taken back
  /// then).
  std::optional<double> evaluate(const Window&, int iteration, Iterate&);
  IterationReport measure(const Window&, const Iterate&, const Eigen::MatrixXd& previous_force) const;
  Eigen::VectorXd stack(const Motion&) const;
  Motion next_guess(const Window&, const Iterate&);
  void take_back();
  WindowReport retry(const Window&, double limit) const;
  [[noreturn]] void stop_unconverged(const WindowReport&) const;
  void close(WindowReport&, Iterate&);
  Participant& fluid_;
  Participant& structure_;
  Mapping mapping_;
  SchemeParameters parameters_;
  std::unique_ptr<Accelerator> accelerator_;
  CouplingState state_, pending_;
  bool open_ = false;  // a window is advanced and not yet committed
};

/// The window of a run with one participant (fluid.solver or structure.solver = "none"): no interface, no
/// iteration. The participant is left uncommitted.
WindowReport advance_alone(Participant&, const Window&);

}  // namespace strake
