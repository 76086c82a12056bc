#include "fluid/particles/reorder.hpp"

#include "fluid/particles/columns.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>

namespace strake::fluid {
namespace {

using std::size_t;

/// Largest number of cells along each direction; places beyond belong to the last cell.
constexpr double most_cells = 1 << 20;

/// Interleaves the bits of the places along each direction.
template <int dim>
std::uint64_t interleaved(const std::array<std::uint32_t, dim>& place) {
  std::uint64_t key = 0;
  for (int bit = 0; bit < 21; ++bit)
    for (size_t d = 0; d < dim; ++d)
      key |= std::uint64_t{place[d] >> bit & 1U} << (dim * bit + static_cast<int>(d));
  return key;
}

/// Sorts by key, equal keys in their old order: digit after digit, the lowest first.
void sort_by_key(std::vector<std::uint64_t>& key, std::vector<std::int32_t>& order) {
  constexpr int digit = 11;
  std::uint64_t largest = 0;
  for (const auto k : key) largest = std::max(largest, k);
  std::vector<std::uint64_t> next_key(key.size());
  std::vector<std::int32_t> next_order(order.size());
  for (int shift = 0; largest >> shift; shift += digit) {
    std::vector<size_t> place((1U << digit) + 1);
    const auto slot = [&](std::uint64_t k) { return static_cast<size_t>(k >> shift & ((1U << digit) - 1)); };
    for (const auto k : key) ++place[slot(k) + 1];
    for (size_t d = 1; d < place.size(); ++d) place[d] += place[d - 1];
    for (size_t i = 0; i < key.size(); ++i) {
      const size_t to = place[slot(key[i])]++;
      next_key[to] = key[i];
      next_order[to] = order[i];
    }
    key.swap(next_key);
    order.swap(next_order);
    if (shift + digit >= 64) break;
  }
}

}  // namespace

template <int dim>
std::vector<std::uint64_t> cells_along_curve(const Eigen::Ref<const Vectors<dim>>& position,
                                             const Vector<dim>& low, double size) {
  const auto n = position.cols();
  std::vector<std::uint64_t> key(static_cast<size_t>(n));
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < n; ++i) {
    std::array<std::uint32_t, dim> place{};
    for (int d = 0; d < dim; ++d) {
      const double at = (position(d, i) - low[d]) / size;  // not a number goes to the first cell
      place[static_cast<size_t>(d)] = at > 0 ? static_cast<std::uint32_t>(std::min(at, most_cells - 1)) : 0U;
    }
    key[static_cast<size_t>(i)] = interleaved<dim>(place);
  }
  return key;
}

template <int dim>
std::vector<std::int32_t> cell_order(const Eigen::Ref<const Vectors<dim>>& position, double size) {
  Vector<dim> low = Vector<dim>::Zero();
  if (position.cols() > 0) low = position.rowwise().minCoeff();
  std::vector<std::uint64_t> key = cells_along_curve<dim>(position, low, size);
  std::vector<std::int32_t> order(key.size());
  std::iota(order.begin(), order.end(), 0);
  sort_by_key(key, order);
  return order;
}

template <int dim>
void reorder(State<dim>& state, std::span<const std::int32_t> order) {
  assert(static_cast<Eigen::Index>(order.size()) <= state.position.cols());
  std::vector<std::int32_t> places(static_cast<size_t>(state.position.cols()));
  std::iota(places.begin(), places.end(), 0);
  std::copy(order.begin(), order.end(), places.begin());
  select_particles<dim>(state, places);
}

template std::vector<std::uint64_t> cells_along_curve<2>(const Eigen::Ref<const Vectors<2>>&,
                                                         const Vector<2>&, double);
template std::vector<std::uint64_t> cells_along_curve<3>(const Eigen::Ref<const Vectors<3>>&,
                                                         const Vector<3>&, double);
template std::vector<std::int32_t> cell_order<2>(const Eigen::Ref<const Vectors<2>>&, double);
template std::vector<std::int32_t> cell_order<3>(const Eigen::Ref<const Vectors<3>>&, double);
template void reorder<2>(State<2>&, std::span<const std::int32_t>);
template void reorder<3>(State<3>&, std::span<const std::int32_t>);

}  // namespace strake::fluid
