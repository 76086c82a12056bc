#pragma once

#include "fluid/periodic.hpp"
#include "fluid/state.hpp"

#include <algorithm>
#include <cstdint>
#include <span>

namespace strake::fluid {

/// How many of a row's sorted columns are water.
inline std::size_t water_pairs(std::span<const std::int32_t> columns, std::int64_t water) {
  std::size_t n = columns.size();
  while (n > 0 && columns[n - 1] >= water) --n;
  return n;
}

/// body(e, r): for each column of a row its number in the row and r = x_j − x over the seams.
template <bool seams, int dim, class Body>
inline void for_pairs(const State<dim>& state, const Periodic<dim>& periodic, const Vector<dim>& x,
                      std::span<const std::int32_t> columns, Body&& body) {
  const double* const place = state.position.data();
  for (std::size_t e = 0; e < columns.size(); ++e) {
    const double* const other = place + dim * static_cast<std::ptrdiff_t>(columns[e]);
    Vector<dim> r;
    for (int d = 0; d < dim; ++d) r[d] = other[d] - x[d];
    if constexpr (seams)
      for (int d = 0; d < dim; ++d) r[d] = periodic.nearest(r[d], d);
    body(e, r);
  }
}

}  // namespace strake::fluid
