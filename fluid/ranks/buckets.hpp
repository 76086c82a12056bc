#pragma once

#include "fluid/particles/periodic.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/ranks/rank_boxes.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace strake::fluid {

/// Numbers of a bucket along each axis.
using Bucket = std::array<std::int32_t, 3>;

/// One number for a bucket, and back.
std::int64_t key_of(const Bucket&);
Bucket bucket_with(std::int64_t key);

/// Another rank that wants the particles of a bucket. near: the bucket is in the first ring around its own,
/// else in the second.
struct Wanting {
  int rank;
  bool near;
};

/// Cuts space into buckets a little wider than the radius of the neighbour search, from the tank's corner.
/// Along a periodic direction they are a little wider: a whole number of them repeats itself. Each bucket has
/// one rank as its owner: the rank in whose box it lies.
template <int dim>
class Buckets {
 public:
  /// reach: of the neighbour search [m]. corner: lower corner of the tank [m].
  Buckets(double reach, const Periodic<dim>& periodic, const Vector<dim>& corner);

  Bucket of(const Vector<dim>& x) const;
  Vector<dim> corner_of(const Bucket&) const;  // the lower one [m]
  const Vector<dim>& size() const { return size_; }
  /// How far x is outside a bucket that it has been in, along the worst axis, in widths.
  double outside(const Vector<dim>& x, const Bucket&) const;
  /// Place of a bucket for the partition. Buckets are seen from a slight angle, so that a bound may end
  /// within a slab of them.
  static std::array<double, 3> place(const Bucket&);
  /// Whether the bucket is in the box of that rank.
  static bool owns(int rank, const Bucket& bucket, const RankBoxes& boxes) {
    return boxes.owns(rank, place(bucket));
  }
  /// Whether all places between two along x are of that rank (true), or none is (false). Nothing: it is not
  /// known without those between; of one place it always is.
  std::optional<bool> owns_all(int rank, const Vector<dim>& first, const Vector<dim>& last,
                               const RankBoxes& boxes) const;
  /// Returns the rank whose box has the bucket. first: the rank to look at first.
  static int owner(const Bucket&, const RankBoxes&, int first);
  /// Rings of buckets around the own ones whose water a rank has.
  static constexpr std::int32_t ghost_rings = 2;
  /// Whether a bucket, or one in so many rings around it, belongs to that rank.
  bool is_near(const Bucket&, const RankBoxes&, int rank, std::int32_t rings = ghost_rings) const;
  /// Finds the other ranks that want a bucket of rank `own`.
  void find_wanting(const Bucket&, const RankBoxes&, int own, std::vector<Wanting>&) const;

 private:
  Bucket wrapped(Bucket) const;
  bool is_far(const Bucket&, std::span<const double> box, std::int32_t rings) const;
  Vector<dim> corner_, size_;            // [m]
  std::array<std::int32_t, 3> count_{};  // along periodic directions; 0: without an end
};

}  // namespace strake::fluid
