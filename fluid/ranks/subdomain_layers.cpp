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
  for (const Bucket& bucket : next.layer_bucket) {
    next.layer_owner.push_back(owner_of(bucket));
    next.owned.push_back(next.layer_owner.back() == communicator_->rank() ? 1 : 0);
    const auto [found, is_new] = is_near_.try_emplace(key_of(bucket), true);
    if (is_new) found->second = buckets_.is_near(bucket, boxes_, communicator_->rank());
    next.layer_absent.push_back(found->second ? 0 : 1);
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
void Subdomain<dim>::send_layers(std::byte* column, std::size_t each) const {
  const auto layers_of = layers_by_rank(*division_);
  Bytes own;
  pack(column, each, layers_of[static_cast<std::size_t>(communicator_->rank())], own);
  const std::vector<Bytes> all = communicator_->gather(own);
  for (std::size_t r = 0; r < all.size(); ++r)
    if (static_cast<int>(r) != communicator_->rank()) unpack(all[r].data(), each, layers_of[r], column);
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

#define STRAKE_INSTANTIATE(dim)                                                  \
  template void Subdomain<dim>::find_layer_owners(const State<dim>&, Division&); \
  template void Subdomain<dim>::send_layers(std::byte*, std::size_t) const;      \
  template void Subdomain<dim>::refresh_layers(State<dim>&) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
