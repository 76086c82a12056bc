#pragma once

#include "coupler/acceleration/accelerator.hpp"
#include "coupler/coupling/attachments.hpp"
#include "coupler/coupling/convergence.hpp"
#include "coupler/coupling/exchange.hpp"
#include "coupler/coupling/window_report.hpp"
#include "proto/interface.hpp"
#include "proto/participant.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// First guess of what a side will send at a window's end, from what was committed.
enum class Predictor { constant, linear, quadratic };  // by the polynomial's degree
/// "constant" | "linear" | "quadratic"; throws Error(case_file) otherwise.
Predictor predictor_kind(const std::string&);

/// Fields of a side at the ends of the last committed windows, oldest first. There are at most as many
/// samples as the predictor uses; more would only displace other data from the processor's cache. Each has
/// the same fields.
using Samples = std::vector<Sample>;
void remember(Samples&, Sample, Predictor);
void remember(StructureSamples&, StructureSample, Predictor);
/// The fields at `time`: each by the polynomial of the predictor's degree through the last samples; while
/// there are too few, by the highest degree they allow. The velocity of a motion goes with its displacement:
/// from one sample u + v (t − t_n), and always the end velocity of a motion with constant acceleration.
Sample predict(Predictor, const Samples&, double time);
StructureSample predict(Predictor, const StructureSamples&, double time);

struct SchemeParameters {
  bool volume = false;    // motion at the start of the window, W = identity, one iteration, no predictor
  bool parallel = false;  // both sides at once, each with the other's last answer; not with `volume`
  Convergence convergence;
  Predictor predictor = Predictor::quadratic;
  AcceleratorParameters accelerator;
};

/// All that the coupling keeps from window to window: the content of coupler.h5 in a checkpoint.
struct CouplingState {
  int windows = 0;  // committed
  double velocity_scale =
      0;  // [s] half the first window: velocities stand in the accelerated vector as lengths
  bool sends_velocity = false;  // the structure, with each window
  StructureSamples structure;   // what it sent at the ends of committed windows, last is now
  Samples fluid;    // likewise the fluid's, on the structure's mesh; none where no window looks back
  Samples history;  // the last three of the fluid's samples before now, where the structure takes histories
  StructureSamples structure_history;  // the structure's, where the fluid takes histories
  AcceleratorState accelerator;

  void save(Archive&) const;  // names begin with "coupling."
  void load(const Archive&);
};

/// Coupling of two participants. Serial: the fluid first, then the structure with the load that it gave.
/// Parallel: both at once (Jacobi). Explicit coupling is implicit coupling with one iteration.
///
/// Per window: `advance` leaves both solvers at the end of the window, uncommitted (unless report.retry);
/// then the caller calls `commit`. With remote participants commit and rewind ride on the next message. After
/// an exception the scheme and its participants are only destroyed.
class Scheme {
 public:
  /// The exchanged fields follow from the Description::initial of both (fields_of_structure,
  /// fields_of_fluid). A structure that sends velocity with each window has it there as well. Throws
  /// Error(case_file) when the mapping does not fit the meshes, or the mapping back is missing.
  /// attachments: to the structure's points.
  Scheme(Participant& fluid, Participant& structure, FieldTransfer, SchemeParameters, double start_time = 0,
         std::vector<Attachment> attachments = {});

  WindowReport advance(const Window&);
  void commit(bool write_output);

  const Mapping& mapping() const { return transfer_.to_fluid(); }
  const FieldTransfer& transfer() const { return transfer_; }
  /// What is measured in each iteration, as IterationReport::fields has it: quantity and unit.
  std::vector<Column> measured() const;
  /// True if displacement and force cross the interface: WindowReport then has them by name.
  bool is_mechanical() const;
  const CouplingState& state() const { return state_; }  // committed
  void set_state(CouplingState);                         // resume: after both participants have resumed

 private:
  struct Iterate;
  /// A solver that wants a shorter window: both are taken back then.
  struct Shorter {
    std::string who;
    double limit;  // [s]
    std::string why, fix;
    Shorter(std::string name, const Advanced& answer)
        : who(std::move(name)), limit(answer.dt_limit), why(answer.why), fix(answer.fix) {}
  };
  std::optional<Shorter> evaluate(const Window&, int iteration, Iterate&);
  std::optional<Shorter> evaluate_serial(const Window&, int iteration, Iterate&);
  std::optional<Shorter> evaluate_parallel(const Window&, int iteration, Iterate&);
  std::optional<Shorter> ask_prescribed(const Window&, Iterate&);
  Input for_fluid(const Window&, const Iterate&) const;
  Input for_structure(const Window&, const Iterate&) const;
  Samples receive_history(const Window&, int iteration, Iterate&) const;
  bool fluid_takes_history() const;
  StructureSamples moved_history(const Window&, const Iterate&) const;
  StructureSamples receive_structure_history(const Window&, int iteration, Iterate&) const;
  static void sum_load(Iterate&);
  void receive_fluid(const Window&, int iteration, Iterate&) const;
  void receive_structure(const Window&, int iteration, Iterate&);
  Iterate first_guess(const Window&) const;
  bool holds_last() const;
  const StructureSample& guess_of(const Iterate&) const;  // x
  Limits limits_of_load() const;
  /// True if a window uses the load of the one before; only then it is kept.
  bool needs_last_load() const;
  IterationReport measure(const Window&, int iteration, const Iterate&, const IterationReport* first) const;
  std::vector<AcceleratorBlock> blocks(const StructureSample&, const std::vector<Field>& load) const;
  void tell_blocks(const StructureSample&, const std::vector<Field>& load);
  Eigen::VectorXd stack(const StructureSample&, const std::vector<Field>& load) const;
  void next_guess(const Window&, Iterate&);
  void start_attachments(const Window&, Iterate&);
  std::optional<Shorter> finish_attachments(const Window&, int iteration, Iterate&);
  void rewind_all();
  WindowReport retry(const Window&, double limit, std::string why, std::string fix) const;
  [[noreturn]] void stop_unconverged(const WindowReport&) const;
  void close(WindowReport&, Iterate&);
  Participant& fluid_;
  Participant& structure_;
  Attachments attachments_;
  FieldTransfer transfer_;
  SchemeParameters parameters_;
  StructureSample of_structure_;        // announced
  std::vector<Field> of_fluid_;         // announced
  std::optional<Sample> initial_load_;  // for a structure that asks for it in its first window
  std::unique_ptr<Accelerator> accelerator_;
  CouplingState state_;
  /// What a commit adds to the state.
  struct Pending {
    double velocity_scale = 0;
    bool sends_velocity = false;
    StructureSample structure;
    Sample fluid;
    Samples history;
    StructureSamples structure_history;
    AcceleratorState accelerator;
  };
  Pending pending_;
  bool open_ = false;  // a window is advanced and not yet committed
};

/// The window of a run with one participant (fluid.solver or structure.solver = "none"): no interface, no
/// iteration. The participant is left uncommitted.
WindowReport advance_alone(Participant&, const Window&);

}  // namespace strake
