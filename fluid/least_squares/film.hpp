#pragma once

#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace strake::fluid {

/// Returns φ of (F69) from B = Σ_water w r⊗r/r² (fluid/THEORY.md, (F33)): 1 where the neighbours of a
/// particle lie nearly on one line (in space: in one plane), 0 where they surround it. Between the ratios
/// `film_begins` and `film_counts` of B's smallest and largest eigenvalue it rises linearly. A lattice's
/// first row at a wall or a free surface has the ratio 0.59 and φ = 0. The scheme uses φ where σ > 0: disorder
/// inside the water is no film.
template <int dim>
double film_share(const Eigen::Matrix<double, dim, dim>& b);

/// A film of another rank with an own neighbour. inverse: 1/|r| [1/m].
struct FilmPair {
  std::int32_t film, other;
  double inverse;
};

/// Films, jets and spray (F69), (F70).
struct Films {
  Eigen::VectorXf share;                // φ
  std::vector<std::int64_t> particles;  // with φ > 0, in order
  Eigen::VectorXd value;                // scratch: one number of each of these
  std::vector<FilmPair> ghosts;         // scratch of `stop_films`, sorted
};

}  // namespace strake::fluid
