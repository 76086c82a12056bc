#pragma once

#include "proto/interface.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace strake {

/// The interface of a run, window by window, on the structure's mesh.
struct InterfaceRecord {
  InterfaceMesh mesh;
  Points initial_displacement, initial_velocity;  // 3×n at the start; empty: no motion crosses the interface
  std::vector<Window> windows;                    // ascending, without gaps
  std::vector<Points> displacement, velocity;     // at the end of each window
  std::vector<Points> force;                      // 3×n [N] mean over each window
  /// Every other exchanged field, or all if there is no motion and force. The key is side and quantity:
  /// "structure.area", "fluid.pressure", "attachments.force".
  struct Other {
    std::string unit;
    std::vector<Eigen::MatrixXd> value;  // components×n, one per window, as displacement or force
  };
  std::map<std::string, Other> other;

  /// A window after the last; an empty velocity is filled in as above.
  void append(const Window&, const Points& displacement, const Points& velocity, const Points& force);
  double start() const { return windows.empty() ? 0 : windows.front().t; }
  double end() const { return windows.empty() ? 0 : windows.back().t + windows.back().dt; }
  /// The part of one of several bodies. Throws Error(case_file) where the record has no such body; `source`
  /// names it.
  InterfaceRecord of_body(const std::string& name, const std::string& source) const;
  /// Displacement [m] and velocity [m/s] at a time: the cubic with the recorded values at both ends of its
  /// window. Where the structure sent no velocity, the one that the fluid took: v_(n+1) = 2 (x_(n+1) −
  /// x_n)/dt − v_n, and the cubic is the parabola of constant acceleration. At a window's end exactly what
  /// was recorded. Held outside the record.
  Points displacement_at(double time) const;
  Points velocity_at(double time) const;
  /// (1/dt) ∫ f dt over [t, t + dt] [N]: keeps the impulse when windows differ. Zero outside the record.
  Points mean_force(double t, double dt) const;
};

/// Writes interface/000001.h5 … of a run folder, a fixed number of windows per file. Each file appears whole
/// or not at all; `flush` writes the last, partial one (end of the run, interruption), waits until all are on
/// the disk, and may be followed by more windows.
class InterfaceRecorder {
 public:
  /// initial: displacement [m] and velocity [m/s] at the start, where known.
  InterfaceRecorder(std::filesystem::path run_folder, InterfaceMesh mesh, const std::vector<Field>& initial,
                    int windows_per_file = 100);
  /// displacement, force: empty, in all windows, where these do not cross the interface.
  void append(const Window&, const Values& displacement, const Values& velocity, const Values& force,
              const std::vector<Field>& from_structure = {}, const std::vector<Field>& from_fluid = {},
              const std::vector<Field>& from_attachments = {});
  void flush();
  /// Drops entries after `time` (resume) and continues from there. Throws Error(case_file) when the record
  /// does not reach `time`.
  void resume(double time);

 private:
  void write_block(std::size_t block);
  void keep(std::size_t n_windows);
  std::filesystem::path folder_;
  std::filesystem::path file(std::size_t block) const;
  InterfaceRecord record_;  // the windows of the current block alone; what was not sent stays empty
  std::size_t per_file_, block_ = 0;
  std::size_t on_disk_ = 0;  // blocks for whose bytes `flush` has waited
};

/// Reads a whole run back. Throws Error(case_file) when there is no record, its parts do not fit together, or
/// it has no motion and force to replay.
InterfaceRecord read_interface_record(const std::filesystem::path& run_folder);

/// Throws Error(case_file) where the record ends before the run that plays it; `source` names it.
void require_end(const InterfaceRecord&, double end_time, const std::string& source);

/// Where each of several bodies begins in a recorded interface ("body.left": first point, first face), in
/// order; none for one structure.
std::vector<MeshPart> parts_in(const Archive&);

}  // namespace strake
