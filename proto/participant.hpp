#pragma once

#include "proto/interface.hpp"

#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace strake {

/// Data that a participant gets once, before its mesh exists.
struct Setup {
  std::filesystem::path run_folder;    // where frames, checkpoints and logs go; empty: write nothing
  std::string interface;               // "surface" | "volume" | "none"
  InterfaceMesh partner_mesh;          // the structure's mesh, for the fluid; empty for the structure
  std::vector<Field> partner_initial;  // displacement and velocity at t = 0 on partner_mesh, for the fluid
  bool history = false;                // the structure takes a load with its history: send Advanced::history
};

/// Data that a participant returns once it is built.
struct Description {
  /// The fields that the participant sends with each window, with their values at t = 0 on mesh(). A field
  /// says its quantity, unit, components, and whether it is conservative. None: displacement [m] of a
  /// structure, force [N] of a fluid. Beside a displacement stands the velocity [m/s] at t = 0, which need
  /// not be sent later.
  std::vector<Field> initial;
  /// The mesh on which it sends a field, and on which it takes one, by quantity: of a participant that has
  /// joined several (InterfaceMesh::meshes). A field that it sends is zero on its other meshes. What it does
  /// not name it does not take.
  std::map<std::string, std::string> sent_on, taken_on;
  bool history =
      false;  // it takes the partner's fields over the window, as several samples, where there are such
  /// Of a structure, which is set up before its partner: the samples of its first window begin with the
  /// fields that the partner announces, at the time at which that window begins.
  bool partner_initial = false;
  /// Of a structure: its motion over a window does not depend on the load. A serial scheme asks it first, and
  /// gives the fluid that motion instead of an extrapolated one.
  bool prescribed = false;
  bool cannot_resume = false;  // it cannot save its state: no checkpoint of the run is written
  double dt_limit = std::numeric_limits<double>::infinity();  // [s] longest first window
  std::vector<Column> columns;  // monitors that become columns of history.csv, in this order
  std::vector<std::string>
      lines;  // what it understood, for the console and `check`; first line is the headline
};

struct Advanced {
  std::vector<Field> output;  // displacement, velocity: at t + dt; force: mean over the window; on mesh()
  /// The same fields at times in (t, t + dt], ascending, the last at t + dt. They are sent if
  /// Input::wants_history (of a fluid Setup::history as well) requests them. A force is the mean since the
  /// sample before.
  std::vector<Sample> history;
  double dt_limit = std::numeric_limits<double>::infinity();  // [s] longest next window this solver accepts
  /// Named scalars. Names in Description::columns go to history.csv. Reserved prefixes go elsewhere:
  ///   "seconds.<stage>"      wall seconds so far (timing.csv, summary)
  ///   "count.<what>"         counts so far (summary)
  ///   "check.<what>"         conservation checks so far (summary)
  ///   "memory.peak"          [bytes]
  ///   "alarm.<kind>.<part>"  a value that the case cannot have (summary); parts: time, x, y, z, value,
  ///                          bound, step
  ///   "<probe>:<metric>"     what a probe has found so far, absent until it is known; the metrics are
  ///                          first_peak, time_of_first_peak, peak, time_of_peak, impulse, mean_peak_50us,
  ///                          final, contact
  std::map<std::string, double> monitor;
  /// The window cannot be taken as it is; once more, no longer than dt_limit. Nothing else is needed then.
  bool retry_smaller_dt = false;
  std::string why, fix;  // of a retry, one line each: what failed, and what a user may change; may be empty
};

/// One solver as the scheme sees it. Legal calls per window: (advance rewind)* advance commit.
/// `advance` is `start` then `finish`. After an exception the participant is broken and is only destroyed.
class Participant {
 public:
  virtual ~Participant() = default;
  virtual const InterfaceMesh& mesh() const = 0;
  virtual const Description& description() const = 0;
  virtual void start(const Window&, const Input&) = 0;  // returns at once when remote (parallel schemes)
  /// The same with an input to keep, for a participant that would have to copy it.
  virtual void start_with(const Window& window, Input&& input) { start(window, input); }
  virtual Advanced finish() = 0;  // deadline inside
  Advanced advance(const Window& window, const Input& input) {
    start(window, input);
    return finish();
  }
  Advanced advance(const Window& window, Input&& input) {
    start_with(window, std::move(input));
    return finish();
  }
  virtual void rewind() = 0;                                  // exactly back to the last commit
  virtual void commit(bool write_output) = 0;                 // accept the window
  virtual void checkpoint(const std::filesystem::path&) = 0;  // last committed state
  virtual void resume(const std::filesystem::path&) = 0;
  /// Everything handed over for output is on disk when it returns. Throws Error(cannot_write).
  virtual void flush() {}
};

}  // namespace strake
