#include "fluid/ranks/subdomain.hpp"

#include "fluid/particles/columns.hpp"
#include "fluid/particles/reorder.hpp"
#include "fluid/ranks/global_order.hpp"

#include <limits>
#include <numeric>
#include <utility>

namespace strake::fluid {

namespace {

/// Work of a water and of a layer particle, for the partition. Whole numbers: their sums are exact, in any
/// order.
constexpr double work_of_water = 10, work_of_layer = 3;

std::vector<std::int32_t> numbers(std::int64_t first, std::int64_t count) {
  std::vector<std::int32_t> list(static_cast<std::size_t>(count));
  std::iota(list.begin(), list.end(), static_cast<std::int32_t>(first));
  return list;
}

/// What goes with a particle to another rank, before its columns.
struct Address {
  std::int64_t place;
  Bucket bucket;
};

}  // namespace

template <int dim>
Subdomain<dim>::Subdomain(Communicator& communicator, Partition partition, const Buckets<dim>& buckets,
                          double slack, TankLayers<dim> tank)
    : communicator_(&communicator),
      partition_(std::move(partition)),
      buckets_(buckets),
      slack_(slack),
      tank_(std::move(tank)),
      division_(std::make_shared<Division>()) {}

/// Makes the boxes of the ranks from the work in the buckets.
template <int dim>
void Subdomain<dim>::balance(State<dim>& state) const {
  std::unordered_map<std::int64_t, std::size_t> number;
  std::vector<double> centre, weight;
  const auto add = [&](const Bucket& bucket, double work) {
    const auto [found, is_new] = number.try_emplace(key_of(bucket), weight.size());
    if (is_new) {
      const auto place = Buckets<dim>::place(bucket);
      centre.insert(centre.end(), place.begin(), place.end());
      weight.push_back(0);
    }
    weight[found->second] += work;
  };
  const std::int64_t water = local_water();
  for (std::int64_t i = 0; i < water; ++i)
    if (owns(i)) add(buckets_.of(state.position.col(i)), work_of_water);
  // Before the first division all ranks have the same layer particles; each counts a part of them.
  const bool have_all = is_read();
  if (have_all && tank_layers().empty() && tank_.for_each)
    tank_.for_each([&](std::int64_t number, const Vector<dim>& place, bool) {
      if (number % communicator_->size() == communicator_->rank()) add(buckets_.of(place), work_of_layer);
    });
  for (std::int64_t i = water; i < state.position.cols(); ++i)
    if (have_all ? i % communicator_->size() == communicator_->rank() : owns(i))
      add(buckets_.of(state.position.col(i)), work_of_layer);
  const std::vector<double> boxes = partition_(*communicator_, centre, weight);
  state.rank_boxes = Eigen::Map<const Eigen::VectorXd>(boxes.data(), std::ssize(boxes));
}

template <int dim>
const std::vector<Wanting>& Subdomain<dim>::wanted_by(const Bucket& bucket) {
  const auto [found, is_new] = wanted_by_.try_emplace(key_of(bucket));
  if (is_new) buckets_.find_wanting(bucket, boxes_, communicator_->rank(), found->second);
  return found->second;
}

template <int dim>
void Subdomain<dim>::take_part(State<dim>& state, std::int64_t water) {
  water_of_whole_ = water;
  layers_ = state.position.cols() - water;
  const bool has_buckets = std::ssize(state.rank_buckets) == water + layers_;
  std::vector<std::int32_t> local;
  std::vector<std::int64_t> buckets;
  for (const auto& [first, last] : ranges_of_part()) {
    for (const std::int32_t i : numbers(first, last - first)) local.push_back(i);
    if (has_buckets)
      buckets.insert(buckets.end(), state.rank_buckets.begin() + first, state.rank_buckets.begin() + last);
  }
  state.rank_buckets = std::move(buckets);
  select_particles<dim>(state, local);
  take_share(state);
}

template <int dim>
bool Subdomain<dim>::is_due(const State<dim>& state) const {
  const Division& now = *division_;
  const std::int64_t water = local_water(), all = now.layer_bucket.empty() ? water : state.position.cols();
  const Vector<dim>& size = buckets_.size();
  bool left = false;
#pragma omp parallel reduction(|| : left)
  {
    Bucket before{};
    Vector<dim> low = buckets_.corner_of(before), high = low + size;
#pragma omp for schedule(static)
    for (std::int64_t i = 0; i < all; ++i) {
      if (i < water && !owns(i)) continue;
      const Bucket& bucket = i < water ? now.bucket[static_cast<std::size_t>(i)]
                                       : now.layer_bucket[static_cast<std::size_t>(i - water)];
      if (bucket != before) {  // particles that follow one another are mostly in one bucket
        before = bucket;
        low = buckets_.corner_of(bucket);
        high = low + size;
      }
      bool inside = true;
      for (int d = 0; d < dim; ++d)
        inside = inside && state.position(d, i) >= low[d] && state.position(d, i) <= high[d];
      left = left || (!inside && !(buckets_.outside(state.position.col(i), bucket) <= slack_));
    }
  }
  return communicator_->any(left);
}

/// Sends the listed particles to the ranks.
template <int dim>
std::vector<Bytes> Subdomain<dim>::exchange_particles(
    const State<dim>& state, const Division& division,
    std::span<const std::vector<std::int32_t>> lists) const {
  std::vector<Bytes> to(lists.size());
  for (std::size_t r = 0; r < lists.size(); ++r) {
    for (const std::int32_t i : lists[r])
      append(to[r], Address{division.place[static_cast<std::size_t>(i)],
                            division.bucket[static_cast<std::size_t>(i)]});
    pack_particles<dim>(state, lists[r], to[r]);
  }
  return communicator_->exchange_any(to);
}

/// Appends particles that have come to the state, behind the layers, and to the division, in the order of
/// ranks.
template <int dim>
void Subdomain<dim>::append_particles(State<dim>& state, const std::vector<Bytes>& all,
                                      Division& division) const {
  const std::size_t each = sizeof(Address) + bytes_of_particle<dim>(state);
  std::size_t come = 0;
  for (const Bytes& bytes : all) come += bytes.size() / each;
  std::int64_t next = state.position.cols();
  if (come > 0) resize_particles<dim>(state, next + static_cast<Eigen::Index>(come));
  for (std::size_t r = 0; r < all.size(); ++r) {
    const auto count = static_cast<std::int64_t>(all[r].size() / each);
    const std::byte* from = all[r].data();
    for (std::int64_t k = 0; k < count; ++k) {
      const auto address = take<Address>(from);
      division.place.push_back(address.place);
      division.bucket.push_back(address.bucket);
      division.owner.push_back(static_cast<int>(r));
    }
    unpack_particles<dim>(from, numbers(next, count), state);
    next += count;
  }
}

/// Leaves the own water and the layers in the state, the water in the order of the whole.
template <int dim>
void Subdomain<dim>::migrate(State<dim>& state, Division& next) const {
  const Division& now = *division_;
  const std::int64_t water = local_water(), layers = std::ssize(now.layer_number);
  const int own = communicator_->rank();
  std::vector<std::vector<std::int32_t>> leaves(static_cast<std::size_t>(communicator_->size()));
  std::vector<std::int32_t> stays;
  for (std::int64_t i = 0; i < water; ++i) {
    if (!owns(i)) continue;
    const int to = owner_of(now.bucket[static_cast<std::size_t>(i)]);
    (to == own ? stays : leaves[static_cast<std::size_t>(to)]).push_back(static_cast<std::int32_t>(i));
  }
  const std::vector<Bytes> arrived = exchange_particles(state, now, leaves);
  for (const std::int32_t i : stays) {
    next.place.push_back(now.place[static_cast<std::size_t>(i)]);
    next.bucket.push_back(now.bucket[static_cast<std::size_t>(i)]);
    next.owner.push_back(own);
  }
  append_particles(state, arrived, next);
  std::vector<std::int32_t> from = stays;
  for (const std::int32_t i : numbers(water + layers, std::ssize(next.place) - std::ssize(stays)))
    from.push_back(i);
  std::vector<std::int32_t> order = numbers(0, std::ssize(from)), list;
  const auto by_place = [&](std::int32_t k) { return next.place[static_cast<std::size_t>(k)]; };
  if (!std::ranges::is_sorted(order, {}, by_place)) std::ranges::sort(order, {}, by_place);
  Division sorted;
  for (const std::int32_t k : order) {
    const auto at = static_cast<std::size_t>(k);
    list.push_back(from[at]);
    sorted.place.push_back(next.place[at]);
    sorted.bucket.push_back(next.bucket[at]);
  }
  sorted.owner.assign(sorted.place.size(), own);
  for (const std::int32_t i : numbers(water, layers)) list.push_back(i);
  select_particles<dim>(state, list);
  next = std::move(sorted);
  next.layer_number = now.layer_number;
  next.layer_bucket = now.layer_bucket;
}

/// Adds the copies of other ranks' water, and lists who sends what.
template <int dim>
void Subdomain<dim>::copy_ghosts(State<dim>& state, Division& next) {
  const auto ranks = static_cast<std::size_t>(communicator_->size());
  const std::int64_t own = std::ssize(next.place), layers = std::ssize(next.layer_number);
  std::vector<std::vector<std::int32_t>> send(ranks), send_near(ranks);
  std::vector<Bytes> nearness(ranks);
  const std::vector<Wanting>* wanting = nullptr;
  for (std::int64_t i = 0; i < own; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (wanting == nullptr || next.bucket[k] != next.bucket[k - 1]) wanting = &wanted_by(next.bucket[k]);
    for (const auto& [rank, near] : *wanting) {
      const auto r = static_cast<std::size_t>(rank);
      send[r].push_back(static_cast<std::int32_t>(i));
      if (near) send_near[r].push_back(static_cast<std::int32_t>(i));
      append(nearness[r], static_cast<std::uint8_t>(near ? 1 : 0));
    }
  }
  append_particles(state, exchange_particles(state, next, send), next);
  nearness = communicator_->exchange_any(nearness);

  // The order of the whole. The ghosts of each rank stand in it as they were sent.
  std::vector<std::int32_t> order = numbers(0, std::ssize(next.place)), local(order.size()), list;
  std::ranges::sort(order, {}, [&](std::int32_t k) { return next.place[static_cast<std::size_t>(k)]; });
  Division sorted;
  for (const std::int32_t k : order) {
    const auto at = static_cast<std::size_t>(k);
    local[at] = static_cast<std::int32_t>(list.size());
    sorted.place.push_back(next.place[at]);
    sorted.bucket.push_back(next.bucket[at]);
    sorted.owner.push_back(next.owner[at]);
    sorted.owned.push_back(k < own ? 1 : 0);
    list.push_back(static_cast<std::int32_t>(k < own ? k : k + layers));
  }
  for (const std::int32_t i : numbers(own, layers)) list.push_back(i);
  select_particles<dim>(state, list);

  sorted.ghosts.clear(communicator_->size());
  sorted.near.clear(communicator_->size());
  auto ghost = static_cast<std::size_t>(own);
  for (std::size_t r = 0; r < ranks; ++r) {
    for (const std::int32_t i : send[r]) sorted.ghosts.send[r].push_back(local[static_cast<std::size_t>(i)]);
    for (const std::int32_t i : send_near[r])
      sorted.near.send[r].push_back(local[static_cast<std::size_t>(i)]);
    if (static_cast<int>(r) == communicator_->rank()) continue;
    for (const std::byte near : nearness[r]) {
      const std::int32_t at = local[ghost++];
      sorted.ghosts.receive[r].push_back(at);
      if (near != std::byte{0}) sorted.near.receive[r].push_back(at);
    }
  }
  sorted.layer_number = std::move(next.layer_number);
  sorted.layer_bucket = std::move(next.layer_bucket);
  next = std::move(sorted);
}

/// Takes the boxes of the ranks from the state. Returns whether they are others.
template <int dim>
bool Subdomain<dim>::take_boxes(const State<dim>& state) {
  if (std::ranges::equal(boxes_.values(), state.rank_boxes)) return false;
  boxes_.assign({state.rank_boxes.data(), static_cast<std::size_t>(state.rank_boxes.size())});
  wanted_by_.clear();
  is_near_.clear();
  return true;
}

template <int dim>
void Subdomain<dim>::divide(State<dim>& state, bool balance_again) {
  refresh_layers(state);
  if (balance_again || !has_boxes(state)) balance(state);
  const bool anew = take_boxes(state);
  if (!is_read() || !division_->buckets_hold) {  // else the buckets that were read hold
    auto now = std::make_shared<Division>(*division_);
    for (std::size_t i = 0; i < now->bucket.size(); ++i)
      if (now->owned[i]) now->bucket[i] = buckets_.of(state.position.col(static_cast<Eigen::Index>(i)));
    for (std::size_t k = 0; k < now->layer_bucket.size(); ++k)
      now->layer_bucket[k] = buckets_.of(state.position.col(local_water() + static_cast<Eigen::Index>(k)));
    division_ = std::move(now);
  }
  Division next;
  migrate(state, next);
  choose_layers(state, next, anew || is_read());
  copy_ghosts(state, next);
  find_layer_owners(state, next);
  division_ = std::make_shared<Division>(std::move(next));
  motion_.forget();
}

template <int dim>
void Subdomain<dim>::sort_along_cells(const State<dim>& state, double size) {
  auto next = std::make_shared<Division>(*division_);
  std::vector<std::int32_t> own;
  std::vector<std::int64_t> old_place;
  for (std::size_t i = 0; i < next->place.size(); ++i) {
    if (!next->owned[i]) continue;
    own.push_back(static_cast<std::int32_t>(i));
    old_place.push_back(next->place[i]);
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
  for (std::size_t k = 0; k < own.size(); ++k) next->place[static_cast<std::size_t>(own[k])] = place[k];
  division_ = std::move(next);
}

template <int dim>
State<dim> Subdomain<dim>::join(const State<dim>& state, const Division& division) const {
  const std::int64_t first = std::ssize(division.place);
  const bool same_layers = !division.is_divided();
  std::vector<std::int32_t> own;
  Bytes bytes;
  for (std::int64_t i = 0; i < first + std::ssize(division.layer_number); ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (i >= first && same_layers ? communicator_->rank() != 0 : division.owned[at] == 0) continue;
    own.push_back(static_cast<std::int32_t>(i));
    const auto layer = static_cast<std::size_t>(i - first);
    append(bytes,
           i < first ? Address{division.place[at], division.bucket[at]}
                     : Address{water_of_whole_ + division.layer_number[layer], division.layer_bucket[layer]});
  }
  pack_particles<dim>(state, own, bytes);
  State<dim> whole;
  for_each_value([](const char*, const auto& from, auto& to) { to = from; }, state, whole);
  if (communicator_->rank() == 0) {
    resize_particles<dim>(whole, water_of_whole_ + layers_);
    whole.rank_buckets.resize(static_cast<std::size_t>(water_of_whole_ + layers_));
  }
  communicator_->show_first(bytes, [&](std::span<const std::byte> part) {
    const std::byte* from = part.data();
    std::vector<std::int32_t> list;
    for (std::size_t k = part.size() / (sizeof(Address) + bytes_of_particle<dim>(whole)); k > 0; --k) {
      const auto address = take<Address>(from);
      list.push_back(static_cast<std::int32_t>(address.place));
      whole.rank_buckets[static_cast<std::size_t>(address.place)] = key_of(address.bucket);
    }
    unpack_particles<dim>(from, list, whole);
  });
  if (same_layers) whole.rank_buckets.clear();
  return whole;
}

template class Subdomain<2>;
template class Subdomain<3>;

}  // namespace strake::fluid
