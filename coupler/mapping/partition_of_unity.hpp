#pragma once

#include "proto/interface.hpp"

#include <Eigen/Core>

#include <string>
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

/// φ(r) of a radial basis function.
enum class RadialFunction { wendland_c2, wendland_c4, wendland_c6, thin_plate };

/// Throws Error(case_file) for a name that is none of "wendland-c2", "wendland-c4", "wendland-c6",
/// "thin-plate".
RadialFunction radial_function(const std::string& name);
bool has_support(RadialFunction);
/// The default support, in spacings of the points. A wider one gains little; with this one the systems keep
/// some six digits or more.
constexpr double usual_support = 40;

/// φ at squared distances [any unit], `support` in that unit (no matter for a function without).
Eigen::ArrayXd radial_values(RadialFunction, double support, const Eigen::ArrayXd& squared_distance);

/// What carries values from scattered sources to targets.
struct LocalWeights {
  Eigen::MatrixXd weights;  // n_sources × n_targets; each column sums to 1
  double condition = 1;     // of the system
  int directions = 0;       // in which linear fields are reproduced: fewer where the sources are flat
};

/// Interpolation by radial basis functions centred in the sources, with a constant or linear polynomial that
/// is reproduced exactly. In a direction in which the sources have no extent, or much less than the targets,
/// the polynomial is constant. Sources must not coincide. With a condition above `1/ε` the weights have no
/// correct digits.
LocalWeights local_weights(RadialFunction, double support, bool linear, const Points& sources,
                           const Points& targets);

}  // namespace strake
