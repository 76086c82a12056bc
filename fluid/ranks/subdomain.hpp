#pragma once

#include "fluid/particles/state.hpp"
#include "fluid/ranks/buckets.hpp"
#include "fluid/ranks/halo.hpp"
#include "fluid/ranks/particle_messages.hpp"
#include "fluid/ranks/ranks.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

namespace strake::fluid {

/// Which particles a rank has, and who owns them. The water stands in the order of the whole, layer particles
/// follow. With the state of this rank it is all that a rank needs to go on from there.
struct Division {
  std::vector<std::int64_t> place;  // of each water particle in the whole, ascending
  std::vector<Bucket> bucket;       // of each water particle, when the water was divided
  std::vector<int> owner;           // of each water particle
  std::vector<std::uint8_t> owned;  // of each particle: by this rank
  std::vector<std::uint8_t> outer;  // of each water particle: a ghost of the second ring, without a row
  std::vector<Bucket> layer_bucket;
  bool buckets_hold = false;               // they were read with the state
  std::vector<int> layer_owner;            // of each layer particle; empty: all ranks have the same values
  std::vector<std::uint8_t> layer_absent;  // of each layer particle: far from all water of this rank
  Halo ghosts, near;                       // copies of other ranks' water; those in the first ring alone
  Halo layers;                             // copies of other ranks' layer particles, from the first of them
};

/// The particles of one rank. Each bucket, with the water and the layer particles in it, has one rank as its
/// owner. A rank has the water of its own buckets, and copies of the water in the two rings of buckets around
/// them: its ghosts. It has the layer particles of all walls and bodies; those far from its
/// water have no pairs.
///
/// Sums over the neighbours of water are computed for own particles. What another sum reads of the ghosts is
/// sent by their owners before (`update`). Ghosts of the first ring have rows; those of the second ring are
/// in the rows of others, and have none. A layer particle beside own water has all its water. A particle
/// stays in its bucket until one has left its own by more than a little: reach and width of a bucket differ
/// by more than twice that.
///
/// The local order is that of the whole, with gaps. So a sum over the neighbours of an own particle adds the
/// same numbers in the same order as on one rank, to the last bit.
template <int dim>
class Subdomain {
 public:
  /// slack: how far a particle may be outside its bucket, in widths.
  Subdomain(Communicator&, Partition, const Buckets<dim>&, double slack);

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
  /// Goes back to a division that was noted with that state.
  void adopt(std::shared_ptr<const Division> division) { division_ = std::move(division); }
  /// Whether the part is that of a state that has just been read.
  bool is_read() const { return division_->ghosts.send.empty(); }
  /// Whether the water is to be divided anew: a particle has left its bucket. All ranks agree.
  bool is_due(const State<dim>&) const;
  /// Sorts the water of all ranks along cells of that width [m], as on one rank: gives it new places.
  /// `divide` follows.
  void sort_along_cells(const State<dim>&, double size);
  /// Sends water that has left the own buckets to its new owner, and takes over what has come. Then it copies
  /// the ghosts anew. balance: the boxes of the ranks, `state.rank_boxes`, are made anew as well. They are
  /// made where there are none of so many ranks.
  void divide(State<dim>&, bool balance);
  /// Gives the ghosts the places and velocities of their owners. What else a step reads of a ghost was sent
  /// when it was computed.
  void refresh(State<dim>& state) const {
    update(state.position);
    update(state.velocity);
  }
  /// Returns the whole state on the first rank; the others get its values without particles. division: the
  /// one of that state.
  State<dim> join(const State<dim>&, const Division&) const;
  /// Returns one of equal shares of the whole state, in the order of the whole: of water and layer particles.
  /// The shares of the ranks one behind the other are what `join` returns.
  State<dim> share(const State<dim>&, const Division&) const;

  /// Whether this rank owns the particle with that local number.
  bool owns(std::int64_t i) const { return division_->owned[static_cast<std::size_t>(i)] != 0; }
  /// Whether a place is in a bucket of this rank.
  bool has(const Vector<dim>& place) const { return owner_of(buckets_.of(place)) == communicator_->rank(); }
  /// Whether this rank writes it: it owns it, or all ranks have the same and this is the first one.
  bool shows(std::int64_t i) const {
    return i >= local_water() && division_->layer_owner.empty() ? communicator_->rank() == 0 : owns(i);
  }
  std::int64_t local_water() const { return std::ssize(division_->place); }
  std::int64_t water_of_whole() const { return water_of_whole_; }
  std::int64_t layers() const { return layers_; }

