#include "structure/fem/modal.hpp"

#include "proto/error.hpp"

#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace strake::structure::fem {
namespace {

using Eigen::Index;
using Vector = Eigen::Map<const Eigen::VectorXd>;

/// (K − σM)⁻¹ as the eigenvalue solver calls it; σ was given with the factors.
class Inverse {
 public:
  using Scalar = double;
  Inverse(const LinearSolver& solver, Index size, double tolerance)
      : solver_(solver), size_(size), tolerance_(tolerance) {}
  Index rows() const { return size_; }
  Index cols() const { return size_; }
  void set_shift(double) {}
  void perform_op(const double* x, double* y) const {
    Eigen::Map<Eigen::VectorXd>(y, size_) = solver_.solve(Vector(x, size_), tolerance_);
  }

 private:
  const LinearSolver& solver_;
  Index size_;
  double tolerance_;
};

/// M between the free unknowns, for vectors that are zero in the others.
class Mass {
 public:
  using Scalar = double;
  Mass(const Matrix& mass, const std::vector<int>& fixed) : mass_(mass), fixed_(fixed) {}
  Index rows() const { return mass_.rows(); }
  Index cols() const { return mass_.rows(); }
  void perform_op(const double* x, double* y) const {
    Eigen::Map<Eigen::VectorXd> product(y, mass_.rows());
    product.noalias() = mass_ * Vector(x, mass_.rows());
    for (const int i : fixed_) product(i) = 0;
  }

 private:
  const Matrix& mass_;
  const std::vector<int>& fixed_;
};

/// A start that has a share of every mode, the same on every machine: the golden ratio's multiples.
Eigen::VectorXd start(Index size, const std::vector<int>& fixed) {
  Eigen::VectorXd x(size);
  double fraction = 0;
  for (Index i = 0; i < size; ++i) {
    fraction = std::fmod(fraction + std::numbers::phi, 1.0);
    x(i) = fraction - 0.5;
  }
  for (const int i : fixed) x(i) = 0;
  return x;
}

}  // namespace

std::vector<double> natural_frequencies(const Matrix& stiffness, const Matrix& mass,
                                        const std::vector<int>& fixed, int count, double slowness,
                                        LinearSolver solver, double tolerance) {
  const auto failed = [](const std::string& problem) {
    return Error(ExitCode::solver_fault, "structure (fem), natural frequencies", problem,
                 "ask for fewer frequencies or lower structure.fem.refinement");
  };
  // A small negative shift: K − σM is positive definite even for a body without supports.
  const double shift = -1e-6 / (slowness * slowness);
  Matrix shifted = stiffness;
  shifted.coeffs() -= shift * mass.coeffs();  // one pattern
  if (!solver.factorise(shifted, fixed)) throw failed("the shifted stiffness is singular");

  // An iteration's error must stay below the requested tolerance of the eigenvalues.
  Inverse inverse(solver, stiffness.rows(), 0.1 * tolerance);
  Mass product(mass, fixed);
  const auto free = static_cast<int>(stiffness.rows()) - static_cast<int>(fixed.size());
  const int wanted = std::min(count, free - 1);
  Spectra::SymGEigsShiftSolver<Inverse, Mass, Spectra::GEigsMode::ShiftInvert> eigen(
      inverse, product, wanted, std::min(free, std::max(2 * wanted + 1, 20)), shift);
  const Eigen::VectorXd first = start(stiffness.rows(), fixed);
  eigen.init(first.data());
  eigen.compute(Spectra::SortRule::LargestMagn, 1000, tolerance);
  if (eigen.info() != Spectra::CompInfo::Successful)
    throw failed("the eigenvalue iteration did not converge");
  std::vector<double> frequencies;
  for (const double eigenvalue : eigen.eigenvalues())
    frequencies.push_back(std::sqrt(std::max(0.0, eigenvalue)) / (2 * std::numbers::pi));
  std::sort(frequencies.begin(), frequencies.end());
  return frequencies;
}

}  // namespace strake::structure::fem
