#pragma once

#include "proto/interface.hpp"

#include <Eigen/Core>

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace strake::structure {

/// When and where a body began to fail: part of its state.
struct FailureRecord {
  struct Event {
    double time = -1;                              // [s]; before it happened: negative
    Eigen::Vector3d at = Eigen::Vector3d::Zero();  // [m] in the reference configuration
    bool happened() const { return time >= 0; }
  };
  Event start;   // the stress first reached the strength (bond_strain: as crack)
  Event crack;   // the first bond or cell broke
  Event parted;  // no way leads any more from one large piece to another

  /// "failure.start.time" [s], "failure.start.x" … [m] of what has happened.
  void report(std::map<std::string, double>& monitor) const;
  Eigen::MatrixXd table() const;  // 4×3, for a checkpoint
  static FailureRecord from(const Eigen::MatrixXd& table);
};

/// The connected pieces of a body.
class Pieces {
 public:
  explicit Pieces(Eigen::Index n);
  void join(Eigen::Index a, Eigen::Index b);
  /// Piece of each element; −1 for a piece with less than a hundredth of them, which is debris.
  std::vector<Eigen::Index> large();
  static bool more_than_one(const std::vector<Eigen::Index>& pieces);

 private:
  Eigen::Index root(Eigen::Index);
  std::vector<Eigen::Index> parent_;
};

/// The place of a parting: the middle of what joined two large pieces, the first two it is told of. A body
/// that parts at both ends at once falls into three, and the middle of both joints would lie on neither.
class Joint {
 public:
  /// A bond or a cell that joined these pieces; none if they are one, or if one of them is debris.
  void add(Eigen::Index piece, Eigen::Index other, const Eigen::Vector3d& place);
  Eigen::Vector3d middle_or(const Eigen::Vector3d& if_none) const;

 private:
  std::pair<Eigen::Index, Eigen::Index> pieces_;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  double count_ = 0;
};

}  // namespace strake::structure