  /// Gives the ghosts the values of their owners. A column has one entry per particle, of the water at least.
  template <class Column>
  void update(Column& column) const {
    division_->ghosts.update(*communicator_, first_byte(column), bytes_of_entry(column));
  }
  /// The same of values that read(i, to) writes to a message and write(i, from) takes from it, of `each`
  /// bytes.
  template <class Read, class Write>
  void update(std::size_t each, const Read& read, const Write& write) const {
    division_->ghosts.update(*communicator_, each, read, write);
  }
  /// The same for ghosts of the first ring alone.
  template <class Column>
  void update_near(Column& column) const {
    division_->near.update(*communicator_, first_byte(column), bytes_of_entry(column));
  }
  template <class Read, class Write>
  void update_near(std::size_t each, const Read& read, const Write& write) const {
    division_->near.update(*communicator_, each, read, write);
  }
  /// Gives the layer particles of bodies, and those of walls that are near water of this rank, the values of
  /// their owners. first: place in the column of the first layer particle.
  template <class Column>
  void update_layers(Column& column, std::int64_t first) const {
    division_->layers.update(*communicator_,
                             first_byte(column) + static_cast<std::size_t>(first) * bytes_of_entry(column),
                             bytes_of_entry(column));
  }
  /// Gives all layer particles the vectors of their owners, most of which are zero. The first is in column
  /// `first`.
  void gather_layers(Vectors<dim>&, std::int64_t first) const;

 private:
  void balance(State<dim>&) const;
  const std::vector<Wanting>& wanted_by(const Bucket&);
  int owner_of(const Bucket& bucket) const {
    return Buckets<dim>::owner(bucket, boxes_, communicator_->rank());
  }
  std::vector<Bytes> exchange_particles(const State<dim>&, const Division&,
                                        std::span<const std::vector<std::int32_t>>) const;
  void append_particles(State<dim>&, const std::vector<Bytes>&, Division&) const;
  void migrate(State<dim>&, Division&) const;
  void copy_ghosts(State<dim>&, Division&);
  void find_layer_owners(const State<dim>&, Division&);
  std::vector<std::vector<std::int32_t>> layers_by_rank(const Division&) const;
  void refresh_layers(State<dim>&) const;

  Communicator* communicator_;
  Partition partition_;
  Buckets<dim> buckets_;
  double slack_;
  std::int64_t water_of_whole_ = 0, layers_ = 0;
  RankBoxes boxes_;
  std::shared_ptr<const Division> division_;
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
  /// Water that is in the rows of others and has none on this rank: a mask, or empty.
  std::span<const std::uint8_t> water_without_row() const {
    return own_ ? std::span<const std::uint8_t>(own_->division().outer) : std::span<const std::uint8_t>();
  }
  /// Layer particles that are far from all water of this rank: a mask, or empty.
  std::span<const std::uint8_t> absent_layers() const {
    return own_ ? std::span<const std::uint8_t>(own_->division().layer_absent)
                : std::span<const std::uint8_t>();
  }
  Communicator* communicator() const { return own_ ? &own_->communicator() : nullptr; }  // nullptr: one rank
  /// Whether particle i belongs to this rank.
  bool owns(std::int64_t i) const { return own_ == nullptr || own_->owns(i); }
  /// Gives the ghosts of this rank the values of their owners.
  template <class Column>
  void update(Column& column) const {
    if (own_) own_->update(column);
  }
  /// The same of values that read(i, to) writes to a message and write(i, from) takes from it, of `each`
  /// bytes.
  template <class Read, class Write>
  void update(std::size_t each, const Read& read, const Write& write) const {
    if (own_) own_->update(each, read, write);
  }
  template <class Column>
  void update_near(Column& column) const {
    if (own_) own_->update_near(column);
  }
  template <class Read, class Write>
  void update_near(std::size_t each, const Read& read, const Write& write) const {
    if (own_) own_->update_near(each, read, write);
  }
  /// Gives layer particles the values of their owners, see Subdomain.
  void gather_layers(Vectors<dim>& column, std::int64_t first) const {
    if (own_) own_->gather_layers(column, first);
  }
  template <class Column>
  void update_layers(Column& column, std::int64_t first) const {
    if (own_) own_->update_layers(column, first);
  }
  double max(double own) const { return own_ ? own_->communicator().max(own) : own; }
  std::int64_t sum(std::int64_t own) const { return own_ ? own_->communicator().sum(own) : own; }
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
  const Subdomain<dim>* own_ = nullptr;
};

}  // namespace strake::fluid
