#include "structure/particle/linearised.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>
#include <Eigen/Dense>
#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace strake::structure {
namespace {

// Step of the central differences in spacings: the forces are smooth on the scale of a bond, so that
// truncation (1e-12) and round-off (1e-16/1e-5) are both far below what is asked of K.
constexpr double difference_step = 1e-5;

/// Number of a free particle's first unknown, or -1.
std::vector<int> unknowns(const Lattice& lattice) {
  std::vector<int> number(static_cast<std::size_t>(lattice.size()), -1);
  int next = 0;
  for (std::size_t i = 0; i < number.size(); ++i)
    if (!lattice.fixed[i]) number[i] = 2 * next++;
  return number;
}

int count_unknowns(const Lattice& lattice) {
  return 2 * static_cast<int>(std::count(lattice.fixed.begin(), lattice.fixed.end(), 0));
}

Eigen::VectorXd gather(const Lattice& lattice, const Eigen::Matrix2Xd& full) {
  Eigen::VectorXd x(count_unknowns(lattice));
  Eigen::Index at = 0;
  for (Eigen::Index i = 0; i < lattice.size(); ++i)
    if (!lattice.fixed[static_cast<std::size_t>(i)]) {
      x.segment<2>(at) = full.col(i);
      at += 2;
    }
  return x;
}

Eigen::Matrix2Xd scatter(const Lattice& lattice, const Eigen::VectorXd& x) {
  Eigen::Matrix2Xd full = Eigen::Matrix2Xd::Zero(2, lattice.size());
  Eigen::Index at = 0;
  for (Eigen::Index i = 0; i < lattice.size(); ++i)
    if (!lattice.fixed[static_cast<std::size_t>(i)]) {
      full.col(i) = x.segment<2>(at);
      at += 2;
    }
  return full;
}

void factorise(Eigen::SparseLU<Eigen::SparseMatrix<double>>& lu, const Eigen::SparseMatrix<double>& K) {
  lu.compute(K);
  if (lu.info() != Eigen::Success)
    throw Error(ExitCode::solver_fault, "structure, particle", "the stiffness matrix is singular",
                "hold the plate: structure.plate.supports");
}

}  // namespace

