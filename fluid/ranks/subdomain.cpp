#include "fluid/ranks/subdomain.hpp"

#include "fluid/particles/columns.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace strake::fluid {

namespace {

/// Rings of buckets around the own ones whose water a rank has.
constexpr std::int32_t rings = 2;
/// Work of a layer particle beside that of a water particle, for the partition.
constexpr double work_of_layer = 0.3;
/// Largest number of a bucket; places beyond belong to the last.
constexpr double most_buckets = 1 << 28;

template <class Column>
std::byte* first_byte(Column& column) {
  return reinterpret_cast<std::byte*>(column.data());
}

/// Packs the listed entries of a column one behind the other.
void pack(const std::byte* column, std::size_t each, std::span<const std::int32_t> list, Bytes& bytes) {
  bytes.resize(list.size() * each);
  std::byte* to = bytes.data();
  for (const std::int32_t i : list) {
    std::memcpy(to, column + static_cast<std::size_t>(i) * each, each);
    to += each;
  }
}

void unpack(const Bytes& bytes, std::size_t each, std::span<const std::int32_t> list, std::byte* column) {
  const std::byte* from = bytes.data();
  for (const std::int32_t i : list) {
    std::memcpy(column + static_cast<std::size_t>(i) * each, from, each);
    from += each;
  }
}

}  // namespace

template <int dim>
Subdomain<dim>::Subdomain(Communicator& communicator, Partition partition, double reach,
                          const Periodic<dim>& periodic, const Vector<dim>& corner)
    : communicator_(&communicator),
      partition_(std::move(partition)),
      corner_(corner),
      size_(Vector<dim>::Constant(reach)) {
  for (int d = 0; d < dim; ++d) {
    if (!periodic.along(d)) continue;
    auto& count = count_[static_cast<std::size_t>(d)];
    count = std::max(1, static_cast<std::int32_t>(periodic.length()[d] / reach));
    size_[d] = periodic.length()[d] / count;
  }
}

template <int dim>
typename Subdomain<dim>::Bucket Subdomain<dim>::bucket_of(const Vector<dim>& x) const {
  Bucket bucket{};
  for (int d = 0; d < dim; ++d) {
    const auto k = static_cast<std::size_t>(d);
    const double at = std::floor((x[d] - corner_[d]) / size_[d]);
    // Not a number goes to the first bucket.
    bucket[k] = at == at ? static_cast<std::int32_t>(std::clamp(at, -most_buckets, most_buckets)) : 0;
    if (count_[k] > 0) bucket[k] = ((bucket[k] % count_[k]) + count_[k]) % count_[k];
  }
  return bucket;
}

template <int dim>
void Subdomain<dim>::find_buckets(const State<dim>& state) {
  const auto n = static_cast<std::size_t>(state.position.cols());
  std::vector<Bucket> all(n);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) all[i] = bucket_of(state.position.col(static_cast<Eigen::Index>(i)));
  bucket_ = all;
  std::ranges::sort(bucket_);
  bucket_.erase(std::unique(bucket_.begin(), bucket_.end()), bucket_.end());
  bucket_of_.resize(n);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i)
    bucket_of_[i] = static_cast<std::int32_t>(std::ranges::lower_bound(bucket_, all[i]) - bucket_.begin());
}

template <int dim>
void Subdomain<dim>::choose_owners(const State<dim>& state) {
  std::vector<double> weight(bucket_.size(), 0), centre;
  centre.reserve(3 * bucket_.size());
  for (const Bucket& bucket : bucket_)
    for (int d = 0; d < 3; ++d)
      centre.push_back(d < dim ? corner_[d] + (bucket[static_cast<std::size_t>(d)] + 0.5) * size_[d] : 0.0);
  for (std::size_t i = 0; i < bucket_of_.size(); ++i)
    weight[static_cast<std::size_t>(bucket_of_[i])] +=
        static_cast<std::int64_t>(i) < water_of_whole_ ? 1.0 : work_of_layer;
  owner_ = partition_(centre, weight, communicator_->size());
  const auto ranks = static_cast<std::size_t>(communicator_->size());
  owned_by_.assign(ranks, {});
  own_water_.assign(ranks, 0);
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(state.kind.size()); ++i) {
    const auto owner =
        static_cast<std::size_t>(owner_[static_cast<std::size_t>(bucket_of_[static_cast<std::size_t>(i)])]);
    owned_by_[owner].push_back(i);
    if (i < water_of_whole_) ++own_water_[owner];
  }
}

