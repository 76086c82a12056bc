#include "fluid/ranks/subdomain.hpp"

// The layer particles of walls and bodies: all ranks have them, one owns each.

namespace strake::fluid {

template <int dim>
void Subdomain<dim>::find_layer_owners(const State<dim>& state, Division& next) {
  const std::int64_t first = state.position.cols() - layers_;
  if (std::ssize(next.layer_bucket) != layers_) {
    next.layer_bucket.clear();
    for (std::int64_t k = 0; k < layers_; ++k)
      next.layer_bucket.push_back(buckets_.of(state.position.col(first + k)));
  }
  const int own = communicator_->rank();
  next.layers.clear(communicator_->size());
  for (std::int64_t k = 0; k < layers_; ++k) {
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

/// The layer particles of each rank, from the first one.
template <int dim>
std::vector<std::vector<std::int32_t>> Subdomain<dim>::layers_by_rank(const Division& division) const {
  std::vector<std::vector<std::int32_t>> list(static_cast<std::size_t>(communicator_->size()));
  for (std::size_t k = 0; k < division.layer_owner.size(); ++k)
    list[static_cast<std::size_t>(division.layer_owner[k])].push_back(static_cast<std::int32_t>(k));
  return list;
}

template <int dim>
void Subdomain<dim>::gather_layers(Vectors<dim>& column, std::int64_t first) const {
  struct Entry {
    std::int64_t layer;
    double value[dim];
  };
  const std::vector<int>& owner = division_->layer_owner;
  Bytes own;
  for (std::size_t k = 0; k < owner.size(); ++k) {
    auto vector = column.col(first + static_cast<Eigen::Index>(k));
    if (owner[k] != communicator_->rank()) {
      vector.setZero();
    } else if ((vector.array() != 0).any()) {
      Entry entry{static_cast<std::int64_t>(k), {}};
      std::ranges::copy(vector, entry.value);
      append(own, entry);
    }
  }
  for (const Bytes& bytes : communicator_->gather(own))
    for (const std::byte* at = bytes.data(); at < bytes.data() + bytes.size();) {
      const auto entry = take<Entry>(at);
      column.col(first + entry.layer) = Eigen::Map<const Vector<dim>>(entry.value);
    }
}

/// Gives all layer particles all data of their owners.
template <int dim>
void Subdomain<dim>::refresh_layers(State<dim>& state) const {
  if (division_->layer_owner.empty()) return;
  auto layers_of = layers_by_rank(*division_);
  const std::int64_t first = local_water();
  for (auto& list : layers_of)
    for (std::int32_t& i : list) i = static_cast<std::int32_t>(i + first);
  Bytes own;
  pack_particles<dim>(state, layers_of[static_cast<std::size_t>(communicator_->rank())], own);
  const std::vector<Bytes> all = communicator_->gather(own);
  for (std::size_t r = 0; r < all.size(); ++r) {
    if (static_cast<int>(r) == communicator_->rank()) continue;
    const std::byte* from = all[r].data();
    unpack_particles<dim>(from, layers_of[r], state);
  }
}

#define STRAKE_INSTANTIATE(dim)                                                   \
  template void Subdomain<dim>::find_layer_owners(const State<dim>&, Division&);  \
  template void Subdomain<dim>::gather_layers(Vectors<dim>&, std::int64_t) const; \
  template void Subdomain<dim>::refresh_layers(State<dim>&) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
