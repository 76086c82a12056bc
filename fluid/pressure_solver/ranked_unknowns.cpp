#include "fluid/pressure_solver/ranked_unknowns.hpp"

#include <algorithm>

namespace strake::fluid {

namespace {

/// Numbers the slabs of buckets along an axis that hold one of the listed particles. Empty slabs are left
/// out, but for one.
struct Slabs {
  std::int32_t first = 0;               // bucket of the first slab
  std::vector<std::int32_t> number{0};  // of each bucket from there
  std::int32_t count() const { return number.back() + 1; }
  std::int32_t operator[](std::int32_t bucket) const {
    return number[static_cast<std::size_t>(bucket - first)];
  }
};

Slabs slabs_of(const std::vector<Bucket>& bucket, std::span<const std::int32_t> placed, std::size_t axis) {
  if (placed.empty()) return {};
  const auto at = [&](std::int32_t i) { return bucket[static_cast<std::size_t>(i)][axis]; };
  std::int32_t low = at(placed.front()), high = low;
  for (const std::int32_t i : placed) {
    low = std::min(low, at(i));
    high = std::max(high, at(i));
  }
  Slabs slabs{low, std::vector<std::int32_t>(static_cast<std::size_t>(high - low) + 1, -1)};
  for (const std::int32_t i : placed) slabs.number[static_cast<std::size_t>(at(i) - low)] = 0;
  std::int32_t next = 0;
  bool gap = false;
  for (std::int32_t& number : slabs.number) {
    if (number < 0) {
      gap = true;
      continue;
    }
    if (gap) ++next;
    gap = false;
    number = next++;
  }
  return slabs;
}

}  // namespace

template <int dim>
void RankedUnknowns<dim>::take(const PressureSystem& local, const Subdomain<dim>& subdomain,
                               const Vectors<dim>& position) {
  const auto n = static_cast<std::size_t>(subdomain.local_water());
  communicator = &subdomain.communicator();
  halo = &subdomain.division().near;
  owner = subdomain.division().owner;
  place = subdomain.division().place;
  std::vector<std::uint8_t> has_neighbours(n);
  for (std::size_t i = 0; i < n; ++i) has_neighbours[i] = local.start[i] < local.stop[i] ? 1 : 0;
  halo->update(*communicator, has_neighbours.data());
  in_cells.clear();
  for (std::size_t i = 0; i < n; ++i)
    if (has_neighbours[i]) in_cells.push_back(static_cast<std::int32_t>(i));
  find_cells(subdomain, position);
}

template <int dim>
void RankedUnknowns<dim>::find_cells(const Subdomain<dim>& subdomain, const Vectors<dim>& position) {
  const std::vector<Bucket>& bucket = subdomain.division().bucket;
  const Buckets<dim>& buckets = subdomain.buckets();
  double product = 1;
  for (std::size_t d = 0; d < dim; ++d) {
    const Slabs slabs = slabs_of(bucket, in_cells, d);
    cells[d] = slabs.count();
    product *= cells[d] + 2;
    // Single precision must not lift a place near the upper face into the next cell.
    const double most = 1 - std::max(1e-3, 2.5e-7 * cells[d]);
    const auto axis = static_cast<Eigen::Index>(d);
    at[d].assign(bucket.size(), 0.0F);
#pragma omp parallel for schedule(static)
    for (const std::int32_t i : in_cells) {
      const Bucket& own = bucket[static_cast<std::size_t>(i)];
      const double within = (position(axis, i) - buckets.corner_of(own)[axis]) / buckets.size()[axis];
      at[d][static_cast<std::size_t>(i)] = static_cast<float>(slabs[own[d]] + std::clamp(within, 0.0, most));
    }
  }
  const double most_cells = 64 * static_cast<double>(in_cells.size()) + 1e6;
  has_grid = !communicator->any(!(product < most_cells));
}

template struct RankedUnknowns<2>;
template struct RankedUnknowns<3>;

}  // namespace strake::fluid
