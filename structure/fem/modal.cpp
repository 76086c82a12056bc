
#include "proto/error.hpp"
#include "structure/fem/solver.hpp"
#include "structure/material/material.hpp"

#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

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

// The lowest natural frequencies, ascending, of K x = (2πf)² M x between the free unknowns, without the rigid
// motions that the supports leave: they have no frequency. `tolerance`: of the squares, relative.
template <int dim>
std::vector<double> FemSolver<dim>::frequencies(int count, double tolerance) const {
  if (factors_.method != LinearMethod::direct) tolerance = std::max(tolerance, enough_for_a_line);
  const Matrix& mass = matrices_.mass;
  const std::vector<int>& fixed = mesh().fixed;
  const auto failed = [](const std::string& problem) {
    return Error(ExitCode::solver_fault, "structure (fem), natural frequencies", problem,
                 "ask for fewer frequencies or lower structure.fem.refinement");
  };
  // A small negative shift: K − σM is positive definite even for a body without supports.
  // Its size is that of a wave along the body.
  const Eigen::Vector3d extent = solid_.node.rowwise().maxCoeff() - solid_.node.rowwise().minCoeff();
  double fastest = 0;
  for (const Part& part : solid_.parts) fastest = std::max(fastest, wave_speed(part.material));
  const double shift = -1e-6 * std::pow(fastest / extent.maxCoeff(), 2);
  Matrix shifted = matrices_.stiffness;
  shifted.coeffs() -= shift * mass.coeffs();  // one pattern
  LinearSolver solver = linear_solver();
  if (!solver.factorise(shifted, fixed)) throw failed("the shifted stiffness is singular");

  // (K − σM)⁻¹ with σ of the factors; an iteration's error must stay below the tolerance of the eigenvalues.
  const Index size = division().size(mass.rows());
  Operator inverse{division(), size, [&](const auto& x) { return solver.solve(x, 0.1 * tolerance); }};
  // M between the free unknowns, for vectors that are zero in the others, as those are that `inverse` gives.
  Operator product{division(), size, [&](const auto& x) {
                     Eigen::VectorXd Mx = mass * x;
                     for (const int i : fixed) Mx(i) = 0;
                     return Mx;
                   }};
  const auto held = std::count_if(fixed.begin(), fixed.end(), [&](int i) { return division().owns(i); });
  const int free = static_cast<int>(size) - static_cast<int>(division().sum(static_cast<double>(held)));
  const int rigid = rigid_motions_left(mesh()), wanted = std::min(count + rigid, free - 1);
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
  frequencies.erase(frequencies.begin(), frequencies.begin() + std::min(rigid, wanted));
  return frequencies;
}

template std::vector<double> FemSolver<2>::frequencies(int, double) const;
template std::vector<double> FemSolver<3>::frequencies(int, double) const;

}  // namespace strake::structure::fem
