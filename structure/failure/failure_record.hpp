#pragma once

#include "proto/interface.hpp"

#include <Eigen/Core>

#include <map>
#include <string>
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

}  // namespace strake::structure
