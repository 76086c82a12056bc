#include "fluid/particles/columns.hpp"
#include "fluid/ranks/subdomain.hpp"

#include <algorithm>
#include <numeric>

// The layer particles of walls and bodies. All ranks have those of bodies and of a tank that moves; of a tank
// at rest each rank has those near its water. One rank owns each.

namespace strake::fluid {

namespace {

/// Rings around the own buckets in which a rank has the tank's first layer. A layer behind it lies in
/// `ghost_rings`; the particle that it extends is less than two buckets away along each axis, at the mitre of
/// a polygon's corner too.
template <int dim>
constexpr std::int32_t first_layer_rings = Buckets<dim>::ghost_rings + 2;

/// A layer particle of the tank.
template <int dim>
struct TankLayer {
  std::int64_t number;
  Vector<dim> place;
  Bucket bucket;
  bool first_layer;
};

/// Returns where the number stands in an ascending list; -1: it is not there.
std::int64_t find_number(const std::vector<std::int64_t>& list, std::int64_t number) {
  const auto found = std::ranges::lower_bound(list, number);
  return found != list.end() && *found == number ? found - list.begin() : -1;
}

}  // namespace

template <int dim>
void Subdomain<dim>::find_layer_owners(const State<dim>& state, Division& next) {
  const std::int64_t first = std::ssize(next.place), layers = std::ssize(next.layer_number);
  const int own = communicator_->rank();
  next.layers.clear(communicator_->size());
  for (std::int64_t k = 0; k < layers; ++k) {
    const Bucket& bucket = next.layer_bucket[static_cast<std::size_t>(k)];
    const int owner = owner_of(bucket);
    next.layer_owner.push_back(owner);
    next.owned.push_back(owner == own ? 1 : 0);
    const auto [found, is_new] = is_near_.try_emplace(key_of(bucket), true);
    if (is_new) found->second = buckets_.is_near(bucket, boxes_, own);
    const bool is_near = found->second;
    next.layer_absent.push_back(is_near ? 0 : 1);
    // All ranks get those of bodies: layers beyond a corner extend one that may be far from the water.
    const Kind kind = state.kind[static_cast<std::size_t>(first + k)];
    const bool of_wall = kind == Kind::wall || kind == Kind::dummy_wall;
    if (owner != own) {
      if (is_near || !of_wall)
        next.layers.receive[static_cast<std::size_t>(owner)].push_back(static_cast<std::int32_t>(k));
      continue;
    }
    const auto send_to = [&](int rank) {
      if (rank != own)
        next.layers.send[static_cast<std::size_t>(rank)].push_back(static_cast<std::int32_t>(k));
    };
    if (of_wall)
      for (const Wanting& wanting : wanted_by(bucket)) send_to(wanting.rank);
    else
      for (int rank = 0; rank < communicator_->size(); ++rank) send_to(rank);
  }
}

/// Sends the own layer particles of the tank, which begin at `first`, to the ranks that have water near them
/// by the new boxes. Each message has their numbers, then their columns.
template <int dim>
std::vector<Bytes> Subdomain<dim>::send_tank_layers(const State<dim>& state, std::int64_t first) {
  const Division& now = *division_;
  const auto ranks = static_cast<std::size_t>(communicator_->size());
  std::vector<std::vector<std::int32_t>> list(ranks);
  std::vector<Bytes> to(ranks);
  const std::size_t count = tank_layers().size();
  for (std::size_t k = 0; k < count; ++k) {
    if (now.layer_owner[k] != communicator_->rank()) continue;
    for (const Wanting& wanting : wanted_by(now.layer_bucket[k])) {
      const auto r = static_cast<std::size_t>(wanting.rank);
      list[r].push_back(static_cast<std::int32_t>(first + static_cast<std::int64_t>(k)));
      append(to[r], now.layer_number[k]);
    }
  }
  for (std::size_t r = 0; r < ranks; ++r) pack_particles<dim>(state, list[r], to[r]);
  return communicator_->exchange_any(to);
}

/// Lists the tank's layer particles near the own buckets, and returns where they are behind the own water.
/// New ones are appended to the state, dry and at rest.
template <int dim>
std::vector<std::int32_t> Subdomain<dim>::list_near_layers(State<dim>& state, Division& next) const {
  std::vector<TankLayer<dim>> near;
  tank_.for_each([&](std::int64_t number, const Vector<dim>& place, bool first_layer) {
    const Bucket bucket = buckets_.of(place);
    if (buckets_.is_near(bucket, boxes_, communicator_->rank(),
                         first_layer ? first_layer_rings<dim> : Buckets<dim>::ghost_rings))
      near.push_back({number, place, bucket, first_layer});
  });
  std::ranges::sort(near, {}, &TankLayer<dim>::number);
  const std::int64_t first = std::ssize(next.place);
  std::vector<std::int32_t> list;
  std::vector<std::int64_t> number;
  std::vector<Bucket> bucket;
  std::vector<const TankLayer<dim>*> fresh;
  for (const TankLayer<dim>& layer : near) {
    const std::int64_t k = find_number(next.layer_number, layer.number);
    list.push_back(static_cast<std::int32_t>(k >= 0 ? first + k : state.position.cols() + std::ssize(fresh)));
    if (k < 0) fresh.push_back(&layer);
    number.push_back(layer.number);
    bucket.push_back(layer.bucket);
  }
  for (std::size_t k = tank_layers(next).size(); k < next.layer_number.size(); ++k) {  // of bodies
    list.push_back(static_cast<std::int32_t>(first + static_cast<std::int64_t>(k)));
    number.push_back(next.layer_number[k]);
    bucket.push_back(next.layer_bucket[k]);
  }
  next.layer_number = std::move(number);
  next.layer_bucket = std::move(bucket);
  Eigen::Index at = state.position.cols();
  resize_particles<dim>(state, at + std::ssize(fresh));
  for (const TankLayer<dim>* layer : fresh) {
    const auto i = static_cast<std::size_t>(at);
    state.position.col(at++) = layer->place;
    state.kind[i] = layer->first_layer ? Kind::wall : Kind::dummy_wall;
    state.id[i] = water_of_whole_ + layer->number;
    state.surface[i] = state.air_connected[i] = 1;
  }
  return list;
}

/// Leaves in the state the own water, the tank's layer particles near by, and those of bodies. anew: the
/// boxes of the ranks have changed. Those that have come near get their data from their owners.
template <int dim>
void Subdomain<dim>::choose_layers(State<dim>& state, Division& next, bool anew) {
  if (!tank_.for_each) return;
  const std::int64_t first = std::ssize(next.place);
  std::vector<Bytes> arrived;
  if (!is_read()) arrived = send_tank_layers(state, first);
  if (anew) {
    std::vector<std::int32_t> list(static_cast<std::size_t>(first));
    std::iota(list.begin(), list.end(), 0);
    const auto layers = list_near_layers(state, next);
    list.insert(list.end(), layers.begin(), layers.end());
    select_particles<dim>(state, list);
  }
  const std::size_t each = sizeof(std::int64_t) + bytes_of_particle<dim>(state);
  for (const Bytes& bytes : arrived) {
    const std::byte* from = bytes.data();
    std::vector<std::int32_t> list;
    for (std::size_t k = bytes.size() / each; k > 0; --k)
      list.push_back(
          static_cast<std::int32_t>(first + find_number(next.layer_number, take<std::int64_t>(from))));
    unpack_particles<dim>(from, list, state);
  }
}

template <int dim>
void Subdomain<dim>::gather_bodies(Vectors<dim>& column) const {
  struct Entry {
    std::int64_t place;  // behind the last one, negative
    double value[dim];
  };
  const std::vector<int>& owner = division_->layer_owner;
  Bytes own;
  for (std::size_t k = tank_layers().size(); k < owner.size(); ++k) {
    const std::int64_t place = static_cast<std::int64_t>(k) - std::ssize(owner);
    auto vector = column.col(column.cols() + place);
    if (owner[k] != communicator_->rank()) {
      vector.setZero();
    } else if ((vector.array() != 0).any()) {
      Entry entry{place, {}};
      std::ranges::copy(vector, entry.value);
      append(own, entry);
    }
  }
  for (const Bytes& bytes : communicator_->gather(own))
    for (const std::byte* at = bytes.data(); at < bytes.data() + bytes.size();) {
      const auto entry = take<Entry>(at);
      column.col(column.cols() + entry.place) = Eigen::Map<const Vector<dim>>(entry.value);
    }
}

/// Gives the layer particles that all ranks have all data of their owners.
template <int dim>
void Subdomain<dim>::refresh_layers(State<dim>& state) const {
  if (is_read()) return;
  const std::vector<int>& owner = division_->layer_owner;
  std::vector<std::vector<std::int32_t>> layers_of(static_cast<std::size_t>(communicator_->size()));
  for (std::size_t k = tank_.for_each ? tank_layers().size() : 0; k < owner.size(); ++k)
    layers_of[static_cast<std::size_t>(owner[k])].push_back(
        static_cast<std::int32_t>(local_water() + static_cast<std::int64_t>(k)));
  Bytes own;
  pack_particles<dim>(state, layers_of[static_cast<std::size_t>(communicator_->rank())], own);
  const std::vector<Bytes> all = communicator_->gather(own);
  for (std::size_t r = 0; r < all.size(); ++r) {
    if (static_cast<int>(r) == communicator_->rank()) continue;
    const std::byte* from = all[r].data();
    unpack_particles<dim>(from, layers_of[r], state);
  }
}

#define STRAKE_INSTANTIATE(dim)                                                  \
  template void Subdomain<dim>::find_layer_owners(const State<dim>&, Division&); \
  template void Subdomain<dim>::choose_layers(State<dim>&, Division&, bool);     \
  template void Subdomain<dim>::gather_bodies(Vectors<dim>&) const;              \
  template void Subdomain<dim>::refresh_layers(State<dim>&) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
