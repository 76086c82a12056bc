#pragma once

#include "fluid/particles/state.hpp"
#include "fluid/ranks/buckets.hpp"
#include "fluid/ranks/ghost_motion.hpp"
#include "fluid/ranks/halo.hpp"
#include "fluid/ranks/particle_messages.hpp"
#include "fluid/ranks/ranks.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace strake::fluid {

/// Rings of buckets around those of a rank, whose water it has copies of.
enum class Rings { first, both };

/// Which particles a rank has, and who owns them. The water stands in the order of the whole, layer particles
/// follow. With the state of this rank it is all that a rank needs to go on from there.
struct Division {
  std::vector<std::int64_t> place;         // of each water particle in the whole, ascending
  std::vector<Bucket> bucket;              // of each water particle, when the water was divided
  std::vector<int> owner;                  // of each water particle
  std::vector<std::uint8_t> owned;         // of each particle: by this rank
  std::vector<std::int64_t> layer_number;  // of each layer particle in the whole, ascending
  std::vector<Bucket> layer_bucket;        // of each layer particle
  bool buckets_hold = false;               // they were read with the state
  std::vector<int> layer_owner;            // of each layer particle
  std::vector<std::uint8_t> layer_absent;  // of each layer particle: far from all water of this rank
  Halo ghosts, near;                       // copies of other ranks' water; those in the first ring alone
  Halo layers;                             // copies of other ranks' layer particles, from the first of them

  const Halo& halo(Rings rings) const { return rings == Rings::both ? ghosts : near; }
  /// Whether each particle has an owner. Before, all ranks have the same layer particles.
  bool is_divided() const { return !ghosts.send.empty(); }
};

/// The layer particles of the tank, which come before those of bodies.
template <int dim>
struct TankLayers {
  std::int64_t count = 0;  // in the whole
  /// Calls visit(number, place, is in the first layer) for all of them, in any order. Empty: the tank moves,
  /// and each rank has them all.
  std::function<void(const std::function<void(std::int64_t, const Vector<dim>&, bool)>& visit)> for_each;
};

/// The particles of one rank. Each bucket, with the water and the layer particles in it, has one rank as its
/// owner. A rank has the water of its own buckets, and copies of the water in the two rings of buckets around
/// them: its ghosts. It has the layer particles of all bodies, and of a tank at rest those in
/// the same buckets, with the first layers that they extend. Layer particles far from its water have no
/// pairs.
///
/// Sums over the neighbours of water are computed for own particles. What another sum reads of the ghosts is
/// sent by their owners before (`update`). Ghosts are in the rows of others, and have none. The first ring
/// has all neighbours of own water; with the second one a layer particle beside own water has all its water.
/// A particle stays in its bucket until one has left its own by more than a little: radius and width of a
/// bucket differ by more than twice that.
///
/// The local order is that of the whole, with gaps. So a sum over the neighbours of an own particle adds the
/// same numbers in the same order as on one rank, to the last bit.
template <int dim>
class Subdomain {
 public:
  /// slack: how far a particle may be outside its bucket, in widths.
  Subdomain(Communicator&, Partition, const Buckets<dim>&, double slack, TankLayers<dim>);

  Communicator& communicator() const { return *communicator_; }
  const Buckets<dim>& buckets() const { return buckets_; }
  const Division& division() const { return *division_; }
  std::shared_ptr<const Division> shared_division() const { return division_; }

