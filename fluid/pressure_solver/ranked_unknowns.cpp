#include "fluid/pressure_solver/ranked_unknowns.hpp"

#include <algorithm>

namespace strake::fluid {

/// Numbers the unknowns: own ones, copies of the first ring, copies of the second, each in the local order.
template <int dim>
void RankedUnknowns<dim>::number(const PressureSystem& local, const Subdomain<dim>& subdomain) {
  const std::int64_t water = subdomain.local_water();
  constexpr std::uint8_t first_ring = 1, second_ring = 2;
  std::vector<std::uint8_t> ring(static_cast<std::size_t>(water), second_ring);
  for (std::int64_t i = 0; i < water; ++i)
    if (subdomain.owns(i)) ring[static_cast<std::size_t>(i)] = 0;
  for (const auto& list : subdomain.near_halo().receive)
    for (const std::int32_t i : list) ring[static_cast<std::size_t>(i)] = first_ring;
  unknown_of_.assign(static_cast<std::size_t>(water), -1);
  particle.clear();
  owner.clear();
  for (std::uint8_t of = 0; of <= second_ring; ++of) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      if (ring[i] != of || (of < second_ring && local.start[i] == local.stop[i])) continue;
      unknown_of_[i] = static_cast<std::int32_t>(particle.size());
      particle.push_back(static_cast<std::int32_t>(i));
      owner.push_back(subdomain.owners()[i]);
    }
    (of == 0 ? own : of == first_ring ? near : all) = std::ssize(particle);
  }
}

template <int dim>
void RankedUnknowns<dim>::list_halo(const Subdomain<dim>& subdomain) {
  const Halo& particles = subdomain.near_halo();
  halo.clear(communicator->size());
  const auto translate = [&](const auto& from, auto& to) {
    for (std::size_t r = 0; r < from.size(); ++r)
      for (const std::int32_t i : from[r])
        if (const std::int32_t k = unknown_of_[static_cast<std::size_t>(i)]; k >= 0) to[r].push_back(k);
  };
  translate(particles.send, halo.send);
  translate(particles.receive, halo.receive);
}

template <int dim>
void RankedUnknowns<dim>::find_cells(const Subdomain<dim>& subdomain, const Vectors<dim>& position) {
  double product = 1;
  for (std::size_t d = 0; d < dim; ++d) {
    std::vector<std::int32_t> slabs;
    for (const std::int32_t i : particle) {
      const std::int32_t slab = subdomain.buckets()[static_cast<std::size_t>(i)][d];
      if (slabs.empty() || slabs.back() != slab) slabs.push_back(slab);
    }
    std::ranges::sort(slabs);
    slabs.erase(std::unique(slabs.begin(), slabs.end()), slabs.end());
    std::vector<std::int32_t> cell(slabs.size(), 0);
    for (std::size_t s = 1; s < slabs.size(); ++s)
      cell[s] = cell[s - 1] + (slabs[s] - slabs[s - 1] == 1 ? 1 : 2);
    cells[d] = cell.empty() ? 1 : cell.back() + 1;
    product *= cells[d] + 2;
    // Single precision must not lift a place near the upper face into the next cell.
    const double most = 1 - std::max(1e-3, 2.5e-7 * cells[d]),
                 size = subdomain.bucket_size()[static_cast<int>(d)];
    at[d].resize(particle.size());
    for (std::size_t k = 0; k < particle.size(); ++k) {
      const std::int32_t i = particle[k];
      const Bucket& bucket = subdomain.buckets()[static_cast<std::size_t>(i)];
      const auto s = static_cast<std::size_t>(std::ranges::lower_bound(slabs, bucket[d]) - slabs.begin());
      const double within =
          (position(static_cast<Eigen::Index>(d), i) - subdomain.corner_of(bucket)[static_cast<int>(d)]) /
          size;
      at[d][k] = static_cast<float>(cell[s] + std::clamp(within, 0.0, most));
    }
  }
  const double most_cells = 64 * static_cast<double>(all) + 1e6;
  has_grid = !communicator->any(!(product < most_cells));
}

template <int dim>
void RankedUnknowns<dim>::take(const PressureSystem& local, const Subdomain<dim>& subdomain,
                               const Vectors<dim>& position, PressureSystem& system) {
  communicator = &subdomain.communicator();
  number(local, subdomain);
  list_halo(subdomain);
  find_cells(subdomain, position);
  system.particle.assign(particle.begin(), particle.begin() + own);
  const auto unknowns = static_cast<std::size_t>(all);
  auto& rows = system.own;
  rows.start.assign(unknowns, 0);
  rows.stop.assign(unknowns, 0);
  rows.column.resize(local.column.size());
  system.diagonal.resize(near);
  system.right.resize(own);
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < near; ++k) {
    const auto row = static_cast<std::size_t>(k);
    const auto i = static_cast<std::size_t>(particle[row]);
    rows.start[row] = local.start[i];
    rows.stop[row] = local.stop[i];
    for (std::int64_t e = local.start[i]; e < local.stop[i]; ++e)
      rows.column.data()[e] = unknown_of_.data()[local.column.data()[e]];
    system.diagonal[k] = local.diagonal[static_cast<Eigen::Index>(i)];
    if (k < own) system.right[k] = local.right[static_cast<Eigen::Index>(i)];
  }
  system.start = rows.start;
  system.stop = rows.stop;
  system.column = rows.column;
  system.value = local.value;
}

template struct RankedUnknowns<2>;
template struct RankedUnknowns<3>;

}  // namespace strake::fluid
