#include "fluid/ranks/subdomain.hpp"

#include "fluid/particles/columns.hpp"
#include "fluid/particles/reorder.hpp"
#include "fluid/ranks/global_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace strake::fluid {

namespace {

/// Rings of buckets around the own ones whose water a rank has.
constexpr std::int32_t rings = 2;
/// Work of a water and of a layer particle, for the partition. Whole numbers: their sums are exact, in any
/// order.
constexpr double work_of_water = 10, work_of_layer = 3;
/// Largest number of a bucket; places beyond belong to the last.
constexpr double most_buckets = 1 << 20;
/// Bounds of the boxes look at buckets from a slight angle. So a bound may end within a slab of buckets.
constexpr double skew = 1e-4;

std::array<double, 3> place_for_partition(const Bucket& b) {
  return {b[0] + skew * b[1] + skew * skew * b[2], b[1] + skew * b[2] + skew * skew * b[0],
          b[2] + skew * b[0] + skew * skew * b[1]};
}

std::uint64_t key_of(const Bucket& bucket) {
  std::uint64_t key = 0;
  for (const std::int32_t at : bucket) key = key << 21 | (static_cast<std::uint32_t>(at) & 0x1fffffU);
  return key;
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
Bucket Subdomain<dim>::wrapped(Bucket bucket) const {
  for (std::size_t d = 0; d < dim; ++d)
    if (count_[d] > 0) bucket[d] = ((bucket[d] % count_[d]) + count_[d]) % count_[d];
  return bucket;
}

template <int dim>
Bucket Subdomain<dim>::bucket_of(const Vector<dim>& x) const {
  Bucket bucket{};
  for (int d = 0; d < dim; ++d) {
    const double at = std::floor((x[d] - corner_[d]) / size_[d]);
    // Not a number goes to the first bucket.
    bucket[static_cast<std::size_t>(d)] =
        at == at ? static_cast<std::int32_t>(std::clamp(at, -most_buckets, most_buckets - 1)) : 0;
  }
  return wrapped(bucket);
}

template <int dim>
Vector<dim> Subdomain<dim>::corner_of(const Bucket& bucket) const {
  Vector<dim> x = corner_;
  for (int d = 0; d < dim; ++d) x[d] += bucket[static_cast<std::size_t>(d)] * size_[d];
  return x;
}

template <int dim>
int Subdomain<dim>::owner_of(const Bucket& bucket) const {
  const std::array<double, 3> at = place_for_partition(bucket);
  const auto has = [&](int rank) {
    const double* const box = boxes_.data() + 6 * static_cast<std::ptrdiff_t>(rank);
    bool inside = true;
    for (std::size_t d = 0; d < 3; ++d) inside = inside && box[d] < at[d] && at[d] <= box[3 + d];
    return inside;
  };
  if (has(communicator_->rank())) return communicator_->rank();
  for (int rank = 0; rank < communicator_->size(); ++rank)
    if (has(rank)) return rank;
  return 0;
}

/// Makes the boxes of the ranks from the work in the buckets.
template <int dim>
void Subdomain<dim>::balance(State<dim>& state) const {
  std::unordered_map<std::uint64_t, std::size_t> number;
  std::vector<double> centre, weight;
  const auto add = [&](const Bucket& bucket, double work) {
    const auto [found, is_new] = number.try_emplace(key_of(bucket), weight.size());
    if (is_new) {
      const auto place = place_for_partition(bucket);
      centre.insert(centre.end(), place.begin(), place.end());
      weight.push_back(0);
    }
    weight[found->second] += work;
  };
  const std::int64_t water = state.position.cols() - layers_;
  for (std::int64_t i = 0; i < water; ++i)
    if (owns(i)) add(bucket_of(state.position.col(i)), work_of_water);
  // All ranks have all layer particles; each counts a part of them.
  for (std::int64_t i = water + communicator_->rank(); i < state.position.cols(); i += communicator_->size())
    add(bucket_of(state.position.col(i)), work_of_layer);
  const std::vector<double> boxes = partition_(*communicator_, centre, weight);
  state.rank_boxes = Eigen::Map<const Eigen::VectorXd>(boxes.data(), std::ssize(boxes));
}

/// Finds the other ranks that want a bucket of this one, and whether it is in their first ring. The own
/// buckets lie in a convex box: where the corners around are own, all between is.
template <int dim>
void Subdomain<dim>::find_wanting(const Bucket& bucket, std::vector<std::pair<int, bool>>& ranks) const {
  const int own = communicator_->rank();
  const std::int32_t deep = dim == 3 ? rings : 0;
  const auto at = [&](std::int32_t x, std::int32_t y, std::int32_t z) {
    return Bucket{bucket[0] + x, bucket[1] + y, bucket[2] + z};
  };
  bool inside = true, wraps = false;
  for (int corner = 0; corner < 8 && inside; ++corner) {
    const Bucket other =
        at(corner & 1 ? rings : -rings, corner & 2 ? rings : -rings, corner & 4 ? deep : -deep);
    wraps = wraps || wrapped(other) != other;
    inside = !wraps && owner_of(other) == own;
  }
  if (inside) return;
  for (std::int32_t z = -deep; z <= deep; ++z)
    for (std::int32_t y = -rings; y <= rings; ++y)
      for (std::int32_t x = -rings; x <= rings; ++x) {
        const int rank = owner_of(wrapped(at(x, y, z)));
        if (rank == own) continue;
        const bool near = std::max({std::abs(x), std::abs(y), std::abs(z)}) <= 1;
        const auto found = std::ranges::find(ranks, rank, &std::pair<int, bool>::first);
        if (found == ranks.end())
          ranks.emplace_back(rank, near);
        else
          found->second = found->second || near;
      }
}

template <int dim>
const std::vector<std::pair<int, bool>>& Subdomain<dim>::wanted_by(const Bucket& bucket) {
  const auto [found, is_new] = wanted_by_.try_emplace(key_of(bucket));
  if (is_new) find_wanting(bucket, found->second);
  return found->second;
}

template <int dim>
void Subdomain<dim>::take_part(State<dim>& state, std::int64_t water) {
  water_of_whole_ = water;
  const std::int64_t layers = state.position.cols() - water, rank = communicator_->rank(),
                     begin = water * rank / communicator_->size(),
                     end = water * (rank + 1) / communicator_->size();
  std::vector<std::int32_t> local;
  division_ = {};
  for (std::int64_t i = begin; i < end; ++i) {
    local.push_back(static_cast<std::int32_t>(i));
    division_.place.push_back(i);
    division_.owned.push_back(1);
  }
  for (std::int64_t i = water; i < water + layers; ++i) local.push_back(static_cast<std::int32_t>(i));
  select_particles<dim>(state, local);
  division_.owned.resize(local.size());
  layers_ = layers;
  list_layers();
}

template <int dim>
void Subdomain<dim>::adopt(const Division& division) {
  division_ = division;
  list_layers();
}

/// Sends the listed particles to the ranks: place, then column by column.
template <int dim>
std::vector<Bytes> Subdomain<dim>::exchange_particles(
    const State<dim>& state, std::span<const std::vector<std::int32_t>> lists) const {
  std::vector<Bytes> to(lists.size());
  Bytes part;
  for (std::size_t r = 0; r < lists.size(); ++r) {
    if (lists[r].empty()) continue;
    pack(reinterpret_cast<const std::byte*>(division_.place.data()), sizeof(std::int64_t), lists[r], to[r]);
    for_each_column(
        [&](const char*, const auto& column) {
          pack(reinterpret_cast<const std::byte*>(column.data()), bytes_of_entry(column), lists[r], part);
          to[r].insert(to[r].end(), part.begin(), part.end());
        },
        state);
  }
  return communicator_->exchange_any(to);
}

/// Appends particles that have come to all columns, in the order of ranks.
template <int dim>
void Subdomain<dim>::append_particles(State<dim>& state, const std::vector<Bytes>& all,
                                      std::vector<std::int64_t>& place) const {
  std::size_t each = sizeof(std::int64_t);
  for_each_column([&](const char*, const auto& column) { each += bytes_of_entry(column); }, state);
  std::size_t come = 0;
  for (const Bytes& bytes : all) come += bytes.size() / each;
  auto next = static_cast<std::int32_t>(state.position.cols());
  resize_particles<dim>(state, next + static_cast<Eigen::Index>(come));
  std::vector<std::int32_t> list;
  for (const Bytes& bytes : all) {
    const std::size_t count = bytes.size() / each;
    list.resize(count);
    std::iota(list.begin(), list.end(), next);
    next = static_cast<std::int32_t>(next + static_cast<std::int32_t>(count));
    const std::byte* from = bytes.data();
    for (std::size_t k = 0; k < count; ++k) place.push_back(take<std::int64_t>(from));
    for_each_column(
        [&](const char*, auto& column) {
          const std::size_t bytes_each = bytes_of_entry(column);
          unpack(from, bytes_each, list, reinterpret_cast<std::byte*>(column.data()));
          from += bytes_each * count;
        },
        state);
  }
}

/// Leaves the own water and the layers in the state, the water in the order of the whole.
template <int dim>
void Subdomain<dim>::migrate(State<dim>& state) {
  const std::int64_t layers = layers_, water = state.position.cols() - layers;
  const int own = communicator_->rank();
  std::vector<std::vector<std::int32_t>> leaves(static_cast<std::size_t>(communicator_->size()));
  std::vector<int> owner(static_cast<std::size_t>(water), -1);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i)
    if (owns(i)) owner[static_cast<std::size_t>(i)] = owner_of(bucket_of(state.position.col(i)));
  std::vector<std::pair<std::int64_t, std::int32_t>> stays;
  for (std::int64_t i = 0; i < water; ++i) {
    const int to = owner[static_cast<std::size_t>(i)];
    if (to == own)
      stays.emplace_back(division_.place[static_cast<std::size_t>(i)], static_cast<std::int32_t>(i));
    else if (to >= 0)
      leaves[static_cast<std::size_t>(to)].push_back(static_cast<std::int32_t>(i));
  }
  std::vector<std::int64_t> come;
  append_particles(state, exchange_particles(state, leaves), come);
  for (std::size_t k = 0; k < come.size(); ++k)
    stays.emplace_back(come[k], static_cast<std::int32_t>(water + layers + static_cast<std::int64_t>(k)));
  if (!std::ranges::is_sorted(stays)) std::ranges::sort(stays);
  std::vector<std::int32_t> list;
  list.reserve(stays.size() + static_cast<std::size_t>(layers));
  division_.place.clear();
  for (const auto& [place, i] : stays) {
    list.push_back(i);
    division_.place.push_back(place);
  }
  for (std::int64_t k = 0; k < layers; ++k) list.push_back(static_cast<std::int32_t>(water + k));
  select_particles<dim>(state, list);
}

/// Adds the copies of other ranks' water, and lists who sends what.
template <int dim>
void Subdomain<dim>::add_ghosts(State<dim>& state) {
  const auto ranks = static_cast<std::size_t>(communicator_->size());
  const std::int64_t layers = layers_, own = state.position.cols() - layers;
  bucket_.resize(static_cast<std::size_t>(own));
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < own; ++i)
    bucket_[static_cast<std::size_t>(i)] = bucket_of(state.position.col(i));
  std::vector<std::vector<std::int32_t>> send(ranks), send_near(ranks);
  const std::vector<std::pair<int, bool>>* wanting = nullptr;
  for (std::int64_t i = 0; i < own; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (wanting == nullptr || bucket_[k] != bucket_[k - 1]) wanting = &wanted_by(bucket_[k]);
    for (const auto& [rank, near] : *wanting) {
      send[static_cast<std::size_t>(rank)].push_back(static_cast<std::int32_t>(i));
      if (near) send_near[static_cast<std::size_t>(rank)].push_back(static_cast<std::int32_t>(i));
    }
  }
  const std::vector<Bytes> arrived = exchange_particles(state, send);
  std::vector<Bytes> nearness(ranks);
  for (std::size_t r = 0; r < ranks; ++r) {
    auto near = send_near[r].begin();
    for (const std::int32_t i : send[r]) {
      const bool is_near = near != send_near[r].end() && *near == i;
      append(nearness[r], static_cast<std::uint8_t>(is_near ? 1 : 0));
      if (is_near) ++near;
    }
  }
  nearness = communicator_->exchange_any(nearness);
  std::vector<std::int64_t> place = division_.place;
  append_particles(state, arrived, place);

