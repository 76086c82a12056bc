#pragma once

#include "fluid/particles/state.hpp"

#include <cstdint>
#include <random>
#include <vector>

namespace strake::fluid {

/// A block of side^dim particles with the given spacing around the origin. Each is moved at random by up to
/// `disorder` spacings per axis. The same arguments give the same block.
template <int dim>
Vectors<dim> block(int side, double spacing, double disorder = 0, unsigned seed = 7) {
  std::int64_t n = 1;
  for (int d = 0; d < dim; ++d) n *= side;
  Vectors<dim> position(dim, n);
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> shift(-disorder, disorder);
  for (std::int64_t i = 0; i < n; ++i) {
    std::int64_t rest = i;
    for (int d = 0; d < dim; ++d) {
      const double place = static_cast<double>(rest % side) - 0.5 * (side - 1);
      rest /= side;
      position(d, i) = spacing * (place + (disorder > 0 ? shift(generator) : 0.0));
    }
  }
  return position;
}

/// Particles of `block` at least `margin` spacings inside its faces.
template <int dim>
std::vector<std::int64_t> interior(int side, int margin) {
  std::vector<std::int64_t> inside;
  std::int64_t n = 1;
  for (int d = 0; d < dim; ++d) n *= side;
  for (std::int64_t i = 0; i < n; ++i) {
    std::int64_t rest = i;
    bool within = true;
    for (int d = 0; d < dim; ++d) {
      const auto place = rest % side;
      rest /= side;
      within = within && place >= margin && place < side - margin;
    }
    if (within) inside.push_back(i);
  }
  return inside;
}

}  // namespace strake::fluid
