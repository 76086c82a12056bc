#include "structure/fem/modal.hpp"

#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/MatOp/SymShiftInvert.h>
#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "proto/error.hpp"

namespace strake::structure::fem {
namespace {

using ColumnMatrix = Eigen::SparseMatrix<double>;

ColumnMatrix free_part(const Matrix& matrix, const std::vector<int>& number) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Matrix::InnerIterator entry(matrix, i); entry; ++entry) {
      const int row = number[static_cast<std::size_t>(i)],
                column = number[static_cast<std::size_t>(entry.col())];
      if (row >= 0 && column >= 0) entries.emplace_back(row, column, entry.value());
    }
  const auto n =
      static_cast<Eigen::Index>(std::count_if(number.begin(), number.end(), [](int i) { return i >= 0; }));
  ColumnMatrix part(n, n);
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

}  // namespace

std::vector<double> natural_frequencies(const Matrix& stiffness, const Matrix& mass,
                                        const std::vector<int>& fixed, int count, double slowness) {
  std::vector<int> number(static_cast<std::size_t>(stiffness.rows()), 0);
  for (const int i : fixed) number[static_cast<std::size_t>(i)] = -1;
  int next = 0;
  for (int& i : number)
    if (i == 0) i = next++;
  const ColumnMatrix K = free_part(stiffness, number), M = free_part(mass, number);

  // A small negative shift: K − σM is positive definite even for a body without supports.
  const double shift = -1e-6 / (slowness * slowness);
  using Inverse = Spectra::SymShiftInvert<double, Eigen::Sparse, Eigen::Sparse>;
  using Product = Spectra::SparseSymMatProd<double>;
  Inverse inverse(K, M);
  Product product(M);
  const int wanted = std::min(count, next - 1);
  Spectra::SymGEigsShiftSolver<Inverse, Product, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, product, wanted, std::min(next, std::max(2 * wanted + 1, 20)), shift);
  solver.init();
  solver.compute(Spectra::SortRule::LargestMagn, 1000, 1e-12);
  if (solver.info() != Spectra::CompInfo::Successful)
    throw Error(ExitCode::solver_fault, "structure (fem), natural frequencies",
                "the eigenvalue iteration did not converge",
                "ask for fewer frequencies or lower structure.fem.refinement");
  std::vector<double> frequencies;
  for (const double eigenvalue : solver.eigenvalues())
    frequencies.push_back(std::sqrt(std::max(0.0, eigenvalue)) / (2 * std::numbers::pi));
  std::sort(frequencies.begin(), frequencies.end());
  return frequencies;
}

}  // namespace strake::structure::fem
