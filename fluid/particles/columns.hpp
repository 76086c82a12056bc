#pragma once

#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// Returns the number of particles in a column of State.
template <class T>
Eigen::Index length(const std::vector<T>& column) {
  return std::ssize(column);
}
template <int rows, int columns>
Eigen::Index length(const Eigen::Matrix<double, rows, columns>& column) {
  return columns == 1 ? column.rows() : column.cols();
}

/// Gives every column of the state `count` particles; entries that are new are zero.
template <int dim>
void resize_particles(State<dim>&, Eigen::Index count);

/// Keeps the particles at these places of every column, in this order.
template <int dim>
void select_particles(State<dim>&, std::span<const std::int32_t> places);

}  // namespace strake::fluid
