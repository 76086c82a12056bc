#include "fluid/particles/columns.hpp"

#include <algorithm>

namespace strake::fluid {
namespace {

template <class T>
void resize(std::vector<T>& column, Eigen::Index count) {
  column.resize(static_cast<std::size_t>(count));
}

template <int rows, int columns>
void resize(Eigen::Matrix<double, rows, columns>& column, Eigen::Index count) {
  const Eigen::Index more = std::max<Eigen::Index>(0, count - length(column));
  if constexpr (columns == 1) {
    column.conservativeResize(count);
    column.tail(more).setZero();
  } else {
    column.conservativeResize(Eigen::NoChange, count);
    column.rightCols(more).setZero();
  }
}

template <class T>
void select(std::vector<T>& column, std::span<const std::int32_t> places) {
  std::vector<T> selected;
  selected.reserve(places.size());
  for (const auto place : places) selected.push_back(column[static_cast<std::size_t>(place)]);
  column = std::move(selected);
}

template <int rows, int columns>
void select(Eigen::Matrix<double, rows, columns>& column, std::span<const std::int32_t> places) {
  if constexpr (columns == 1)
    column = column(places).eval();
  else
    column = column(Eigen::all, places).eval();
}

}  // namespace

template <int dim>
void resize_particles(State<dim>& state, Eigen::Index count) {
  for_each_column([&](const char*, auto& column) { resize(column, count); }, state);
}

template <int dim>
void select_particles(State<dim>& state, std::span<const std::int32_t> places) {
  for_each_column([&](const char*, auto& column) { select(column, places); }, state);
}

template void resize_particles<2>(State<2>&, Eigen::Index);
template void resize_particles<3>(State<3>&, Eigen::Index);
template void select_particles<2>(State<2>&, std::span<const std::int32_t>);
template void select_particles<3>(State<3>&, std::span<const std::int32_t>);

}  // namespace strake::fluid