  // The order of the whole, in which the ghosts of each rank stand as they were sent.
  std::vector<std::int32_t> order(place.size()), local(place.size()), list;
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::int32_t k) { return place[static_cast<std::size_t>(k)]; });
  list.reserve(order.size() + static_cast<std::size_t>(layers));
  division_.place.clear();
  division_.owned.clear();
  for (const std::int32_t k : order) {
    local[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(list.size());
    division_.place.push_back(place[static_cast<std::size_t>(k)]);
    division_.owned.push_back(k < own ? 1 : 0);
    list.push_back(k < own ? k : static_cast<std::int32_t>(k + layers));
  }
  for (std::int64_t k = 0; k < layers; ++k) list.push_back(static_cast<std::int32_t>(own + k));
  select_particles<dim>(state, list);

  ghosts_.clear(communicator_->size());
  near_.clear(communicator_->size());
  owner_.assign(order.size(), communicator_->rank());
  auto next = static_cast<std::size_t>(own);
  for (std::size_t r = 0; r < ranks; ++r) {
    for (const std::int32_t i : send[r]) ghosts_.send[r].push_back(local[static_cast<std::size_t>(i)]);
    for (const std::int32_t i : send_near[r]) near_.send[r].push_back(local[static_cast<std::size_t>(i)]);
    for (const std::byte near : nearness[r]) {
      const std::int32_t ghost = local[next++];
      owner_[static_cast<std::size_t>(ghost)] = static_cast<int>(r);
      ghosts_.receive[r].push_back(ghost);
      if (near != std::byte{0}) near_.receive[r].push_back(ghost);
    }
  }
  bucket_.resize(order.size());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < order.size(); ++i)
    bucket_[i] = bucket_of(state.position.col(static_cast<Eigen::Index>(i)));
}

