#include "structure/fem/modal.hpp"

#include "proto/error.hpp"

#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

namespace strake::structure::fem {
namespace {

using Eigen::Index;
/// A symmetric operator between the unknowns of the whole body, as the eigenvalue solver calls it. Each rank
/// computes its part of the product.
struct Operator {
  using Scalar = double;
  const RankDivision& division;
  Index size;
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> times;
  Index rows() const { return size; }
  Index cols() const { return size; }
  void set_shift(double) {}
  void perform_op(const double* x, double* y) const {
    const Eigen::Map<const Eigen::VectorXd> whole(x, size);
    Eigen::Map<Eigen::VectorXd>(y, size) = division.whole(times(division.part(whole)));
  }
};

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

  // (K − σM)⁻¹ with σ of the factors; an iteration's error must stay below the tolerance of the eigenvalues.
  const Index size = division.size(mass.rows());
  Operator inverse{division, size, [&](const auto& x) { return solver.solve(x, 0.1 * tolerance); }};
  // M between the free unknowns, for vectors that are zero in the others, as those are that `inverse` gives.
  Operator product{division, size, [&](const auto& x) {
                     Eigen::VectorXd Mx = mass * x;
                     for (const int i : fixed) Mx(i) = 0;
                     return Mx;
                   }};
  const auto held = std::count_if(fixed.begin(), fixed.end(), [&](int i) { return division.owns(i); });
  const int free = static_cast<int>(size) - static_cast<int>(division.sum(static_cast<double>(held)));
  const int wanted = std::min(count, free - 1);
  Spectra::SymGEigsShiftSolver<Operator, Operator, Spectra::GEigsMode::ShiftInvert> eigen(
      inverse, product, wanted, std::min(free, std::max(2 * wanted + 1, 20)), shift);
  eigen.init();  // a random start, always the same
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
