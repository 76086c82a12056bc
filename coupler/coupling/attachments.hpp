#pragma once

#include "coupler/coupling/exchange.hpp"
#include "coupler/mapping/sparse_operator.hpp"
#include "proto/participant.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// A participant that is coupled to a few points of the structure, not to the water: a mooring line, a
/// controller. It receives the motion of its points and sends the force on them.
struct Attachment {
  std::string name;
  Participant* solver = nullptr;  // lives longer than the scheme; mesh(): its k points,
                                  // description().initial: the force on them [N]
  SparseOperator to_points = {};  // W, k×n: the motion of its points from that of the structure's
};

/// All attachments of a structure. Within an iteration they compute from the same guess of the motion as the
/// fluid, at the same time. Their force is added to the load that the structure takes, so it belongs to the
/// same fixed-point equation:
///   H(x) = structure(fluid(x) + Σ Wᵀ g(W x)).
class Attachments {
 public:
  /// Throws Error(solver_fault) for an attachment that sends
  /// something else than the force on its points.
  explicit Attachments(std::vector<Attachment>);

  bool none() const { return attachments_.empty(); }
  /// end: motion of the structure's points at the window's end.
  void start(const Window&, const Motion& end);
  struct Shorter {
    std::string who;
    Advanced answer;
  };
  /// Waits for all. The one that wants the shortest window is returned, if any does.
  std::optional<Shorter> finish(const Place&);
  void rewind();
  void commit(bool write_output);

  /// The sum of their forces on the structure's points: 3×n [N], mean over the window. 3×0 without any.
  const Values& load() const { return load_; }
  /// What they reported with the last window, each name behind the attachment's: "mooring.tension". The
  /// force of each stands there as "mooring.force.x".
  const std::map<std::string, double>& monitor() const { return monitor_; }
  double dt_limit() const { return dt_limit_; }  // [s] longest next window that all accept

 private:
  struct Attached {
    Attachment of;
    SparseOperator to_structure;   // Wᵀ
    std::vector<Field> announced;  // the force at the start
  };
  void gather(const Attachment&, const Values& force, const std::map<std::string, double>& own);
  std::vector<Attached> attachments_;
  Values load_ = Points();
  std::map<std::string, double> monitor_;
  double dt_limit_ = std::numeric_limits<double>::infinity();
};

}  // namespace strake
