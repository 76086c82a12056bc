#pragma once

#include "coupler/coupling/exchange.hpp"
#include "proto/error.hpp"
#include "proto/interface.hpp"
#include "proto/participant.hpp"

#include <optional>
#include <set>
#include <string>
#include <vector>

namespace strake {

/// One of several bodies in one water.
struct Body {
  std::string name;
  Participant* solver = nullptr;  // lives longer than the assembly
};

/// Several bodies as one structure: the scheme sees one mesh, one motion and one load. The bodies stand in
/// the mesh one after the other, compute at the same time, and are accelerated, taken back and committed
/// together.
class Assembly final : public Participant {
 public:
  /// All bodies send the same fields. `probes`: names of the case's probes, whose columns and results keep
  /// them; every other column is called "NAME.column". nearest: bodies closer than this [m] are refused.
  /// Throws Error(solver_fault) where bodies do not fit together, Error(case_file) for bodies that overlap.
  Assembly(std::vector<Body>, std::set<std::string> probes, double nearest);

  const InterfaceMesh& mesh() const override { return mesh_; }
  const Description& description() const override { return description_; }
  void start(const Window&, const Input&) override;
  /// Of bodies that want a shorter window the shortest counts; its `why` begins with the body's name.
  Advanced finish() override;
  void rewind() override;
  void commit(bool write_output) override;
  void checkpoint(const std::filesystem::path& folder) override;
  void resume(const std::filesystem::path& folder) override;
  /// The velocity at the last commit. The scheme keeps the motion as it was sent, so without a correction of
  /// the start.
  void save(Archive&) const;
  /// After a resume: the structure at the last commit, as the scheme keeps it, the windows until then, and
  /// what `save` wrote; older checkpoints do not have it.
  void load(const Archive&, const StructureSample&, long windows);

 private:
  Eigen::Index points_of(std::size_t body) const;
  Input input_of(std::size_t body, const Window&, const Input&) const;
  bool take_motion(std::size_t body, Advanced&);  // true: it sent its velocity
  void keep_begin();
  void join_meshes();
  void join_descriptions();
  void gather_monitor(const std::string& body, const std::map<std::string, double>&,
                      std::map<std::string, double>& all) const;
  std::string column_name(const std::string& body, const std::string& column) const;
  void refuse_contact(ExitCode, const std::string& when, const Points& displacement) const;

  std::vector<Body> bodies_;
  std::vector<StructureSample> announced_;  // of each body
  std::set<std::string> probes_;
  double nearest_;  // [m]
  InterfaceMesh mesh_;
  Description description_;
  Window window_;
  Motion committed_, last_;           // of all, 3×n; last_: at the end of the window under way
  std::vector<bool> sends_velocity_;  // of each body, in that window
  bool begins_ = true;                // no window has been computed
  StructureSamples begin_;  // at the start and after the first window, until the second is committed
};

/// Two bodies of a mesh that are close to each other.
struct BodyGap {
  std::string one, other;
  double distance = 0;                           // [m] between a point of `one` and a face of `other`
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // [m] that point
  bool inside = false;                           // it lies in the other body
};

/// The smallest distance between two of the mesh's bodies, if it is below `limit` [m]; nothing otherwise.
/// displacement: 3×n [m] of the mesh's points.
std::optional<BodyGap> closest_bodies(const InterfaceMesh&, const Points& displacement, double limit);

/// The first body with a point inside another one, which is closed. Only the start of a run needs it: later a
/// body cannot come into another without touching it.
std::optional<BodyGap> body_inside_another(const InterfaceMesh&, const Points& displacement);

}  // namespace strake
