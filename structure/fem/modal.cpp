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
  Inverse(const LinearSolver& solver, const RankDivision& division, Index size, double tolerance)
      : solver_(solver), division_(division), size_(size), tolerance_(tolerance) {}
  Index rows() const { return size_; }
  Index cols() const { return size_; }
  void set_shift(double) {}
  void perform_op(const double* x, double* y) const {
    Eigen::Map<Eigen::VectorXd>(y, size_) =
        division_.whole(solver_.solve(division_.part(Vector(x, size_)), tolerance_));
  }

 private:
  const LinearSolver& solver_;
  const RankDivision& division_;
  Index size_;
  double tolerance_;
};

/// M between the free unknowns, for vectors that are zero in the others.
class Mass {
 public:
  using Scalar = double;
  Mass(const Matrix& mass, const std::vector<int>& fixed, const RankDivision& division)
      : mass_(mass), fixed_(fixed), division_(division) {}
  Index rows() const { return division_.size(mass_.rows()); }
  Index cols() const { return rows(); }
  void perform_op(const double* x, double* y) const {
    Eigen::VectorXd product = mass_ * division_.part(Vector(x, rows()));
    for (const int i : fixed_) product(i) = 0;
    Eigen::Map<Eigen::VectorXd>(y, rows()) = division_.whole(product);
  }

 private:
  const Matrix& mass_;
  const std::vector<int>& fixed_;
  const RankDivision& division_;
};

/// A start that has a share of every mode, the same on every machine: the golden ratio's multiples.
Eigen::VectorXd start(Index size, const std::vector<int>& fixed, const RankDivision& division) {
  Eigen::VectorXd x(size);
  double fraction = 0;
  for (Index i = 0; i < size; ++i) {
    fraction = std::fmod(fraction + std::numbers::phi, 1.0);
    x(i) = fraction - 0.5;
  }
  Eigen::VectorXd part = division.part(x);
  for (const int i : fixed) part(i) = 0;
  return division.whole(part);
}

}  // namespace

std::vector<double> natural_frequencies(const Matrix& stiffness, const Matrix& mass,
                                        const std::vector<int>& fixed, const RankDivision& division,
                                        int count, double slowness, LinearSolver solver, double tolerance) {
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
  Mass product(mass, fixed, division);
  Inverse inverse(solver, division, product.rows(), 0.1 * tolerance);
  const auto held = std::count_if(fixed.begin(), fixed.end(), [&](int i) { return division.owns(i); });
  const int free =
      static_cast<int>(product.rows()) - static_cast<int>(division.sum(static_cast<double>(held)));
  const int wanted = std::min(count, free - 1);
  Spectra::SymGEigsShiftSolver<Inverse, Mass, Spectra::GEigsMode::ShiftInvert> eigen(
      inverse, product, wanted, std::min(free, std::max(2 * wanted + 1, 20)), shift);
  const Eigen::VectorXd first = start(product.rows(), fixed, division);
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
