#include "structure/particle/linear/frequencies.hpp"

#include "structure/particle/linear/saddle_point_solver.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace strake::structure {
namespace {

/// Smooth, independent vectors: cosines along the unknowns.
Eigen::MatrixXd start_vectors(Eigen::Index n, Eigen::Index width) {
  Eigen::MatrixXd Q(n, width);
  for (Eigen::Index c = 0; c < width; ++c)
    for (Eigen::Index r = 0; r < n; ++r)
      Q(r, c) = std::cos(std::numbers::pi * static_cast<double>(c / 2 + 1) * static_cast<double>(r) /
                         static_cast<double>(n)) *
                (r % 2 == c % 2 ? 1.0 : 0.1);
  return Q;
}

}  // namespace

// Orthogonal (subspace) iteration with (M^-½ K M^-½ + σ)⁻¹: eigenvalues 1/(ω² + σ), the largest first. σ > 0
// lets a free body with its rigid motions be factorised. Supports' equations take their directions out: 0.
std::vector<double> lowest_frequencies(VibrationProblem problem, double scale, int count) {
  constexpr int max_iterations = 200;
  constexpr double tolerance = 1e-8;  // change of the eigenvalues between iterations; round-off leaves 1e-10
  constexpr int guard = 4;
  const double sigma = std::pow(2 * std::numbers::pi * scale, 2);
  Eigen::SparseMatrix<double>& K = problem.stiffness;
  const Eigen::VectorXd& m = problem.mass;
  for (Eigen::Index c = 0; c < K.outerSize(); ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(K, c); entry; ++entry)
      entry.valueRef() /= m[entry.row()] == m[c] ? m[c] : std::sqrt(m[entry.row()] * m[c]);
  for (Eigen::Index i = 0; i < K.rows(); ++i) K.coeffRef(i, i) += sigma;
  Eigen::SparseMatrix<double, Eigen::RowMajor>& C = problem.equations;
  C = C * m.cwiseSqrt().cwiseInverse().asDiagonal() * std::sqrt(m.maxCoeff());
  SaddlePointSolver solver;
  solver.factorise(K, C);

  const Eigen::Index n = K.rows(), wanted_and_rigid = count + problem.rigid_motions,
                     width = std::min<Eigen::Index>(n, wanted_and_rigid + guard);
  Eigen::MatrixXd Q = start_vectors(n, width);
  Eigen::VectorXd value = Eigen::VectorXd::Zero(width);
  for (int k = 0; k < max_iterations; ++k) {
    Q = Eigen::HouseholderQR<Eigen::MatrixXd>(Q).householderQ() * Eigen::MatrixXd::Identity(n, width);
    const Eigen::MatrixXd Z = solver.solve(Q);
    Eigen::VectorXd next = Eigen::EigenSolver<Eigen::MatrixXd>(Q.transpose() * Z, false).eigenvalues().real();
    std::sort(next.begin(), next.end(), std::greater<>());
    Q = Z;
    const Eigen::Index wanted = std::min<Eigen::Index>(width, wanted_and_rigid);
    const double change = (next - value).head(wanted).cwiseAbs().maxCoeff();
    value = next;
    if (change <= tolerance * value[wanted - 1]) break;
  }
  std::vector<double> frequency;
  for (const double v : value) {
    const double omega2 = 1 / v - sigma;
    // A rigid motion has ω² = 0 up to the round-off of the differences.
    if (omega2 > 1e-4 * sigma && static_cast<int>(frequency.size()) < count)
      frequency.push_back(std::sqrt(omega2) / (2 * std::numbers::pi));
  }
  return frequency;
}

}  // namespace strake::structure
