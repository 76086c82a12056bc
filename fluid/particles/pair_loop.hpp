#pragma once

#include "fluid/particles/periodic.hpp"
#include "fluid/particles/simd.hpp"
#include "fluid/particles/simd_neighbours.hpp"
#include "fluid/particles/state.hpp"

#include <algorithm>
#include <cstdint>
#include <span>

namespace strake::fluid {

/// Counts the water in a row's sorted columns.
inline std::size_t water_pairs(std::span<const std::int32_t> columns, std::int64_t water) {
  std::size_t n = columns.size();
  while (n > 0 && columns[n - 1] >= water) --n;
  return n;
}

/// Replaces r by that of the neighbour's nearest image, over the seams where that is shorter.
template <int dim, class Pair>
inline void over_seams(const Periodic<dim>& periodic, Pair& r) {
  for (int d = 0; d < dim; ++d) r[d] = periodic.nearest(r[d], d);
}

/// r of eight pairs, and 1 where there is a pair; lanes without one are zero in both.
template <int dim>
struct EightPairs {
  Double8 r[dim], one;
};

/// The pairs e … e + 7 of row i.
template <bool seams, int dim>
[[gnu::always_inline]] inline EightPairs<dim> eight_pairs(const State<dim>& state,
                                                          const Periodic<dim>& periodic, std::int64_t i,
                                                          std::span<const std::int32_t> columns,
                                                          std::size_t e) {
  const double* const place = state.position.data();
  const int n = static_cast<int>(std::min<std::size_t>(simd::width, columns.size() - e));
  EightPairs<dim> pairs;
  simd::gather<dim>(place, columns.data() + e, n, static_cast<std::int32_t>(i), pairs.r);
  for (int d = 0; d < dim; ++d) {
    pairs.r[d] -= all8(place[dim * i + d]);
    if constexpr (seams) {
      const Double8 half = all8(periodic.half(d)), length = all8(periodic.length()[d]);
      pairs.r[d] += (pairs.r[d] < -half ? length : Double8{}) - (pairs.r[d] > half ? length : Double8{});
    }
  }
  pairs.one = Double8{0, 1, 2, 3, 4, 5, 6, 7} < all8(n) ? all8(1) : Double8{};
  return pairs;
}

}  // namespace strake::fluid
