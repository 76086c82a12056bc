#include "fluid/particles/columns.hpp"
#include "fluid/ranks/subdomain.hpp"

#include <algorithm>
#include <utility>

// Equal shares of the whole, in its order: as files hold it.

namespace strake::fluid {

namespace {

/// What goes with a particle to the rank that writes it, before its columns.
struct Placed {
  std::int64_t place, bucket;
};

}  // namespace

template <int dim>
std::vector<std::array<std::int64_t, 2>> Subdomain<dim>::ranges_of_part() const {
  const std::int64_t ranks = communicator_->size(), rank = communicator_->rank();
  return {{begin_of_share(water_of_whole_, ranks, rank), begin_of_share(water_of_whole_, ranks, rank + 1)},
          {water_of_whole_, water_of_whole_ + layers_}};
}

template <int dim>
void Subdomain<dim>::take_start(State<dim>& state, std::int64_t water) {
  const std::int64_t ranks = communicator_->size(), rank = communicator_->rank(),
                     own = begin_of_share(water, ranks, rank + 1) - begin_of_share(water, ranks, rank);
  water_of_whole_ = water;
  layers_ = tank_.count + state.position.cols() - own;
  take_share(state);
  for (std::size_t k = 0; k < division_->layer_number.size(); ++k)
    state.id[static_cast<std::size_t>(own) + k] = water + division_->layer_number[k];
}

template <int dim>
void Subdomain<dim>::take_share(State<dim>& state) {
  const auto [begin, end] = ranges_of_part().front();
  const std::int64_t water = end - begin, layers = state.position.cols() - water;
  const auto noted = [&](std::int64_t i) {
    return bucket_with(state.rank_buckets[static_cast<std::size_t>(i)]);
  };
  bool divided = std::ssize(state.rank_buckets) == water + layers &&
                 state.rank_boxes.size() == 6 * communicator_->size();
  // A file of a program with buckets of another width has places far outside of them.
  for (std::int64_t i = 0; divided && i < water + layers; ++i)
    divided = buckets_.outside(state.position.col(i), noted(i)) <= 0.5;
  divided = !communicator_->any(!divided);
  Division part;
  for (std::int64_t i = 0; i < water; ++i) {
    part.place.push_back(begin + i);
    part.bucket.push_back(divided ? noted(i) : buckets_.of(state.position.col(i)));
  }
  part.buckets_hold = divided;
  part.owner.assign(part.place.size(), communicator_->rank());
  part.owned.assign(part.place.size(), 1);
  part.owned.resize(part.place.size() + static_cast<std::size_t>(layers));
  for (std::int64_t i = water; i < water + layers; ++i) {
    part.layer_number.push_back(layers_ - layers + i - water);
    part.layer_bucket.push_back(divided ? noted(i) : buckets_.of(state.position.col(i)));
  }
  state.rank_buckets.clear();
  division_ = std::make_shared<Division>(std::move(part));
  motion_.forget();
}

template <int dim>
State<dim> Subdomain<dim>::share(const State<dim>& state, const Division& division) const {
  const std::int64_t water = std::ssize(division.place), all = water_of_whole_ + layers_,
                     ranks = communicator_->size(), own = communicator_->rank();
  const bool same_layers = !division.is_divided();
  std::vector<std::vector<std::int32_t>> list(static_cast<std::size_t>(ranks));
  std::vector<Bytes> to(static_cast<std::size_t>(ranks));
  std::size_t rank = 0;
  for (std::int64_t i = 0; i < water + std::ssize(division.layer_number); ++i) {  // in the order of the whole
    const auto at = static_cast<std::size_t>(i), layer = static_cast<std::size_t>(i - water);
    if (i >= water && same_layers ? own != 0 : division.owned[at] == 0) continue;
    const std::int64_t place =
        i < water ? division.place[at] : water_of_whole_ + division.layer_number[layer];
    while (place >= begin_of_share(all, ranks, static_cast<std::int64_t>(rank) + 1)) ++rank;
    list[rank].push_back(static_cast<std::int32_t>(i));
    append(to[rank], Placed{place, key_of(i < water ? division.bucket[at] : division.layer_bucket[layer])});
  }
  for (std::size_t r = 0; r < to.size(); ++r) pack_particles<dim>(state, list[r], to[r]);

  State<dim> share;
  for_each_value([](const char*, const auto& from, auto& copy) { copy = from; }, state, share);
  const std::int64_t begin = begin_of_share(all, ranks, own),
                     size = begin_of_share(all, ranks, own + 1) - begin;
  resize_particles<dim>(share, size);
  share.rank_buckets.resize(static_cast<std::size_t>(size));
  const std::size_t each = sizeof(Placed) + bytes_of_particle<dim>(share);
  for (const Bytes& bytes : communicator_->exchange_any(to)) {
    const std::byte* from = bytes.data();
    std::vector<std::int32_t> places;
    for (std::size_t k = bytes.size() / each; k > 0; --k) {
      const auto one = take<Placed>(from);
      places.push_back(static_cast<std::int32_t>(one.place - begin));
      share.rank_buckets[static_cast<std::size_t>(places.back())] = one.bucket;
    }
    unpack_particles<dim>(from, places, share);
  }
  if (same_layers) share.rank_buckets.clear();
  return share;
}

#define STRAKE_INSTANTIATE(dim)                                                             \
  template std::vector<std::array<std::int64_t, 2>> Subdomain<dim>::ranges_of_part() const; \
  template void Subdomain<dim>::take_share(State<dim>&);                                    \
  template void Subdomain<dim>::take_start(State<dim>&, std::int64_t);                      \
  template State<dim> Subdomain<dim>::share(const State<dim>&, const Division&) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
