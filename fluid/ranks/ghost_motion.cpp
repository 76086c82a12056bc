#include "fluid/ranks/ghost_motion.hpp"

#include <array>
#include <cstring>

namespace strake::fluid {

template <int dim>
void GhostMotion<dim>::pack(const State<dim>& state, std::int32_t i, std::byte* to) {
  std::memcpy(to, state.position.col(i).data(), each / 2);
  std::memcpy(to + each / 2, state.velocity.col(i).data(), each / 2);
}

template <int dim>
void GhostMotion<dim>::unpack(const Lists& receive, State<dim>& state) const {
  for (std::size_t r = 0; r < receive.size(); ++r) {
    const std::byte* from = received_[r].data();
    for (const std::int32_t i : receive[r]) {
      std::memcpy(state.position.col(i).data(), from, each / 2);
      std::memcpy(state.velocity.col(i).data(), from + each / 2, each / 2);
      from += each;
    }
  }
}

template <int dim>
void GhostMotion<dim>::send(Communicator& communicator, const Halo& ghosts, State<dim>& state) {
  sent_.resize(ghosts.send.size());
  received_.resize(ghosts.receive.size());
  for (std::size_t r = 0; r < sent_.size(); ++r) {
    sent_[r].resize(ghosts.send[r].size() * each);
    received_[r].resize(ghosts.receive[r].size() * each);
    std::byte* to = sent_[r].data();
    for (const std::int32_t i : ghosts.send[r]) {
      pack(state, i, to);
      to += each;
    }
  }
  communicator.exchange(sent_, received_);
  unpack(ghosts.receive, state);
  noted_ = true;
}

/// Packs what differs from the last message, behind its place in that message, and notes it.
template <int dim>
std::vector<Bytes> GhostMotion<dim>::changes(const Lists& send, const State<dim>& state) {
  std::vector<Bytes> changed(send.size());
  std::array<std::byte, each> now;
  for (std::size_t r = 0; r < send.size(); ++r)
    for (std::size_t k = 0; k < send[r].size(); ++k) {
      pack(state, send[r][k], now.data());
      std::byte* const before = sent_[r].data() + k * each;
      if (std::memcmp(before, now.data(), each) == 0) continue;
      std::memcpy(before, now.data(), each);
      append(changed[r], static_cast<std::uint64_t>(k));
      changed[r].insert(changed[r].end(), now.begin(), now.end());
    }
  return changed;
}

template <int dim>
void GhostMotion<dim>::send_changes(Communicator& communicator, const Halo& ghosts, State<dim>& state) {
  if (!noted_) return send(communicator, ghosts, state);
  const std::vector<Bytes> changed = changes(ghosts.send, state);
  // Ranks that share ghosts tell each other the lengths first.
  std::vector<Bytes> length(changed.size()), lengths(changed.size()), arrived(changed.size());
  for (std::size_t r = 0; r < changed.size(); ++r) {
    if (!ghosts.send[r].empty()) append(length[r], static_cast<std::uint64_t>(changed[r].size()));
    if (!ghosts.receive[r].empty()) lengths[r].resize(sizeof(std::uint64_t));
  }
  communicator.exchange(length, lengths);
  for (std::size_t r = 0; r < arrived.size(); ++r)
    if (!lengths[r].empty()) arrived[r].resize(values_of<std::uint64_t>(lengths[r]).front());
  communicator.exchange(changed, arrived);
  for (std::size_t r = 0; r < arrived.size(); ++r) {
    const std::byte* from = arrived[r].data();
    const std::byte* const end = from + arrived[r].size();
    while (from < end) {
      const auto k = take<std::uint64_t>(from);
      std::memcpy(received_[r].data() + k * each, from, each);
      from += each;
    }
  }
  unpack(ghosts.receive, state);
}

template class GhostMotion<2>;
template class GhostMotion<3>;

}  // namespace strake::fluid