/// Finds the ranks that want each bucket: the owners of the buckets in its rings.
template <int dim>
void Subdomain<dim>::find_rings() {
  wanted_by_.assign(bucket_.size(), {});
  const std::int32_t deep = dim == 3 ? rings : 0;
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t b = 0; b < bucket_.size(); ++b) {
    std::vector<int>& ranks = wanted_by_[b];
    for (std::int32_t z = -deep; z <= deep; ++z)
      for (std::int32_t y = -rings; y <= rings; ++y)
        for (std::int32_t x = -rings; x <= rings; ++x) {
          Bucket other = {bucket_[b][0] + x, bucket_[b][1] + y, bucket_[b][2] + z};
          for (std::size_t d = 0; d < dim; ++d)
            if (count_[d] > 0) other[d] = ((other[d] % count_[d]) + count_[d]) % count_[d];
          const auto found = std::ranges::lower_bound(bucket_, other);
          if (found != bucket_.end() && *found == other)
            ranks.push_back(owner_[static_cast<std::size_t>(found - bucket_.begin())]);
        }
    std::ranges::sort(ranks);
    ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
  }
}

/// Lists the local particles, and which of them are sent and received.
template <int dim>
void Subdomain<dim>::list_messages() {
  const int own = communicator_->rank();
  const auto ranks = static_cast<std::size_t>(communicator_->size());
  places_.clear();
  owned_.clear();
  send_.assign(ranks, {});
  receive_.assign(ranks, {});
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(bucket_of_.size()); ++i) {
    const auto b = static_cast<std::size_t>(bucket_of_[static_cast<std::size_t>(i)]);
    const std::vector<int>& wanted = wanted_by_[b];
    const bool water = i < water_of_whole_;
    if (water && !std::ranges::binary_search(wanted, own)) continue;
    const auto local = static_cast<std::int32_t>(places_.size());
    places_.push_back(i);
    owned_.push_back(owner_[b] == own ? 1 : 0);
    if (!water) continue;
    if (owner_[b] != own) {
      receive_[static_cast<std::size_t>(owner_[b])].push_back(local);
      continue;
    }
    for (const int rank : wanted)
      if (rank != own) send_[static_cast<std::size_t>(rank)].push_back(local);
  }
}

template <int dim>
std::int64_t Subdomain<dim>::divide(State<dim>& state, std::int64_t water) {
  water_of_whole_ = water;
  find_buckets(state);
  choose_owners(state);
  find_rings();
  list_messages();
  select_particles<dim>(state, places_);
  const auto layers = static_cast<std::int64_t>(bucket_of_.size()) - water;
  return static_cast<std::int64_t>(places_.size()) - layers;
}

template <int dim>
std::int64_t Subdomain<dim>::join(State<dim>& state) const {
  std::vector<std::int32_t> own;
  for (std::size_t i = 0; i < owned_.size(); ++i)
    if (owned_[i]) own.push_back(static_cast<std::int32_t>(i));
  State<dim> part = state;
  resize_particles<dim>(state, static_cast<Eigen::Index>(bucket_of_.size()));
  const auto one = [&](const char*, auto& mine, auto& whole) {
    Bytes bytes;
    pack(first_byte(mine), Subdomain::bytes_of_entry(mine), own, bytes);
    const std::vector<Bytes> all = communicator_->gather(bytes);
    for (std::size_t r = 0; r < all.size(); ++r)
      unpack(all[r], Subdomain::bytes_of_entry(mine), owned_by_[r], first_byte(whole));
  };
  for_each_column(one, part, state);
  return water_of_whole_;
}

template <int dim>
void Subdomain<dim>::send(std::byte* column, std::size_t each) const {
  std::vector<Bytes> to(send_.size()), from(receive_.size());
  for (std::size_t r = 0; r < send_.size(); ++r) {
    pack(column, each, send_[r], to[r]);
    from[r].resize(receive_[r].size() * each);
  }
  communicator_->exchange(to, from);
  for (std::size_t r = 0; r < from.size(); ++r) unpack(from[r], each, receive_[r], column);
}

template <int dim>
void Subdomain<dim>::send_layers(std::byte* column, std::size_t each) const {
  const auto layers_of = [&](std::size_t rank) {
    std::vector<std::int32_t> list(owned_by_[rank].begin() + static_cast<std::ptrdiff_t>(own_water_[rank]),
                                   owned_by_[rank].end());
    for (std::int32_t& i : list) i = static_cast<std::int32_t>(i - water_of_whole_);
    return list;
  };
  Bytes own;
  pack(column, each, layers_of(static_cast<std::size_t>(communicator_->rank())), own);
  const std::vector<Bytes> all = communicator_->gather(own);
  for (std::size_t r = 0; r < all.size(); ++r)
    if (static_cast<int>(r) != communicator_->rank()) unpack(all[r], each, layers_of(r), column);
}

template class Subdomain<2>;
template class Subdomain<3>;

}  // namespace strake::fluid