  /// Replaces the whole state by a part of it, one of equal parts in the order of the whole; `divide`
  /// follows. water: its number of water particles, which come first.
  void take_part(State<dim>&, std::int64_t water);
  /// The ranges of the whole that `take_share` needs: the part of the water that `take_part` would keep, and
  /// all layer particles. Known once the whole has been divided for the first time.
  std::vector<std::array<std::int64_t, 2>> ranges_of_part() const;
  /// The same as `take_part` with a state that holds those ranges alone.
  void take_share(State<dim>&);
  /// The same at the start, with a share of that much water and the layer particles of bodies, but none of
  /// the tank. Numbers the latter (State::id).
  void take_start(State<dim>&, std::int64_t water);
  /// Goes back to a division that was noted with that state, and to its boxes.
  void adopt(std::shared_ptr<const Division> division, const State<dim>& state) {
    division_ = std::move(division);
    motion_.forget();
    if (has_boxes(state)) take_boxes(state);
  }
  /// Whether the part is that of a state that has just been read.
  bool is_read() const { return !division_->is_divided(); }
  /// Whether the water is to be divided anew: a particle has left its bucket. All ranks agree.
  bool is_due(const State<dim>&) const;
  /// Sorts the water of all ranks along cells of that width [m], as on one rank: gives it new places.
  /// `divide` follows.
  void sort_along_cells(const State<dim>&, double size);
  /// Sends water that has left the own buckets to its new owner, and takes over what has come. Then it copies
  /// the ghosts anew. balance: the boxes of the ranks, `state.rank_boxes`, are made anew as well. They are
  /// made where there are none of so many ranks.
  void divide(State<dim>&, bool balance);
  /// Gives the ghosts the places and velocities of their owners, at the end of a step.
  void send_motion(State<dim>& state) const { motion_.send(*communicator_, division_->ghosts, state); }
  /// The same before the next step. Of what was sent then it sends the changes alone. What else a step reads
  /// of a ghost was sent when it was computed.
  void refresh(State<dim>& state) const { motion_.send_changes(*communicator_, division_->ghosts, state); }
  /// Returns the whole state on the first rank; the others get its values without particles. division: the
  /// one of that state.
  State<dim> join(const State<dim>&, const Division&) const;
  /// Returns one of equal shares of the whole state, in the order of the whole: of water and layer particles.
  /// The shares of the ranks one behind the other are what `join` returns.
  State<dim> share(const State<dim>&, const Division&) const;

  /// Whether this rank owns the particle with that local number.
  bool owns(std::int64_t i) const { return division_->owned[static_cast<std::size_t>(i)] != 0; }
  /// Whether the places between two along x are all in buckets of this rank, or all in those of others.
  /// Nothing: shorter stretches must be asked for.
  std::optional<bool> has_all(const Vector<dim>& first, const Vector<dim>& last) const {
    return buckets_.owns_all(communicator_->rank(), first, last, boxes_);
  }
  /// Whether this rank writes it: it owns it, or all ranks have the same and this is the first one.
  bool shows(std::int64_t i) const {
    return i >= local_water() && is_read() ? communicator_->rank() == 0 : owns(i);
  }
  std::int64_t local_water() const { return std::ssize(division_->place); }
  std::int64_t water_of_whole() const { return water_of_whole_; }
  std::int64_t layers_of_whole() const { return layers_; }
  /// Numbers of the tank's layer particles that this rank has.
  std::span<const std::int64_t> tank_layers() const { return tank_layers(*division_); }

  /// Gives the layer particles of bodies, and those of walls that are near water of this rank, the values of
  /// their owners. first: place in the column of the first layer particle.
  template <class Column>
  void update_layers(Column& column, std::int64_t first) const {
    division_->layers.update(*communicator_,
                             first_byte(column) + static_cast<std::size_t>(first) * bytes_of_entry(column),
                             bytes_of_entry(column));
  }
  /// Gives the layer particles of bodies, which are the last ones, the vectors of their owners. Most of them
  /// are zero.
  void gather_bodies(Vectors<dim>&) const;

 private:
  bool has_boxes(const State<dim>& state) const {
    return state.rank_boxes.size() == 6 * communicator_->size();
  }
  bool take_boxes(const State<dim>&);
  void balance(State<dim>&) const;
  const std::vector<Wanting>& wanted_by(const Bucket&);
  int owner_of(const Bucket& bucket) const {
    return Buckets<dim>::owner(bucket, boxes_, communicator_->rank());
  }
  std::vector<Bytes> exchange_particles(const State<dim>&, const Division&,
                                        std::span<const std::vector<std::int32_t>>) const;
  void append_particles(State<dim>&, const std::vector<Bytes>&, Division&) const;
  void migrate(State<dim>&, Division&) const;
  void choose_layers(State<dim>&, Division&, bool anew);
  std::vector<Bytes> send_tank_layers(const State<dim>&, std::int64_t first);
  std::vector<std::int32_t> list_near_layers(State<dim>&, Division&) const;
  void copy_ghosts(State<dim>&, Division&);
  void find_layer_owners(const State<dim>&, Division&);
  void refresh_layers(State<dim>&) const;
  std::span<const std::int64_t> tank_layers(const Division& of) const {
    return {of.layer_number.begin(), std::ranges::lower_bound(of.layer_number, tank_.count)};
  }

  Communicator* communicator_;
  Partition partition_;
  Buckets<dim> buckets_;
  double slack_;
  TankLayers<dim> tank_;
  std::int64_t water_of_whole_ = 0, layers_ = 0;  // in the whole
  RankBoxes boxes_;                               // of `division_`
  std::shared_ptr<const Division> division_;
  mutable GhostMotion<dim> motion_;                                   // of `division_`
  std::unordered_map<std::int64_t, std::vector<Wanting>> wanted_by_;  // of each own bucket
  std::unordered_map<std::int64_t, bool> is_near_;                    // of buckets of layers
};

