#pragma once

#include "fluid/particles/periodic.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/ranks/ranks.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace strake::fluid {

/// The particles of one rank. Space is cut into buckets as wide as the reach of the neighbour search. Each
/// bucket, with the water and the layer particles in it, has one rank as its owner. A rank has the water of
/// its own buckets, and copies of the water in the two rings of buckets around them: its ghosts. It has the
/// layer particles of all walls and bodies.
///
/// Two rings are enough for two sums over neighbours in turn. A layer particle beside own water then has all
/// its water. What a third sum would read is sent by its owners before (`update`).
///
/// The local order is that of the whole fluid, with gaps. So a sum over the neighbours of an own particle
/// adds the same numbers in the same order as on one rank, to the last bit.
template <int dim>
class Subdomain {
 public:
  /// reach: of the neighbour search [m]. corner: lower corner of the tank [m].
  Subdomain(Communicator& communicator, Partition partition, double reach, const Periodic<dim>& periodic,
            const Vector<dim>& corner);

  Communicator& communicator() const { return *communicator_; }
  /// Replaces the whole state by the part of this rank. All ranks give the same state. water: its number of
  /// water particles, which come first. Returns the number in the part, ghosts included.
  std::int64_t divide(State<dim>&, std::int64_t water);
  /// Replaces the part by the whole state, from the owners of all particles. Returns the number of its water
  /// particles. All ranks get the same state.
  std::int64_t join(State<dim>&) const;
  /// Whether this rank owns the particle with that local number.
  bool owns(std::int64_t i) const { return owned_[static_cast<std::size_t>(i)] != 0; }
  std::span<const std::uint8_t> owned() const { return owned_; }
  /// Number of each local particle in the whole state.
  std::span<const std::int32_t> places() const { return places_; }
  std::int64_t water_of_whole() const { return water_of_whole_; }
  /// Gives the ghosts the values of their owners. A column has one entry per particle, of the water at least.
  template <class Column>
  void update(Column& column) const {
    send(reinterpret_cast<std::byte*>(column.data()), bytes_of_entry(column));
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
  using Bucket = std::array<std::int32_t, 3>;
  Bucket bucket_of(const Vector<dim>& x) const;
  void find_buckets(const State<dim>&);
  void choose_owners(const State<dim>&);
  void find_rings();
  void list_messages();
  void send(std::byte* column, std::size_t each) const;
  void send_layers(std::byte* column, std::size_t each) const;

  Communicator* communicator_;
  Partition partition_;
  Vector<dim> corner_, size_;            // of the buckets [m]
  std::array<std::int32_t, 3> count_{};  // along periodic directions; 0: without an end
  std::int64_t water_of_whole_ = 0;
  std::vector<Bucket> bucket_;                       // that hold particles, sorted
  std::vector<std::int32_t> bucket_of_;              // of each particle of the whole
  std::vector<int> owner_;                           // of each bucket
  std::vector<std::vector<int>> wanted_by_;          // ranks in whose rings each bucket lies
  std::vector<std::vector<std::int32_t>> owned_by_;  // whole numbers of each rank's particles
  std::vector<std::size_t> own_water_;               // how many of them are water
  std::vector<std::int32_t> places_;
  std::vector<std::uint8_t> owned_;
  std::vector<std::vector<std::int32_t>> send_, receive_;  // local numbers, by rank
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
  bool any(bool own) const { return own_ ? own_->communicator().any(own) : own; }

 private:
  const Subdomain<dim>* own_ = nullptr;
};

}  // namespace strake::fluid
