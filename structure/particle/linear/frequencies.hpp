#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <vector>

namespace strake::structure {

/// K v = ω² M v with C v = 0, where M is diagonal.
struct VibrationProblem {
  Eigen::SparseMatrix<double> stiffness;                   // K [N/m]
  Eigen::VectorXd mass;                                    // diagonal of M [kg]
  Eigen::SparseMatrix<double, Eigen::RowMajor> equations;  // C
  int rigid_motions = 0;                                   // that the body could have
};

/// The lowest `count` frequencies ω/2π [Hz], ascending, without those of rigid motions. `scale` [Hz] is of
/// the order of the first.
std::vector<double> lowest_frequencies(VibrationProblem, double scale, int count);

}  // namespace strake::structure
