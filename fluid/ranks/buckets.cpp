#include "fluid/ranks/buckets.hpp"

#include <algorithm>
#include <cmath>

namespace strake::fluid {

namespace {

/// Largest number of a bucket; places beyond belong to the last.
constexpr std::int32_t most = 1 << 20;
constexpr int bits = 21;
/// Slope of the view of `place`.
constexpr double slope = 1e-4;

}  // namespace

std::int64_t key_of(const Bucket& bucket) {
  std::int64_t key = 0;
  for (const std::int32_t at : bucket) key = key << bits | (at + most);
  return key;
}

Bucket bucket_with(std::int64_t key) {
  Bucket bucket;
  for (std::size_t d = 3; d-- > 0; key >>= bits)
    bucket[d] = static_cast<std::int32_t>(key & ((std::int64_t{1} << bits) - 1)) - most;
  return bucket;
}

template <int dim>
Buckets<dim>::Buckets(double reach, const Periodic<dim>& periodic, const Vector<dim>& corner)
    : corner_(corner), size_(Vector<dim>::Constant(reach)) {
  for (int d = 0; d < dim; ++d) {
    if (!periodic.along(d)) continue;
    auto& count = count_[static_cast<std::size_t>(d)];
    count = std::max(1, static_cast<std::int32_t>(periodic.length()[d] / reach));
    size_[d] = periodic.length()[d] / count;
  }
}

template <int dim>
Bucket Buckets<dim>::wrapped(Bucket bucket) const {
  for (std::size_t d = 0; d < dim; ++d)
    if (count_[d] > 0) bucket[d] = ((bucket[d] % count_[d]) + count_[d]) % count_[d];
  return bucket;
}

template <int dim>
Bucket Buckets<dim>::of(const Vector<dim>& x) const {
  Bucket bucket{};
  for (int d = 0; d < dim; ++d) {
    const double at = std::floor((x[d] - corner_[d]) / size_[d]);
    // Not a number goes to the first bucket.
    bucket[static_cast<std::size_t>(d)] =
        at == at ? static_cast<std::int32_t>(std::clamp<double>(at, -most, most - 1)) : 0;
  }
  return wrapped(bucket);
}

template <int dim>
Vector<dim> Buckets<dim>::corner_of(const Bucket& bucket) const {
  Vector<dim> x = corner_;
  for (int d = 0; d < dim; ++d) x[d] += bucket[static_cast<std::size_t>(d)] * size_[d];
  return x;
}

template <int dim>
double Buckets<dim>::outside(const Vector<dim>& x, const Bucket& bucket) const {
  const Vector<dim> low = corner_of(bucket);
  double worst = 0;
  for (int d = 0; d < dim; ++d) {
    const double at = (x[d] - low[d]) / size_[d], past = std::max(-at, at - 1);
    worst = std::max(worst, past);
    // A place beyond the last bucket stays in it.
    const std::int32_t number = bucket[static_cast<std::size_t>(d)];
    if (number <= -most || number >= most - 1) worst = 0;
  }
  return worst;
}

template <int dim>
std::array<double, 3> Buckets<dim>::place(const Bucket& b) {
  return {b[0] + slope * b[1] + slope * slope * b[2], b[1] + slope * b[2] + slope * slope * b[0],
          b[2] + slope * b[0] + slope * slope * b[1]};
}

template <int dim>
int Buckets<dim>::owner(const Bucket& bucket, const RankBoxes& boxes, int first) {
  const std::array<double, 3> at = place(bucket);
  return boxes.owns(first, at) ? first : boxes.owner(at);
}

/// A bucket's number grows with x, and the box is convex: the buckets between two of its own are its own,
/// unless the tank repeats itself there.
template <int dim>
std::optional<bool> Buckets<dim>::owns_all(int rank, const Vector<dim>& first, const Vector<dim>& last,
                                           const RankBoxes& boxes) const {
  const Bucket from = of(first), to = of(last);
  if (from == to && (count_[0] == 0 || last[0] - first[0] < size_[0]))
    return owner(from, boxes, rank) == rank;
  if (count_[0] == 0 && owns(rank, from, boxes) && owns(rank, to, boxes)) return true;
  return std::nullopt;
}

/// Whether the bucket is farther than so many rings from a box of `place`, which six numbers give. Most
/// buckets of a long wall are. Along a periodic direction none counts as far.
template <int dim>
bool Buckets<dim>::is_far(const Bucket& bucket, std::span<const double> box, std::int32_t rings) const {
  const std::array<double, 3> at = place(bucket);
  const double turns = slope * (std::max({count_[0], count_[1], count_[2]}) + rings),
               past = rings + 2 * turns;
  for (std::size_t d = 0; d < dim; ++d)
    if (count_[d] == 0 && (at[d] + past < box[d] || at[d] - past > box[3 + d])) return true;
  return false;
}

template <int dim>
bool Buckets<dim>::is_near(const Bucket& bucket, const RankBoxes& boxes, int rank, std::int32_t rings) const {
  if (is_far(bucket, boxes.values().subspan(6 * static_cast<std::size_t>(rank), 6), rings)) return false;
  const std::int32_t deep = dim == 3 ? rings : 0;
  for (std::int32_t z = -deep; z <= deep; ++z)
    for (std::int32_t y = -rings; y <= rings; ++y)
      for (std::int32_t x = -rings; x <= rings; ++x)
        if (owns(rank, wrapped({bucket[0] + x, bucket[1] + y, bucket[2] + z}), boxes)) return true;
  return false;
}

/// Buckets of one rank lie in a convex set: where the corners around are own, all between is.
template <int dim>
void Buckets<dim>::find_wanting(const Bucket& bucket, const RankBoxes& boxes, int own,
                                std::vector<Wanting>& ranks) const {
  constexpr std::int32_t rings = ghost_rings;
  const std::int32_t deep = dim == 3 ? rings : 0;
  const auto at = [&](std::int32_t x, std::int32_t y, std::int32_t z) {
    return Bucket{bucket[0] + x, bucket[1] + y, bucket[2] + z};
  };
  bool inside = true;
  for (int corner = 0; corner < 8 && inside; ++corner) {
    const Bucket other =
        at(corner & 1 ? rings : -rings, corner & 2 ? rings : -rings, corner & 4 ? deep : -deep);
    inside = wrapped(other) == other && owns(own, other, boxes);
  }
  if (inside) return;
  for (std::int32_t z = -deep; z <= deep; ++z)
    for (std::int32_t y = -rings; y <= rings; ++y)
      for (std::int32_t x = -rings; x <= rings; ++x) {
        const int rank = owner(wrapped(at(x, y, z)), boxes, own);
        if (rank == own) continue;
        const bool near = std::max({std::abs(x), std::abs(y), std::abs(z)}) <= 1;
        const auto found = std::ranges::find(ranks, rank, &Wanting::rank);
        if (found == ranks.end())
          ranks.push_back({rank, near});
        else
          found->near = found->near || near;
      }
}

template class Buckets<2>;
template class Buckets<3>;

}  // namespace strake::fluid
