#pragma once

#include "fluid/particles/periodic.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/ranks/communicator.hpp"
#include "fluid/ranks/halo.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <unordered_map>
#include <vector>

namespace strake::fluid {

/// Numbers of a bucket along each axis.
using Bucket = std::array<std::int32_t, 3>;

/// The particles of one rank. Space is cut into buckets as wide as the reach of the neighbour search. Each
/// bucket, with the water and the layer particles in it, has one rank as its owner. A rank has the water of
/// its own buckets, and copies of the water in the two rings of buckets around them: its ghosts. It has the
/// layer particles of all walls and bodies.
///
/// Two rings are enough for two sums over neighbours in turn. A layer particle beside own water then has all
/// its water. What a third sum would read is sent by its owners before (`update`).
///
/// Each water particle has a place in the whole, and the local order is that of the whole, with gaps. So a
/// sum over the neighbours of an own particle adds the same numbers in the same order as on one rank, to the
/// last bit.
template <int dim>
class Subdomain {
 public:
  /// reach: of the neighbour search [m]. corner: lower corner of the tank [m].
  Subdomain(Communicator& communicator, Partition partition, double reach, const Periodic<dim>& periodic,
            const Vector<dim>& corner);

  Communicator& communicator() const { return *communicator_; }
  /// Which of the local particles are own, and where they stand in the whole. With the state it is all that
  /// a rank needs to go on from there.
  struct Division {
    std::vector<std::int64_t> place;  // of each water particle in the whole
    std::vector<std::uint8_t> owned;  // of each particle
    std::vector<int> layer_owner;     // of each layer particle; empty: all ranks have the same values
  };
  const Division& division() const { return division_; }

  /// Replaces the whole state by a part of it, one of equal parts in the order of the whole; `divide`
  /// follows. water: its number of water particles, which come first.
  void take_part(State<dim>&, std::int64_t water);
  /// Goes back to a division that was noted with that state; `divide` follows.
  void adopt(const Division& division);
  /// Sends water that has left the own buckets to its new owner, and takes over what has come. Then it renews
  /// the ghosts. `state.rank_boxes` are the ranks' boxes; where there are none of so many ranks, or `balance`
  /// is set, they are made. Returns the number of local water particles.
  std::int64_t divide(State<dim>&, bool balance);
  /// Sorts the water of all ranks along cells of that width [m], as on one rank: gives it new places.
  /// `divide` follows.
  void sort_along_cells(const State<dim>&, double size);
  /// Returns the whole state on the first rank; the others get its values without particles. division: the
  /// one of that state.
  State<dim> join(const State<dim>&, const Division&) const;

  /// Whether this rank owns the particle with that local number.
  bool owns(std::int64_t i) const { return division_.owned[static_cast<std::size_t>(i)] != 0; }
  std::span<const std::uint8_t> owned() const { return division_.owned; }
  /// Place of each local water particle in the whole; layer particles follow in their order.
  std::span<const std::int64_t> places() const { return division_.place; }
  std::int64_t local_water() const { return static_cast<std::int64_t>(owner_.size()); }
  std::int64_t water_of_whole() const { return water_of_whole_; }
  std::int64_t layers() const { return layers_; }
  /// Bucket and owner of each local water particle. They hold until the water moves.
  std::span<const Bucket> buckets() const { return bucket_; }
  std::span<const int> owners() const { return owner_; }
  /// The copies in the first ring of buckets alone.
  const Halo& near_halo() const { return near_; }
  std::int32_t buckets_along(int axis) const { return count_[static_cast<std::size_t>(axis)]; }
  Vector<dim> corner_of(const Bucket& bucket) const;
  const Vector<dim>& bucket_size() const { return size_; }

  /// Gives the ghosts the values of their owners. A column has one entry per particle, of the water at least.
  template <class Column>
  void update(Column& column) const {
    ghosts_.update(*communicator_, reinterpret_cast<std::byte*>(column.data()), bytes_of_entry(column));
  }
  /// Gives all layer particles the values of their owners. first: place in the column of the first of them.
  template <class Column>
  void update_layers(Column& column, std::int64_t first) const {
    send_layers(reinterpret_cast<std::byte*>(column.data()) +
                    static_cast<std::size_t>(first) * bytes_of_entry(column),
                bytes_of_entry(column));
  }
  template <class Column>
  static std::size_t bytes_of_entry(const Column& column) {
    using Entry = std::remove_cvref_t<decltype(*column.data())>;
    static_assert(std::is_trivially_copyable_v<Entry>);
    if constexpr (requires { column.rows(); })
      return sizeof(Entry) * (Column::ColsAtCompileTime == 1 ? 1 : static_cast<std::size_t>(column.rows()));
    else
      return sizeof(Entry);
  }

 private:
  Bucket bucket_of(const Vector<dim>& x) const;
  Bucket wrapped(Bucket) const;
  int owner_of(const Bucket&) const;
  void balance(State<dim>&) const;
  const std::vector<std::pair<int, bool>>& wanted_by(const Bucket&);
  void find_wanting(const Bucket&, std::vector<std::pair<int, bool>>& ranks) const;
  std::vector<Bytes> exchange_particles(const State<dim>&, std::span<const std::vector<std::int32_t>>) const;
  void append_particles(State<dim>&, const std::vector<Bytes>&, std::vector<std::int64_t>& place) const;
  void migrate(State<dim>&);
  void add_ghosts(State<dim>&);
  void find_layer_owners(const State<dim>&);
  void list_layers();
  void send_layers(std::byte* column, std::size_t each) const;

  Communicator* communicator_;
  Partition partition_;
  Vector<dim> corner_, size_;            // of the buckets [m]
  std::array<std::int32_t, 3> count_{};  // along periodic directions; 0: without an end
  std::int64_t water_of_whole_ = 0, layers_ = 0;
  std::vector<double> boxes_;  // of the ranks
  Division division_;
  std::vector<Bucket> bucket_;
  std::vector<int> owner_;
  std::vector<std::vector<std::int32_t>> layers_of_;  // of each rank, from the first layer particle
  Halo ghosts_, near_;
  std::unordered_map<std::uint64_t, std::vector<std::pair<int, bool>>> wanted_by_;  // of each own bucket
};

/// What the stages of a step ask of the other ranks. On one rank it does nothing.
template <int dim>
class RankExchange {
 public:
  RankExchange() = default;
  explicit RankExchange(const Subdomain<dim>* own) : own_(own) {}
  const Subdomain<dim>* subdomain() const { return own_; }
  bool several() const { return own_ != nullptr; }
  /// Whether particle i belongs to this rank.
  bool owns(std::int64_t i) const { return own_ == nullptr || own_->owns(i); }
  /// Gives the ghosts of this rank the values of their owners.
  template <class Column>
  void update(Column& column) const {
    if (own_) own_->update(column);
  }
  /// Gives all layer particles the values of their owners. first: place in the column of the first of them.
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
