#pragma once

#include "proto/ranks/communicator.hpp"

#include <Eigen/Core>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace dealii::Utilities::MPI {
class Partitioner;
}

namespace strake::structure::fem {

/// The division of a body's unknowns among ranks. A vector of a rank has the unknowns of its own nodes first.
/// Behind them stand copies of those of other ranks whose cells touch its own nodes, the ghosts. A rank has
/// all cells around its own nodes, so that it adds up complete forces and rows of matrices there; those of
/// ghosts are not complete and not used. By default there is one rank, which has all.
class RankDivision {
 public:
  /// Ranks are the processes of MPI_COMM_WORLD.
  struct Parts {
    Communicator& communicator;
    std::shared_ptr<const dealii::Utilities::MPI::Partitioner> entries;  // own ones and ghosts, by deal.II
    std::vector<int> on_one_rank;  // number of each entry in the body on one rank
  };
  RankDivision() = default;
  explicit RankDivision(std::shared_ptr<const Parts> parts) : parts_(std::move(parts)) {}

  bool alone() const { return parts_ == nullptr; }
  bool first() const { return alone() || communicator().rank() == 0; }
  Communicator& communicator() const { return parts_->communicator; }
  const dealii::Utilities::MPI::Partitioner& entries() const { return *parts_->entries; }

  /// How many of the unknowns are the rank's own, out of `all` that it has.
  Eigen::Index own(Eigen::Index all) const { return alone() ? all : own_of_parts(); }
  bool owns(int entry) const { return alone() || entry < own_of_parts(); }
  /// Number of an unknown in the body on one rank.
  int number(int entry) const {
    return alone() ? entry : parts_->on_one_rank[static_cast<std::size_t>(entry)];
  }
  /// Of the whole body.
  Eigen::Index size(Eigen::Index own_size) const { return alone() ? own_size : size_of_parts(); }

  /// Sums and extremes over the ranks, on all of them the same.
  double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    return sum(a.head(own(a.size())).dot(b.head(own(b.size()))));
  }
  double norm(const Eigen::VectorXd& a) const { return std::sqrt(sum(a.head(own(a.size())).squaredNorm())); }
  double sum(double value) const { return alone() ? value : communicator().sum(value); }
  double max(double value) const { return alone() ? value : communicator().max(value); }
  double min(double value) const { return -max(-value); }
  bool any(bool own) const { return alone() ? own : communicator().any(own); }
  /// Adds up a matrix of each rank.
  Eigen::MatrixXd sum(const Eigen::MatrixXd&) const;
  static constexpr double nothing = -0.0;  // changes no bit of a sum
  /// The largest vector of all ranks: that of the largest first value, of equal ones by the next value.
  Eigen::VectorXd largest(const Eigen::VectorXd& own) const;

  /// Copies the values of ghosts from their owners.
  void update(Eigen::VectorXd& values) const;
  /// The vector of the whole body, numbered as on one rank, and the rank's part of such a vector.
  Eigen::VectorXd whole(const Eigen::VectorXd& values) const;
  Eigen::VectorXd part(const Eigen::VectorXd& whole) const;
  /// Columns of all ranks on the first one, in the order of their first row; on the others none.
  Eigen::MatrixXd columns_on_first(const Eigen::MatrixXd& own) const;

 private:
  Eigen::Index own_of_parts() const;
  Eigen::Index size_of_parts() const;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace strake::structure::fem
