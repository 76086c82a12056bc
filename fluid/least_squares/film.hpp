#pragma once

#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace strake::fluid {

/// Returns φ of (F69) from B = Σ_water w r⊗r/r² (fluid/THEORY.md, (F33)): 1 where the neighbours of a
/// particle lie nearly on one line (in space: in one plane), 0 where they surround it. Between the ratios
/// `film_begins` and `film_counts` of B's smallest and largest eigenvalue it rises linearly. A lattice's
/// first row at a wall or a free surface has the ratio 0.59 and φ = 0. The scheme uses φ where σ > 0:
/// disorder inside the water is no film.
template <int dim>
double film_share(const Eigen::Matrix<double, dim, dim>& b);

/// A film of another rank with an own neighbour. inverse: 1/|r| [1/m].
struct FilmPair {
  std::int32_t film, other;
  double inverse;
};

/// Water in the far row of a film. weight: w + φ w_L, over r² [1/m²].
struct WidePair {
  std::int32_t other;
  double weight;
};

/// Films, jets and spray (F69), (F70), (F86).
template <int dim>
struct Films {
  using Tensor = Eigen::Matrix<double, dim, dim>;
  Eigen::VectorXf share;                // φ
  std::vector<std::int64_t> particles;  // with φ > 0, in order
  std::vector<WidePair> wide;           // pairs of own films, in order; empty without oblique faces
  std::vector<std::size_t> wide_start;  // in `wide`, of each of `particles`, and the end
  std::vector<Tensor> wide_inverse;     // of Σ weight r⊗r of each of `particles`
  Eigen::VectorXd value;                // scratch: one number of each of these
  std::vector<FilmPair> ghosts;         // scratch of `stop_films`, sorted

  /// Returns ∇u of film i from its wide pairs [1/s] (F86). separation(j): r from i to j [m].
  Tensor wide_gradient(const Eigen::Matrix<double, dim, Eigen::Dynamic>& velocity, std::int64_t i,
                       const auto& separation) const {
    const auto f = static_cast<std::size_t>(std::ranges::lower_bound(particles, i) - particles.begin());
    Tensor sum = Tensor::Zero();
    for (std::size_t e = wide_start[f]; e < wide_start[f + 1]; ++e) {
      const auto [other, weight] = wide[e];
      sum += weight * (velocity.col(other) - velocity.col(i)) * separation(other).transpose();
    }
    return sum * wide_inverse[f];
  }
};

}  // namespace strake::fluid