template <int dim>
void Subdomain<dim>::find_layer_owners(const State<dim>& state) {
  const std::int64_t first = state.position.cols() - layers_;
  division_.owned.resize(static_cast<std::size_t>(first));
  division_.layer_owner.resize(static_cast<std::size_t>(layers_));
  for (std::int64_t k = 0; k < layers_; ++k) {
    const int owner = owner_of(bucket_of(state.position.col(first + k)));
    division_.layer_owner[static_cast<std::size_t>(k)] = owner;
    division_.owned.push_back(owner == communicator_->rank() ? 1 : 0);
  }
  list_layers();
}

template <int dim>
void Subdomain<dim>::list_layers() {
  layers_of_.assign(static_cast<std::size_t>(communicator_->size()), {});
  for (std::size_t k = 0; k < division_.layer_owner.size(); ++k)
    layers_of_[static_cast<std::size_t>(division_.layer_owner[k])].push_back(static_cast<std::int32_t>(k));
}

template <int dim>
std::int64_t Subdomain<dim>::divide(State<dim>& state, bool balance_again) {
  const std::int64_t first = state.position.cols() - layers_;
  if (!division_.layer_owner.empty())
    for_each_column([&](const char*, auto& column) { update_layers(column, first); }, state);
  if (balance_again || state.rank_boxes.size() != 6 * communicator_->size()) balance(state);
  if (!std::ranges::equal(boxes_, state.rank_boxes)) {
    boxes_.assign(state.rank_boxes.begin(), state.rank_boxes.end());
    wanted_by_.clear();
  }
  migrate(state);
  add_ghosts(state);
  find_layer_owners(state);
  return local_water();
}

