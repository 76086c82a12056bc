#include "fluid/pressure_solver/ranked_unknowns.hpp"

#include <algorithm>
#include <numeric>

namespace strake::fluid {

template <int dim>
void RankedUnknowns<dim>::take(const PressureSystem& local, const Subdomain<dim>& subdomain,
                               const Vectors<dim>& position, PressureSystem& own, PressureSystem& grid) {
  const std::int64_t water = subdomain.local_water();
  const auto n = static_cast<std::size_t>(water);
  communicator = &subdomain.communicator();
  halo = &subdomain.division().near;
  owner = subdomain.division().owner;
  std::vector<std::uint8_t> near(n);
  for (std::size_t i = 0; i < n; ++i) near[i] = subdomain.owns(static_cast<std::int64_t>(i)) ? 1 : 0;
  for (const auto& list : halo->receive)
    for (const std::int32_t i : list) near[static_cast<std::size_t>(i)] = 1;

  for (PressureSystem* system : {&own, &grid}) {
    if (system->size() != water) {
      system->particle.resize(n);
      std::iota(system->particle.begin(), system->particle.end(), 0);
    }
    system->start = local.start;
    system->column = local.column;
    system->value = local.value;
    system->own.stop.resize(n);
    system->stop = system->own.stop;
  }
  grid.diagonal = local.diagonal;
  own.diagonal.resize(water);
  own.right.resize(water);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const bool is_own = subdomain.owns(k);
    own.own.stop[i] = is_own ? local.stop[i] : local.start[i];
    grid.own.stop[i] = near[i] ? local.stop[i] : local.start[i];
    own.diagonal[k] = is_own ? local.diagonal[k] : 0;
    own.right[k] = is_own ? local.right[k] : 0;
  }
  std::vector<std::int32_t> placed;
  in_cells.clear();
  for (std::size_t i = 0; i < n; ++i) {
    if (local.start[i] == local.stop[i]) continue;
    placed.push_back(static_cast<std::int32_t>(i));
    if (near[i]) in_cells.push_back(static_cast<std::int32_t>(i));
  }
  find_cells(subdomain, position, placed);
}

template <int dim>
void RankedUnknowns<dim>::find_cells(const Subdomain<dim>& subdomain, const Vectors<dim>& position,
                                     std::span<const std::int32_t> placed) {
  const std::vector<Bucket>& bucket = subdomain.division().bucket;
  const Buckets<dim>& buckets = subdomain.buckets();
  double product = 1;
  for (std::size_t d = 0; d < dim; ++d) {
    std::vector<std::int32_t> slabs;
    for (const std::int32_t i : placed)
      if (const std::int32_t slab = bucket[static_cast<std::size_t>(i)][d];
          slabs.empty() || slabs.back() != slab)
        slabs.push_back(slab);
    std::ranges::sort(slabs);
    slabs.erase(std::unique(slabs.begin(), slabs.end()), slabs.end());
    std::vector<std::int32_t> cell(slabs.size(), 0);
    for (std::size_t s = 1; s < slabs.size(); ++s)
      cell[s] = cell[s - 1] + (slabs[s] - slabs[s - 1] == 1 ? 1 : 2);
    cells[d] = cell.empty() ? 1 : cell.back() + 1;
    product *= cells[d] + 2;
    // Single precision must not lift a place near the upper face into the next cell.
    const double most = 1 - std::max(1e-3, 2.5e-7 * cells[d]);
    const auto axis = static_cast<Eigen::Index>(d);
    at[d].assign(bucket.size(), 0.0F);
#pragma omp parallel for schedule(static)
    for (const std::int32_t i : placed) {
      const Bucket& own = bucket[static_cast<std::size_t>(i)];
      const auto s = static_cast<std::size_t>(std::ranges::lower_bound(slabs, own[d]) - slabs.begin());
      const double within = (position(axis, i) - buckets.corner_of(own)[axis]) / buckets.size()[axis];
      at[d][static_cast<std::size_t>(i)] = static_cast<float>(cell[s] + std::clamp(within, 0.0, most));
    }
  }
  const double most_cells = 64 * static_cast<double>(placed.size()) + 1e6;
  has_grid = !communicator->any(!(product < most_cells));
}

template struct RankedUnknowns<2>;
template struct RankedUnknowns<3>;

}  // namespace strake::fluid
