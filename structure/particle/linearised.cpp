#include "structure/particle/linearised.hpp"

#include "proto/error.hpp"
#include "structure/material/symmetric.hpp"

#include <Eigen/QR>
#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake::structure {
namespace {

/// Number of a free particle's first unknown, or -1.
template <int dim>
std::vector<int> unknowns(const Lattice<dim>& lattice) {
  std::vector<int> number(static_cast<std::size_t>(lattice.size()), -1);
  int next = 0;
  for (std::size_t i = 0; i < number.size(); ++i)
    if (!lattice.fixed[i]) number[i] = dim * next++;
  return number;
}

template <int dim>
int count_unknowns(const Lattice<dim>& lattice) {
  return dim * static_cast<int>(std::count(lattice.fixed.begin(), lattice.fixed.end(), 0));
}

template <int dim>
Eigen::VectorXd gather(const Lattice<dim>& lattice, const Vectors<dim>& full) {
  Eigen::VectorXd x(count_unknowns(lattice));
  Eigen::Index at = 0;
  for (Eigen::Index i = 0; i < lattice.size(); ++i)
    if (!lattice.fixed[static_cast<std::size_t>(i)]) {
      x.template segment<dim>(at) = full.col(i);
      at += dim;
    }
  return x;
}

template <int dim>
Vectors<dim> scatter(const Lattice<dim>& lattice, const Eigen::VectorXd& x) {
  Vectors<dim> full = Vectors<dim>::Zero(dim, lattice.size());
  Eigen::Index at = 0;
  for (Eigen::Index i = 0; i < lattice.size(); ++i)
    if (!lattice.fixed[static_cast<std::size_t>(i)]) {
      full.col(i) = x.template segment<dim>(at);
      at += dim;
    }
  return full;
}

/// Solves K x + Cᵀλ = b, C x = 0: the supports' equations beside those of the particles, by LU factors.
class SaddlePointSolver {
 public:
  /// Throws Error(solver_fault) where the matrix is singular.
  void factorise(const Eigen::SparseMatrix<double>& K, const SparseRows& C) {
    n_ = K.rows();
    const Eigen::Index m = C.rows();
    Eigen::SparseMatrix<double> whole(n_ + m, n_ + m);
    std::vector<Eigen::Triplet<double>> entries;
    double largest = 0;
    for (Eigen::Index c = 0; c < n_; ++c)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(K, c); entry; ++entry) {
        entries.emplace_back(static_cast<int>(entry.row()), static_cast<int>(c), entry.value());
        largest = std::max(largest, std::abs(entry.value()));
      }
    for (Eigen::Index r = 0; r < m; ++r)  // as large as K, for the pivots' sake
      for (SparseRows::InnerIterator entry(C, r); entry; ++entry) {
        const int row = static_cast<int>(n_ + r), column = static_cast<int>(entry.col());
        entries.emplace_back(row, column, largest * entry.value());
        entries.emplace_back(column, row, largest * entry.value());
      }
    // As in Constraints: equations that say the same twice share their reaction.
    constexpr double shared_out = 1e-12;
    for (Eigen::Index r = n_; r < n_ + m; ++r)
      entries.emplace_back(static_cast<int>(r), static_cast<int>(r), -shared_out * largest);
    whole.setFromTriplets(entries.begin(), entries.end());
    factors_.compute(whole);
    if (factors_.info() != Eigen::Success)
      throw Error(
          ExitCode::solver_fault, "structure, particle", "the stiffness matrix is singular",
          "hold it: structure.plate.supports, the supports of a structure.box, or [[structure.support]]");
  }
  /// x of each column of b.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const {
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(factors_.rows(), b.cols());
    whole.topRows(n_) = b;
    return Eigen::MatrixXd(factors_.solve(whole)).topRows(n_);
  }

 private:
  Eigen::SparseLU<Eigen::SparseMatrix<double>> factors_;
  Eigen::Index n_ = 0;  // rows of K
};

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

