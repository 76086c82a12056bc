#pragma once

#include "proto/case/foreign_keys.hpp"
#include "proto/case/window_choice.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <string>
#include <thread>
#include <vector>

namespace strake {

class CaseFile;

/// [[output.probe]]: one place, one quantity.
struct ProbeKeys {
  std::string name;  // "mid"; vector quantities make "mid.x", "mid.y"(, "mid.z")
  std::string of;    // "fluid" | "structure", also of the body whose case it is; another body's name
  Eigen::Vector3d at =
      Eigen::Vector3d::Zero();  // [m] reference configuration; moves with the body it touches
  /// Structure: "deflection" | "displacement" | "velocity" | "von_mises" | "stress"; fluid: "pressure" |
  /// "front" | "level" | "height" | "gap" | "air_pressure", which stay where they are in space.
  std::string quantity;
  double diameter = 0;  // [m] pressure sensor; 0: 2 l0
};

/// One of several bodies, [[structures]].
struct BodyKeys {
  std::string name;
  std::string solver = "fem";
  ForeignKeys program;
};

/// The keys that more than one program reads, so that they are declared once.
struct CommonKeys {
  std::string title;
  std::string preset = "improved";
  double end_time = 0;         // [s]
  double output_every = 1e-4;  // [s]
  std::vector<ProbeKeys> probes;
  std::string interface = "surface";  // "surface" | "volume"
  std::string fluid_solver = "mps", structure_solver = "fem";
  ForeignKeys fluid_program, structure_program;  // where the solver is a program of the user's
  std::vector<BodyKeys> bodies;  // empty: one [structure]. Of one body's case, structure_solver is its own;
                                 // of the whole case it is that of the first
  std::string body;              // whose case it is; empty: the whole case
  const ForeignKeys& program_of(const std::string& side) const {
    if (side == "fluid") return fluid_program;
    for (const BodyKeys& one : bodies)
      if (one.name == side) return one.program;
    return structure_program;
  }
  double window = 1e-5;  // [s] of the chosen interface (coupling.surface.window or coupling.volume.window)
  WindowChoice chosen;   // what coupling.surface.window is where the case gives none
  std::string interpolation = "mean";  // load over a window as the structure takes it: its mean, or a history
                                       // "constant" | "linear" | "quadratic" between its samples
  int threads = 2;                     // run.threads
  bool threads_given = false;          // else each of several ranks has its share, threads_of_rank
  double checkpoint = 60;              // [s] of wall clock between checkpoints
};

/// Declares and reads title, preset, end_time, [output], coupling.interface, both windows, both solver names,
/// run.threads.
CommonKeys read_common(CaseFile&);

/// Number of processors that this process may use.
inline int processors_here() {
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

/// Threads of each of the ranks on one machine: run.threads, or where the case does not give it
///   max(1, processors / ranks).
/// Results do not depend on it.
inline int threads_of_rank(const CommonKeys& common, int ranks, int processors) {
  return common.threads_given ? common.threads : std::max(1, processors / std::max(1, ranks));
}

}  // namespace strake
