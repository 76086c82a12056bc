#pragma once

#include "coupler/attachments/fmu/fmi3_functions.hpp"
#include "coupler/attachments/fmu/model_description.hpp"

#include <deque>
#include <set>
#include <string>
#include <vector>

namespace strake {

/// The FMU refused values or a step (fmi3Discard), but is as it was before: a shorter window may succeed.
struct FmuDiscarded {
  std::string why;
};

/// The last messages of an FMU. It gets them by the callback logMessage.
class FmuLog {
 public:
  void add(fmi3Status, fmi3String category, fmi3String message) noexcept;
  std::string lines() const;  // each begins with a line break; empty without messages
  std::string last() const;
  void clear() { lines_.clear(); }

 private:
  std::deque<std::string> lines_;
};

/// A loaded FMU and one instance of its model, in the states of FMI 3.0's co-simulation: instantiated, in
/// initialization mode, in step mode. No event mode, no early return. Status by status:
///   Warning  one line in the log for each function
///   Discard  throws FmuDiscarded in step mode, from `set`, `get` and `step`; else as Error
///   Error    throws Error(solver_fault) with the FMU's own last messages
///   Fatal    the same, and nothing is called any more
class FmuInstance {
 public:
  /// Error(case_file) for a library that cannot be loaded or lacks a function; Error(solver_fault) where the
  /// model is not instantiated.
  FmuInstance(const ModelDescription&, const FmuPackage&, std::string name);
  ~FmuInstance();
  FmuInstance(const FmuInstance&) = delete;
  FmuInstance& operator=(const FmuInstance&) = delete;

  /// Sets a scalar of the types that `takes_number` names. Before `enter_initialization`.
  void set_parameter(const FmuVariable&, double value);
  void enter_initialization(double start_time);
  void exit_initialization();

  void set(const std::vector<fmi3ValueReference>&, const std::vector<double>&);
  /// FMI 3.0 allows it in step mode after `step`, and not again after `set`.
  std::vector<double> get(const std::vector<fmi3ValueReference>&);
  void step(double t, double dt);

  /// Keeps the present state, in place of the one kept before; goes back to it.
  void keep_state();
  void restore_state();
  /// The kept state as bytes; the present and the kept state from them.
  std::vector<fmi3Byte> serialized();
  void deserialize(const std::vector<fmi3Byte>&);

 private:
  enum class Health { usable, failed, lost };  // all may be called; what frees memory alone; nothing
  enum class OnDiscard { fail, retry };
  void load(const ModelDescription&, const FmuPackage&);
  void check(fmi3Status, const char* function, OnDiscard = OnDiscard::fail);
  [[noreturn]] void fail(const std::string& problem);

  std::string name_;
  FmuLog log_;
  Fmi3Functions f_;
  void* library_ = nullptr;
  fmi3Instance instance_ = nullptr;
  fmi3FMUState kept_ = nullptr;
  Health health_ = Health::usable;
  bool in_step_mode_ = false;
  double time_ = 0;               // [s] for messages
  std::set<std::string> warned_;  // functions that gave a warning
};

/// Whether `set_parameter` knows the type.
bool takes_number(const std::string& type);

}  // namespace strake
