#pragma once

#include "proto/interface.hpp"

#include <Eigen/Core>

#include <vector>

namespace strake {

/// One of the overlapping balls that cover a cloud of sources and share the targets: a partition of unity. A
/// large ball that reaches into a dense part of the cloud takes only some of the sources there.
struct Patch {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // [m]
  double radius = 0;                                 // [m]
  double spacing = 0;                                // [m] mean distance of its sources to the nearest other
  std::vector<Eigen::Index> source, target;          // ascending
};

struct PatchParameters {
  int points = 50;        // sources of one patch, about; a cloud of no more is one patch
  double overlap = 0.15;  // radius beyond the cell that the patch serves, relative
};

struct PartitionOfUnity {
  std::vector<Patch> patches;
  std::vector<std::vector<Eigen::Index>> of_target;  // its patches, ascending, at least one
  Eigen::Index beyond = 0;  // targets in no ball: served by the one that they lie least beyond
};

PartitionOfUnity divide(const Points& sources, const Points& targets, const PatchParameters&);

/// Weights of the patches at the target i, in the order of of_target[i]. They sum to 1 and fall to 0 at a
/// ball's border. Where patches overlap, the smaller one, with denser sources, gets the larger weight.
std::vector<double> shares(const PartitionOfUnity&, Eigen::Index i, const Eigen::Vector3d& position);

}  // namespace strake
