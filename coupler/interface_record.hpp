#pragma once

#include <filesystem>
#include <vector>

#include "proto/interface.hpp"

namespace strake {

/// The interface of a run, window by window, on the structure's mesh.
struct InterfaceRecord {
  InterfaceMesh mesh;
  Points initial_displacement, initial_velocity;  // 3×n at the start; velocity empty where it was unknown
  std::vector<Window> windows;                    // ascending, without gaps
  std::vector<Points> displacement,
      velocity;               // at the end of each window; velocity empty where it was not sent
  std::vector<Points> force;  // 3×n [N] mean over each window

  double start() const { return windows.empty() ? 0 : windows.front().t; }
  double end() const { return windows.empty() ? 0 : windows.back().t + windows.back().dt; }
  /// Displacement [m] at a time: cubic between window ends where velocities were recorded, else linear; at a
  /// window's end exactly what was recorded. Held outside the record.
  Points displacement_at(double time) const;
  /// Velocity [m/s]: the derivative of the above, at a window's end what was recorded.
  Points velocity_at(double time) const;
  /// (1/dt) ∫ f dt over [t, t + dt] [N]: keeps the impulse when windows differ. Zero outside the record.
  Points mean_force(double t, double dt) const;
};

/// Writes interface/000001.h5 … of a run folder, a fixed number of windows per file. Each file appears whole
/// or not at all; `flush` writes the last, partial one (end of the run, interruption) and may be followed by
/// more windows.
class InterfaceRecorder {
 public:
  /// initial: displacement [m] and velocity [m/s] at the start, where known.
  InterfaceRecorder(std::filesystem::path run_folder, InterfaceMesh mesh, const std::vector<Field>& initial,
                    int windows_per_file = 100);
  void append(const Window&, const Points& displacement, const Points& velocity, const Points& force);
  void flush();
  /// Drops what lies after `time` (resume) and goes on from there.
  void resume(double time);

 private:
  void write_block(std::size_t block);
  std::filesystem::path folder_;
  InterfaceRecord record_;  // the windows of the current block alone
  std::size_t per_file_, block_ = 0;
};

/// Reads a whole run back. Throws Error(case_file) when there is no record, or its parts do not fit together.
InterfaceRecord read_interface_record(const std::filesystem::path& run_folder);

}  // namespace strake
