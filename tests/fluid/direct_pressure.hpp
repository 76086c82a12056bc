#pragma once

#include "fluid/mps/pressure_equation.hpp"
#include "tests/algebra/factors.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace strake::fluid {

/// The solution of the pressure equation by its factors.
inline Eigen::VectorXd direct_pressure(const PressureSystem& system) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::int64_t k = 0; k < system.size(); ++k) {
    const auto row = static_cast<std::size_t>(k);
    entries.emplace_back(static_cast<int>(k), static_cast<int>(k), system.diagonal[k]);
    for (std::int64_t e = system.start[row]; e < system.stop[row]; ++e)
      entries.emplace_back(static_cast<int>(k), system.column[static_cast<std::size_t>(e)],
                           system.value[static_cast<std::size_t>(e)]);
  }
  Eigen::SparseMatrix<double> matrix(system.size(), system.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  SparseFactors factors;
  EXPECT_TRUE(factors.compute(matrix));
  return factors.solve(system.right);
}

}  // namespace strake::fluid