/// Computes the lowest `count` frequencies ω/2π [Hz] of K v = ω² M v with C v = 0, M = diag(m), ascending,
/// without those of rigid motions. `scale` [Hz] is of the order of the first; `rigid_motions`: that the body
/// could have.
///
/// Orthogonal (subspace) iteration with (M^-½ K M^-½ + σ)⁻¹: eigenvalues 1/(ω² + σ), the largest first. σ > 0
/// lets a free body with its rigid motions be factorised. Supports' equations take their directions out: 0.
std::vector<double> lowest_frequencies(Eigen::SparseMatrix<double> K, const Eigen::VectorXd& m, SparseRows C,
                                       int rigid_motions, double scale, int count) {
  constexpr int max_iterations = 200;
  constexpr double tolerance = 1e-8;  // change of the eigenvalues between iterations; round-off leaves 1e-10
  constexpr int guard = 4;
  const double sigma = std::pow(2 * std::numbers::pi * scale, 2);
  for (Eigen::Index c = 0; c < K.outerSize(); ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(K, c); entry; ++entry)
      entry.valueRef() /= m[entry.row()] == m[c] ? m[c] : std::sqrt(m[entry.row()] * m[c]);
  for (Eigen::Index i = 0; i < K.rows(); ++i) K.coeffRef(i, i) += sigma;
  C = C * m.cwiseSqrt().cwiseInverse().asDiagonal() * std::sqrt(m.maxCoeff());
  SaddlePointSolver solver;
  solver.factorise(K, C);

  const Eigen::Index n = K.rows(), wanted_and_rigid = count + rigid_motions,
                     width = std::min<Eigen::Index>(n, wanted_and_rigid + guard);
  Eigen::MatrixXd Q = start_vectors(n, width);
  Eigen::VectorXd value = Eigen::VectorXd::Zero(width);
  for (int k = 0; k < max_iterations; ++k) {
    Q = Eigen::HouseholderQR<Eigen::MatrixXd>(Q).householderQ() * Eigen::MatrixXd::Identity(n, width);
    const Eigen::MatrixXd Z = solver.solve(Q);
    const Eigen::VectorXd next = eigenvalues_of(Q.transpose() * Z).reverse();  // symmetric up to round-off
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

}  // namespace

// Computes K by differences, many particles at once. Particles further apart than twice the influence along
// any axis have no force in common.
template <int dim>
Eigen::SparseMatrix<double> stiffness(const ElasticModel<dim>& model, const Lattice<dim>& lattice,
                                      const Vectors<dim>& u) {
  using Cell = typename Lattice<dim>::Cell;
  const std::vector<int> number = unknowns<dim>(lattice);
  const int reach = model.influence();
  const Cell period = lattice.extent.cwiseMin(2 * reach + 1);
  std::vector<std::vector<Eigen::Index>> colours(static_cast<std::size_t>(period.prod()));
  for (Eigen::Index i = 0; i < lattice.size(); ++i) {
    if (lattice.fixed[static_cast<std::size_t>(i)]) continue;
    std::size_t colour = 0;
    for (int axis = 0; axis < dim; ++axis)
      colour = colour * static_cast<std::size_t>(period[axis]) +
               static_cast<std::size_t>(lattice.cell(axis, i) % period[axis]);
    colours[colour].push_back(i);
  }
  const double step = difference_step * lattice.spacing;
  std::vector<Eigen::Triplet<double>> entries;
  for (const std::vector<Eigen::Index>& together : colours)
    for (int axis = 0; axis < dim && !together.empty(); ++axis) {
      Vectors<dim> plus = u, minus = u;
      for (const Eigen::Index i : together) {
        plus(axis, i) += step;
        minus(axis, i) -= step;
      }
      const Vectors<dim> column = (model.force(minus) - model.force(plus)) / (2 * step);
      for (const Eigen::Index i : together) {
        const Cell here = lattice.cell.col(i);
        const Cell low = (here.array() - reach).max(0),
                   high = (here.array() + reach + 1).min(lattice.extent.array());
        for_each_cell<dim>(low, high, [&](const Cell& at) {
          const Eigen::Index k = lattice.index(at);
          if (k < 0 || number[static_cast<std::size_t>(k)] < 0) return;
          for (int a = 0; a < dim; ++a)
            if (column(a, k) != 0)
              entries.emplace_back(number[static_cast<std::size_t>(k)] + a,
                                   number[static_cast<std::size_t>(i)] + axis, column(a, k));
        });
      }
    }
  const int n = count_unknowns<dim>(lattice);
  Eigen::SparseMatrix<double> K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

template <int dim>
Vectors<dim> equilibrium(const ElasticModel<dim>& model, const Lattice<dim>& lattice,
                         const Constraints<dim>& supports, const Vectors<dim>& force) {
  constexpr int max_iterations = 30;
  constexpr double tolerance = 1e-9;  // of the increment, relative to the displacement
  Vectors<dim> u = Vectors<dim>::Zero(dim, lattice.size());
  const SparseRows C = supports.rows(unknowns<dim>(lattice), count_unknowns<dim>(lattice));
  SaddlePointSolver solver;
  for (int k = 0; k < max_iterations; ++k) {
    solver.factorise(stiffness<dim>(model, lattice, u), C);
    const Eigen::VectorXd increment = solver.solve(gather<dim>(lattice, model.force(u) + force));
    if (!increment.allFinite()) break;
    u += scatter<dim>(lattice, increment);
    if (increment.lpNorm<Eigen::Infinity>() <= tolerance * u.template lpNorm<Eigen::Infinity>()) return u;
  }
  throw Error(ExitCode::solver_fault, "structure, particle", "no equilibrium found under the case's own load",
              "lower structure.load.value, or structure.analysis = \"dynamic\" with structure.load.ramp");
}

template <int dim>
std::vector<double> natural_frequencies(const ElasticModel<dim>& model, const Lattice<dim>& lattice,
                                        const Constraints<dim>& supports, const Eigen::VectorXd& mass,
                                        double scale, int count) {
  return lowest_frequencies(stiffness<dim>(model, lattice, Vectors<dim>::Zero(dim, lattice.size())),
                            gather<dim>(lattice, mass.transpose().template replicate<dim, 1>()),
                            supports.rows(unknowns<dim>(lattice), count_unknowns<dim>(lattice)),
                            dim == 2 ? 3 : 6, scale, count);
}

template Eigen::SparseMatrix<double> stiffness<2>(const ElasticModel<2>&, const Lattice<2>&,
                                                  const Vectors<2>&);
template Eigen::SparseMatrix<double> stiffness<3>(const ElasticModel<3>&, const Lattice<3>&,
                                                  const Vectors<3>&);
template Vectors<2> equilibrium<2>(const ElasticModel<2>&, const Lattice<2>&, const Constraints<2>&,
                                   const Vectors<2>&);
template Vectors<3> equilibrium<3>(const ElasticModel<3>&, const Lattice<3>&, const Constraints<3>&,
                                   const Vectors<3>&);
template std::vector<double> natural_frequencies<2>(const ElasticModel<2>&, const Lattice<2>&,
                                                    const Constraints<2>&, const Eigen::VectorXd&, double,
                                                    int);
template std::vector<double> natural_frequencies<3>(const ElasticModel<3>&, const Lattice<3>&,
                                                    const Constraints<3>&, const Eigen::VectorXd&, double,
                                                    int);

}  // namespace strake::structure
