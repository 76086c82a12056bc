#pragma once

#include "fluid/least_squares/constants.hpp"
#include "fluid/mps/operators.hpp"
#include "fluid/particles/state.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>

namespace strake::fluid {

/// Writes the inverse of m without the directions whose eigenvalue is small beside the largest.
template <int dim>
[[gnu::noinline]] void inverse_of_seen_directions(const Tensor<dim>& m, Tensor<dim>& inverse) {
  Eigen::SelfAdjointEigenSolver<Tensor<dim>> eigen;
  eigen.computeDirect(m);
  const double largest = eigen.eigenvalues()[dim - 1];
  const double least_ratio = least_squares_constants().least_ratio;
  Vector<dim> inverses;
  for (int a = 0; a < dim; ++a) {
    const double value = eigen.eigenvalues()[a];
    const double seen = std::clamp((value / largest - least_ratio) / least_ratio, 0.0, 1.0);
    inverses[a] = value > 0 ? seen / value : 0.0;
  }
  inverse.noalias() = eigen.eigenvectors() * inverses.asDiagonal() * eigen.eigenvectors().transpose();
}

/// Writes the inverse of a moment matrix m = Σ w r⊗r/r². Directions in which the neighbours hardly extend are
/// left out, see least_ratio. The entries are written in place, because a copy would stall.
template <int dim>
inline void inverse_where_seen(const Tensor<dim>& m, Tensor<dim>& inverse) {
  const double mean = m.trace() / dim, determinant = m.determinant();
  const LeastSquaresConstants& tuned = least_squares_constants();
  const double even = dim == 2 ? tuned.even_2d : tuned.even_3d;
  if (!(mean > 0)) {
    inverse.setZero();
  } else if (!(determinant > even * mean * mean * (dim == 3 ? mean : 1.0))) {
    inverse_of_seen_directions<dim>(m, inverse);
  } else if constexpr (dim == 2) {
    const double scale = 1 / determinant;
    inverse(0, 0) = scale * m(1, 1);
    inverse(1, 0) = -scale * m(1, 0);
    inverse(0, 1) = -scale * m(0, 1);
    inverse(1, 1) = scale * m(0, 0);
  } else {
    inverse = m.inverse();
  }
}

}  // namespace strake::fluid
