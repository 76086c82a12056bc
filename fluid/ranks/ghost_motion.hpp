#pragma once

#include "fluid/particles/state.hpp"
#include "fluid/ranks/halo.hpp"

#include <vector>

namespace strake::fluid {

/// Places and velocities of ghosts. It notes what was sent, so that what has not changed is not sent again:
/// between the end of a step and the next one collisions move few particles. All ranks call each function
/// together.
template <int dim>
class GhostMotion {
 public:
  /// Gives the ghosts the places and velocities of their owners.
  void send(Communicator&, const Halo& ghosts, State<dim>&);
  /// The same to the last bit: sends what differs from the last message, and undoes what this rank has
  /// changed in its ghosts. Without a last message it sends all.
  void send_changes(Communicator&, const Halo& ghosts, State<dim>&);
  /// The ghosts are others, or the state is an earlier one.
  void forget() { noted_ = false; }

 private:
  using Lists = std::vector<std::vector<std::int32_t>>;
  static constexpr std::size_t each = 2 * dim * sizeof(double);  // of a message: place and velocity
  static void pack(const State<dim>&, std::int32_t i, std::byte* to);
  void unpack(const Lists& receive, State<dim>&) const;
  std::vector<Bytes> changes(const Lists& send, const State<dim>&);

  bool noted_ = false;
  std::vector<Bytes> sent_, received_;  // the last messages, of all ghosts
};

}  // namespace strake::fluid