/// What the stages of a step ask of the other ranks. On one rank it does nothing.
template <int dim>
class RankExchange {
 public:
  RankExchange() = default;
  explicit RankExchange(const Subdomain<dim>* own) : own_(own) {}
  const Subdomain<dim>* subdomain() const { return own_; }
  bool several() const { return own_ != nullptr; }
  /// Particles of this rank: a mask, or empty for all. Water of others is in the rows of others alone.
  std::span<const std::uint8_t> owned() const {
    return own_ ? std::span<const std::uint8_t>(own_->division().owned) : std::span<const std::uint8_t>();
  }
  /// Own water that other ranks have copies of in their first ring, ascending.
  std::vector<std::int32_t> water_near_others() const {
    std::vector<std::int32_t> list;
    if (!own_) return list;
    for (const auto& sent : halo(Rings::first).send) list.insert(list.end(), sent.begin(), sent.end());
    std::ranges::sort(list);
    list.erase(std::ranges::unique(list).begin(), list.end());
    return list;
  }
  /// Layer particles that are far from all water of this rank: a mask, or empty.
  std::span<const std::uint8_t> absent_layers() const {
    return own_ ? std::span<const std::uint8_t>(own_->division().layer_absent)
                : std::span<const std::uint8_t>();
  }
  Communicator* communicator() const { return own_ ? &own_->communicator() : nullptr; }  // nullptr: one rank
  /// Whether particle i belongs to this rank.
  bool owns(std::int64_t i) const { return own_ == nullptr || own_->owns(i); }
  /// Gives the ghosts of this rank the values of their owners. A column has one entry per particle, of the
  /// water at least.
  template <class Column>
  void update(Column& column, Rings rings = Rings::both) const {
    if (own_) halo(rings).update(own_->communicator(), first_byte(column), bytes_of_entry(column));
  }
  /// The same of values that read(i, to) writes to a message and write(i, from) takes from it, of `each`
  /// bytes.
  template <class Read, class Write>
  void update(std::size_t each, const Read& read, const Write& write, Rings rings = Rings::both) const {
    if (own_) halo(rings).update(own_->communicator(), each, read, write);
  }
  /// The same in the first ring, of those alone of which counts(i) is true, on their owners and here.
  template <class Counts, class Read, class Write>
  void update_some(const Counts& counts, std::size_t each, const Read& read, const Write& write) const {
    if (!own_) return;
    const Halo& near = halo(Rings::first);
    Halo some;
    some.clear(own_->communicator().size());
    for (std::size_t r = 0; r < near.send.size(); ++r) {
      std::ranges::copy_if(near.send[r], std::back_inserter(some.send[r]), counts);
      std::ranges::copy_if(near.receive[r], std::back_inserter(some.receive[r]), counts);
    }
    some.update(own_->communicator(), each, read, write);
  }
  /// Gives the ghosts the places and velocities of their owners, see Subdomain.
  void send_motion(State<dim>& state) const {
    if (own_) own_->send_motion(state);
  }
  /// Gives layer particles of bodies the values of their owners, see Subdomain.
  void gather_bodies(Vectors<dim>& column) const {
    if (own_) own_->gather_bodies(column);
  }
  template <class Column>
  void update_layers(Column& column, std::int64_t first) const {
    if (own_) own_->update_layers(column, first);
  }
  double max(double own) const { return own_ ? own_->communicator().max(own) : own; }
  std::int64_t sum(std::int64_t own) const { return own_ ? own_->communicator().sum(own) : own; }
  double sum(double own) const {
    if (!own_) return own;
    double total = 0;
    for (const double of : own_->communicator().all(own)) total += of;
    return total;
  }
  Vector<dim> sum(const Vector<dim>& own) const {
    if (!own_) return own;
    std::array<double, dim> part;
    std::ranges::copy(own, part.begin());
    Vector<dim> total = Vector<dim>::Zero();
    for (const auto& of : own_->communicator().all(part)) total += Eigen::Map<const Vector<dim>>(of.data());
    return total;
  }
  bool any(bool own) const { return own_ ? own_->communicator().any(own) : own; }

 private:
  const Halo& halo(Rings rings) const { return own_->division().halo(rings); }
  const Subdomain<dim>* own_ = nullptr;
};

}  // namespace strake::fluid