template <int dim>
void Subdomain<dim>::sort_along_cells(const State<dim>& state, double size) {
  std::vector<std::int32_t> own;
  std::vector<std::int64_t> old_place;
  for (std::size_t i = 0; i < division_.place.size(); ++i) {
    if (!division_.owned[i]) continue;
    own.push_back(static_cast<std::int32_t>(i));
    old_place.push_back(division_.place[i]);
  }
  const Vectors<dim> position = state.position(Eigen::all, own);
  std::array<double, dim> lowest;
  lowest.fill(std::numeric_limits<double>::infinity());
  for (int d = 0; d < dim && !own.empty(); ++d)
    lowest[static_cast<std::size_t>(d)] = position.row(d).minCoeff();
  for (const auto& other : communicator_->all(lowest))
    for (std::size_t d = 0; d < dim; ++d) lowest[d] = std::min(lowest[d], other[d]);
  const Vector<dim> low = Eigen::Map<const Vector<dim>>(lowest.data());
  const auto place = places_by_key(*communicator_, cells_along_curve<dim>(position, low, size), old_place);
  for (std::size_t k = 0; k < own.size(); ++k) division_.place[static_cast<std::size_t>(own[k])] = place[k];
}

template <int dim>
State<dim> Subdomain<dim>::join(const State<dim>& state, const Division& division) const {
  const auto first = static_cast<std::int64_t>(division.place.size());
  const bool layers_differ = !division.layer_owner.empty();
  std::vector<std::int32_t> own;
  Bytes bytes, part;
  for (std::size_t i = 0; i < division.owned.size(); ++i) {
    const bool layer = static_cast<std::int64_t>(i) >= first;
    if (layer && !layers_differ ? communicator_->rank() != 0 : division.owned[i] == 0) continue;
    own.push_back(static_cast<std::int32_t>(i));
    append(bytes, layer ? water_of_whole_ + static_cast<std::int64_t>(i) - first : division.place[i]);
  }
  const auto count = static_cast<std::int64_t>(own.size());
  for_each_column(
      [&](const char*, const auto& column) {
        pack(reinterpret_cast<const std::byte*>(column.data()), bytes_of_entry(column), own, part);
        bytes.insert(bytes.end(), part.begin(), part.end());
      },
      state);
  const std::vector<std::int64_t> counts = communicator_->all(count);
  const std::vector<Bytes> all = communicator_->gather_on_first(bytes);
  State<dim> whole;
  for_each_value([](const char*, const auto& from, auto& to) { to = from; }, state, whole);
  if (all.empty()) {
    resize_particles<dim>(whole, 0);
    return whole;
  }
  resize_particles<dim>(whole, water_of_whole_ + layers_);
  std::vector<std::int32_t> list;
  for (std::size_t r = 0; r < all.size(); ++r) {
    const std::byte* from = all[r].data();
    list.clear();
    for (std::int64_t k = 0; k < counts[r]; ++k)
      list.push_back(static_cast<std::int32_t>(take<std::int64_t>(from)));
    for_each_column(
        [&](const char*, auto& column) {
          unpack(from, bytes_of_entry(column), list, reinterpret_cast<std::byte*>(column.data()));
          from += bytes_of_entry(column) * list.size();
        },
        whole);
  }
  return whole;
}

template <int dim>
void Subdomain<dim>::send_layers(std::byte* column, std::size_t each) const {
  Bytes own;
  pack(column, each, layers_of_[static_cast<std::size_t>(communicator_->rank())], own);
  const std::vector<Bytes> all = communicator_->gather(own);
  for (std::size_t r = 0; r < all.size(); ++r)
    if (static_cast<int>(r) != communicator_->rank()) unpack(all[r].data(), each, layers_of_[r], column);
}

template class Subdomain<2>;
template class Subdomain<3>;

}  // namespace strake::fluid
