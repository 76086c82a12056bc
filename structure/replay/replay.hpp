#pragma once

#include "coupler/participant/interface_record.hpp"
#include "structure/body/parameters.hpp"
#include "structure/solver/solver.hpp"

namespace strake::structure {

/// Plays back the interface motion that an earlier run recorded, whatever the load. The record must lie on
/// the same interface points, which depend on the shape alone.
class Replay final : public Solver {
 public:
  /// Throws Error(case_file) when the record is on another mesh than the case's.
  Replay(const Parameters&, InterfaceRecord);
  const InterfaceMesh& interface() const override { return record_.mesh; }
  void advance(double t, double dt, const Load&) override;
  Points displacement() const override;
  Points velocity() const override;
  /// The work of the recorded force on the recorded motion is not followed: nothing is known of the inside.
  Energy energy() const override { return {}; }
  bool prescribed() const override { return true; }
  int steps() const override { return state_.steps; }
  Eigen::Vector3d displacement_at(const Eigen::Vector3d& X) const override;
  Eigen::Vector3d velocity_at(const Eigen::Vector3d& X) const override;
  void save() override { saved_ = state_; }
  void restore() override { state_ = saved_; }
  void write(Archive&) const override;
  void read(const Archive&) override;
  Frame frame() const override;
  std::vector<std::string> lines() const override;

 private:
  struct State {
    double time = 0;  // [s]
    int steps = 0;
  };
  std::string source_;  // the run folder, for messages
  InterfaceRecord record_;
  State state_, saved_;
};

/// Throws Error(case_file) unless both meshes have the same points.
void require_same_mesh(const InterfaceMesh& recorded, const InterfaceMesh& wanted, const std::string& source);

}  // namespace strake::structure
