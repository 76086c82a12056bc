#pragma once

#include "fluid/least_squares/scheme.hpp"

namespace strake::fluid {

template <int dim>
template <class Visit>
void LeastSquaresScheme<dim>::for_each_image(std::int64_t i, const Visit& visit) const {
  const auto own = static_cast<std::size_t>(i);
  if (!images_.any || images_.count[own] == 0 || !ranks_.owns(i)) return;
  for (std::int64_t e = images_.first[own]; e < images_.last[own]; ++e) {
    const auto& pair = images_.pairs[static_cast<std::size_t>(e)];
    const double here = images_.faces[own][pair.own].normal_velocity,
                 there = images_.faces[static_cast<std::size_t>(pair.other)][pair.theirs].normal_velocity;
    visit(pair.entry, pair.w, pair.r, pair.n, 0.5 * (here + there));
  }
}

}  // namespace strake::fluid