// Columns further apart than twice the influence do not meet in any force, so they are disturbed together.
Eigen::SparseMatrix<double> stiffness(const ElasticModel& model, const Lattice& lattice,
                                      const Eigen::Matrix2Xd& u) {
  const std::vector<int> number = unknowns(lattice);
  const int reach = model.influence(), period = 2 * reach + 1;
  const double step = difference_step * lattice.spacing;
  std::vector<Eigen::Triplet<double>> entries;
  for (int first = 0; first < std::min(period, lattice.columns); ++first) {
    for (int layer = 0; layer < lattice.layers; ++layer) {
      for (int axis = 0; axis < 2; ++axis) {
        Eigen::Matrix2Xd plus = u, minus = u;
        for (int c = first; c < lattice.columns; c += period) {
          plus(axis, lattice.index(c, layer)) += step;
          minus(axis, lattice.index(c, layer)) -= step;
        }
        const Eigen::Matrix2Xd column = (model.force(minus) - model.force(plus)) / (2 * step);
        for (int c = first; c < lattice.columns; c += period) {
          const int j = number[static_cast<std::size_t>(lattice.index(c, layer))];
          if (j < 0) continue;
          for (int k = std::max(0, c - reach); k <= std::min(lattice.columns - 1, c + reach); ++k) {
            for (int l = 0; l < lattice.layers; ++l) {
              const Eigen::Index at = lattice.index(k, l);
              const int i = number[static_cast<std::size_t>(at)];
              if (i < 0) continue;
              for (int a = 0; a < 2; ++a)
                if (column(a, at) != 0) entries.emplace_back(i + a, j + axis, column(a, at));
            }
          }
        }
      }
    }
  }
  const int n = count_unknowns(lattice);
  Eigen::SparseMatrix<double> K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

Eigen::Matrix2Xd equilibrium(const ElasticModel& model, const Lattice& lattice,
                             const Eigen::Matrix2Xd& force) {
  constexpr int max_iterations = 30;
  constexpr double tolerance = 1e-9;  // of the increment, relative to the displacement
  Eigen::Matrix2Xd u = Eigen::Matrix2Xd::Zero(2, lattice.size());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu;
  for (int k = 0; k < max_iterations; ++k) {
    factorise(lu, stiffness(model, lattice, u));
    const Eigen::VectorXd increment = lu.solve(gather(lattice, model.force(u) + force));
    if (!increment.allFinite()) break;
    u += scatter(lattice, increment);
    if (increment.lpNorm<Eigen::Infinity>() <= tolerance * u.lpNorm<Eigen::Infinity>()) return u;
  }
  throw Error(ExitCode::solver_fault, "structure, particle", "no equilibrium found under the case's own load",
              "lower structure.load.value, or structure.analysis = \"dynamic\" with structure.load.ramp");
}

// Orthogonal (subspace) iteration with (K + σM)⁻¹: eigenvalues 1/(ω² + σ), the largest first. σ > 0 lets a
// free body with its rigid motions be factorised.
std::vector<double> natural_frequencies(const ElasticModel& model, const Lattice& lattice, double mass,
                                        double scale, int count) {
  constexpr int max_iterations = 200;
  constexpr double tolerance = 1e-8;  // change of the eigenvalues between iterations; round-off leaves 1e-10
  constexpr int rigid_motions = 3, guard = 4;
  const double sigma = std::pow(2 * std::numbers::pi * scale, 2);
  const Eigen::Matrix2Xd rest = Eigen::Matrix2Xd::Zero(2, lattice.size());
  Eigen::SparseMatrix<double> K = stiffness(model, lattice, rest) / mass;
  for (Eigen::Index i = 0; i < K.rows(); ++i) K.coeffRef(i, i) += sigma;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu;
  factorise(lu, K);

  const Eigen::Index n = K.rows(), m = std::min<Eigen::Index>(n, count + rigid_motions + guard);
  Eigen::MatrixXd Q(n, m);
  for (Eigen::Index c = 0; c < m; ++c)  // smooth, independent start vectors: cosines along the unknowns
    for (Eigen::Index r = 0; r < n; ++r)
      Q(r, c) = std::cos(std::numbers::pi * static_cast<double>(c / 2 + 1) * static_cast<double>(r) /
                         static_cast<double>(n)) *
                (r % 2 == c % 2 ? 1.0 : 0.1);
  Eigen::VectorXd value = Eigen::VectorXd::Zero(m);
  for (int k = 0; k < max_iterations; ++k) {
    Q = Eigen::HouseholderQR<Eigen::MatrixXd>(Q).householderQ() * Eigen::MatrixXd::Identity(n, m);
    const Eigen::MatrixXd Z = lu.solve(Q);
    Eigen::VectorXd next = Eigen::EigenSolver<Eigen::MatrixXd>(Q.transpose() * Z, false).eigenvalues().real();
    std::sort(next.begin(), next.end(), std::greater<>());
    Q = Z;
    const Eigen::Index wanted = std::min<Eigen::Index>(m, count + rigid_motions);
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

double elastic_limit(const ElasticModel& model, const Lattice& lattice, double mass) {
  constexpr int iterations = 150;  // Rayleigh quotient within 1 % of ω²_max (tested against the exact value)
  Eigen::Matrix2Xd v(2, lattice.size());
  // The shortest waves are the stiffest: alternate signs, and break every symmetry a little.
  for (int c = 0; c < lattice.columns; ++c)
    for (int l = 0; l < lattice.layers; ++l)
      v.col(lattice.index(c, l)) << ((c + l) % 2 ? 1 : -1) * (1 + 0.1 * std::sin(3.7 * c + 1.3 * l)),
          (c % 2 ? 1 : -1) * (1 + 0.1 * std::cos(2.9 * c - 0.7 * l));
  const auto hold = [&](Eigen::Matrix2Xd& x) {
    for (Eigen::Index i = 0; i < lattice.size(); ++i)
      if (lattice.fixed[static_cast<std::size_t>(i)]) x.col(i).setZero();
  };
  const double step = difference_step * lattice.spacing;
  double omega2 = 0;
  for (int k = 0; k < iterations; ++k) {
    hold(v);
    v.normalize();
    const Eigen::Matrix2Xd disturbed = step * v;
    Eigen::Matrix2Xd Kv = (model.force(-disturbed) - model.force(disturbed)) / (2 * step * mass);
    hold(Kv);
    omega2 = v.cwiseProduct(Kv).sum();
    v = Kv;
  }
  return 2 / std::sqrt(omega2);
}

}  // namespace strake::structure
