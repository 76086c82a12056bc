#pragma once

#include "coupler/acceleration/shared_columns.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <string>

namespace strake {

/// A matrix J = L Zᵀ of few columns.
struct LowRank {
  SharedColumns left, right;

  Eigen::VectorXd times(const Eigen::VectorXd& v) const;
  void add(const SharedColumns& more_left, const SharedColumns& more_right);
  /// Replaces J by its best approximation by at most `rank` columns in the scaled space D J D⁻¹. Singular
  /// values below `smallest` of the largest are dropped. scale: the diagonal of D.
  void truncate(Eigen::Index rank, double smallest, const Eigen::VectorXd& scale);

  void save(Archive&, const std::string& name) const;
  void load(const Archive&, const std::string& name);
};

}  // namespace strake
