#include "fluid/diagnostics/energy_and_gauges.hpp"
#include "fluid/diagnostics/voids.hpp"
#include "fluid/diagnostics/volume.hpp"
#include "fluid/participant.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

// What is measured of the water of all ranks: its volume, its voids, and what gauges read.

namespace strake::fluid {

/// Returns the numbers of the water particles that have not left the tank, ascending.
template <int dim>
std::vector<std::int64_t> FluidParticipant<dim>::water_of(const State<dim>& state) const {
  std::vector<std::int64_t> numbers;
  for (std::size_t i = 0; i < state.kind.size(); ++i) {
    const auto k = static_cast<std::int64_t>(i);
    if (state.kind[i] == Kind::fluid && !simulation_.is_removed(state, k)) numbers.push_back(k);
  }
  return numbers;
}

/// Returns those of them in this rank's part that it owns.
template <int dim>
std::vector<std::int64_t> FluidParticipant<dim>::own_water() const {
  std::vector<std::int64_t> numbers = water_of(simulation_.state());
  std::erase_if(numbers, [&](std::int64_t i) { return !simulation_.ranks().owns(i); });
  return numbers;
}

/// Returns the volume of the water. Each rank counts the cells in its own buckets; their number is that of
/// one rank.
template <int dim>
double FluidParticipant<dim>::volume() const {
  const State<dim>& state = simulation_.state();
  const std::vector<std::int64_t> numbers = water_of(state);
  Vectors<dim> particles(dim, static_cast<Eigen::Index>(numbers.size()));
  for (Eigen::Index k = 0; k < particles.cols(); ++k)
    particles.col(k) = state.position.col(numbers[static_cast<std::size_t>(k)]);
  const Subdomain<dim>* const own = simulation_.ranks().subdomain();
  if (own == nullptr) return water_volume<dim>(particles, parameters_.spacing);
  VolumePart<dim> part;
  for (int d = 0; d < dim; ++d) {
    constexpr double far = std::numeric_limits<double>::infinity();
    part.low[d] = -own->communicator().max(particles.cols() > 0 ? -particles.row(d).minCoeff() : -far);
  }
  part.counts = [&](const Vector<dim>& first, const Vector<dim>& last) { return own->has_all(first, last); };
  const std::int64_t cells = water_cells<dim>(particles, parameters_.spacing, part);
  const bool too_many = own->communicator().any(cells < 0);
  return volume_of_cells<dim>(too_many ? -1 : own->communicator().sum(cells), parameters_.spacing);
}

/// Counts the voids, on several ranks on the first one. It gets what the count needs of all particles.
template <int dim>
void FluidParticipant<dim>::count_voids_now() {
  const State<dim>& state = simulation_.state();
  const Subdomain<dim>* const own = simulation_.ranks().subdomain();
  const auto count = [&](const State<dim>& of) {
    measurements_.add(count_voids<dim>(of, water_of(of), parameters_.spacing, parameters_.open_top));
  };
  if (own == nullptr) return count(state);
  struct Seen {
    double position[3];
    Kind kind;
    std::uint8_t surface, air_connected;
  };
  Bytes bytes;
  for (std::size_t i = 0; i < state.kind.size(); ++i) {
    const auto k = static_cast<std::int64_t>(i);
    if (!own->shows(k) || simulation_.is_removed(state, k)) continue;
    Seen seen{{}, state.kind[i], state.surface[i], state.air_connected[i]};
    for (int d = 0; d < dim; ++d) seen.position[d] = state.position(d, k);
    append(bytes, seen);
  }
  State<dim> all;
  const std::int64_t particles = own->communicator().rank() == 0 ? simulation_.particles() : 0;
  all.position.resize(dim, particles);
  own->communicator().show_first(bytes, [&](std::span<const std::byte> part) {
    for (const std::byte* at = part.data(); at < part.data() + part.size();) {
      const auto seen = take<Seen>(at);
      for (int d = 0; d < dim; ++d) all.position(d, std::ssize(all.kind)) = seen.position[d];
      all.kind.push_back(seen.kind);
      all.surface.push_back(seen.surface);
      all.air_connected.push_back(seen.air_connected);
    }
  });
  if (is_first_rank()) count(all);
}

/// Returns the places of the water that gauges may read, in the order of the whole, on the first of several
/// ranks. So their sums are those of one rank.
template <int dim>
Vectors<dim> FluidParticipant<dim>::water_at_gauges() const {
  struct Read {
    std::int64_t place;
    double position[3];
  };
  const State<dim>& state = simulation_.state();
  const Subdomain<dim>& own = *simulation_.ranks().subdomain();
  Bytes bytes;
  for (const std::int64_t i : own_water()) {
    const Vector<dim> x = state.position.col(i);
    const auto reads = [&](const ProbeKeys& probe) {
      const Vector<dim> from_gauge = x - probe.at.template head<dim>();
      return reads_water(probe) && gauge_reads<dim>(probe.quantity, from_gauge, parameters_.spacing);
    };
    if (std::none_of(parameters_.probes.begin(), parameters_.probes.end(), reads)) continue;
    Read read{own.division().place[static_cast<std::size_t>(i)], {}};
    for (int d = 0; d < dim; ++d) read.position[d] = x[d];
    append(bytes, read);
  }
  std::vector<Read> all;
  own.communicator().show_first(bytes, [&](std::span<const std::byte> part) {
    for (const std::byte* at = part.data(); at < part.data() + part.size();) all.push_back(take<Read>(at));
  });
  std::ranges::sort(all, {}, &Read::place);
  Vectors<dim> position(dim, std::ssize(all));
  for (std::size_t k = 0; k < all.size(); ++k)
    for (int d = 0; d < dim; ++d) position(d, static_cast<Eigen::Index>(k)) = all[k].position[d];
  return position;
}

#define STRAKE_INSTANTIATE(dim)                                                                \
  template std::vector<std::int64_t> FluidParticipant<dim>::water_of(const State<dim>&) const; \
  template std::vector<std::int64_t> FluidParticipant<dim>::own_water() const;                 \
  template double FluidParticipant<dim>::volume() const;                                       \
  template void FluidParticipant<dim>::count_voids_now();                                      \
  template Vectors<dim> FluidParticipant<dim>::water_at_gauges() const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
