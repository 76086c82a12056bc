#include "coupler/mapping/partition_of_unity.hpp"

#include "coupler/mapping/point_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

using Iterator = std::vector<Index>::iterator;

/// Sorts the sources [begin, end) across the longest side of their box. The lower ones come before `middle`.
void part(const Points& sources, Iterator begin, Iterator middle, Iterator end) {
  Vector3d low = sources.col(*begin), high = low;
  for (auto i = begin; i != end; ++i) {
    low = low.cwiseMin(sources.col(*i));
    high = high.cwiseMax(sources.col(*i));
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  // The index decides between equal coordinates: the cells do not depend on the library's algorithm.
  std::nth_element(begin, middle, end, [&](Index a, Index b) {
    const double x = sources(axis, a), y = sources(axis, b);
    return x < y || (x == y && a < b);
  });
}

using Cell = std::vector<Index>;

/// Divides the sources into cells of one patch each. A half gets patches in proportion to its sources, so
/// that all cells are of one size.
void split(const Points& sources, Iterator begin, Iterator end, Index count, std::vector<Cell>& cells) {
  if (count <= 1) {
    cells.emplace_back(begin, end);
    return;
  }
  const Index left = count / 2;
  const auto middle = begin + (end - begin) * left / count;
  part(sources, begin, middle, end);
  split(sources, begin, middle, left, cells);
  split(sources, middle, end, count - left, cells);
}

// The cell that a patch serves takes so many of its sources; the rest is overlap. A disc of radius √½ a about
// a square of side a contains π/2 times its points, 2.1 times with the usual overlap.
constexpr double share_of_cell = 0.48;

/// The smallest ball about the box of the cell's sources, half a spacing wider all round.
Patch ball_around(const std::vector<Index>& cell, const Points& sources, const std::vector<double>& spacing,
                  double overlap) {
  Patch patch;
  Vector3d low = sources.col(cell.front()), high = low;
  double sum = 0;
  for (const Index i : cell) {
    low = low.cwiseMin(sources.col(i));
    high = high.cwiseMax(sources.col(i));
    sum += spacing[static_cast<std::size_t>(i)];
  }
  patch.spacing = sum / static_cast<double>(cell.size());
  patch.centre = 0.5 * (low + high);
  patch.radius = (1 + overlap) * (0.5 * (high - low).norm() + std::sqrt(0.5) * patch.spacing);
  return patch;
}

// A ball contains at most `most` times the sources that a patch is planned for. Cells of fewer sources than
// `smallest_cell` are not halved for it.
constexpr std::size_t most = 4, smallest_cell = 8;

/// Makes the patch of a cell. If its ball contains too many sources, it makes the patches of both halves,
/// since one half may lie among dense sources and the other not.
void make_patches(Cell cell, const Points& sources, const PointTree& tree, const std::vector<double>& spacing,
                  const PatchParameters& parameters, std::vector<Patch>& patches, std::vector<Cell>& cells) {
  Patch patch = ball_around(cell, sources, spacing, parameters.overlap);
  tree.within(patch.centre, patch.radius, patch.source);
  if (patch.source.size() > most * static_cast<std::size_t>(parameters.points) &&
      cell.size() >= smallest_cell) {
    const auto middle = cell.begin() + static_cast<std::ptrdiff_t>(cell.size() / 2);
    part(sources, cell.begin(), middle, cell.end());
    for (Cell half : {Cell(cell.begin(), middle), Cell(middle, cell.end())})
      make_patches(std::move(half), sources, tree, spacing, parameters, patches, cells);
    return;
  }
  patches.push_back(std::move(patch));
  cells.push_back(std::move(cell));
}

/// Selects sources for a coarse cell whose ball reaches among dense sources. It keeps the cell's own and
/// those of the others that are `apart` from all kept ones, no denser than the cell itself.
std::vector<Index> thinned(const std::vector<Index>& source, const Cell& cell, const Points& sources,
                           double apart, std::size_t room) {
  std::vector<Index> kept;
  for (;; apart *= 1.5) {
    kept = cell;
    for (const Index i : source) {
      const auto near = [&](Index k) { return (sources.col(k) - sources.col(i)).norm() < apart; };
      if (std::none_of(kept.begin(), kept.end(), near)) kept.push_back(i);
      if (kept.size() > room) break;
    }
    if (kept.size() <= room) break;
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

/// Finds the patch for a point outside all balls: the one with the smallest distance in radii. A small dense
/// ball so extends less far.
Index least_beyond(const std::vector<Patch>& patches, const Vector3d& p) {
  Index best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const double ratio = (p - patches[k].centre).squaredNorm() / (patches[k].radius * patches[k].radius);
    if (ratio >= least) continue;
    least = ratio;
    best = static_cast<Index>(k);
  }
  return best;
}

}  // namespace

PartitionOfUnity divide(const Points& sources, const Points& targets, const PatchParameters& parameters) {
  const Index n = sources.cols();
  const PointTree source_tree(sources);
  std::vector<double> spacing(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) spacing[static_cast<std::size_t>(i)] = source_tree.distance_to_another(i);

  PartitionOfUnity partition;
  partition.of_target.resize(static_cast<std::size_t>(targets.cols()));
  const double cell_size = std::max(1.0, share_of_cell * parameters.points);
  const bool single = n <= parameters.points;
  const Index count = single ? 1 : static_cast<Index>(std::ceil(static_cast<double>(n) / cell_size));
  Cell all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), Index{0});

  if (single) {
    Patch patch = ball_around(all, sources, spacing, parameters.overlap);
    patch.source = std::move(all);
    patch.target.resize(static_cast<std::size_t>(targets.cols()));
    std::iota(patch.target.begin(), patch.target.end(), Index{0});
    for (auto& of : partition.of_target) of = {0};
    partition.patches.push_back(std::move(patch));
    return partition;
  }

  std::vector<Cell> first, cells;
  split(sources, all.begin(), all.end(), count, first);
  for (Cell& cell : first)
    make_patches(std::move(cell), sources, source_tree, spacing, parameters, partition.patches, cells);
  const std::size_t room = most * static_cast<std::size_t>(parameters.points);
  const PointTree target_tree(targets);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    Patch& patch = partition.patches[c];
    if (patch.source.size() > std::max(room, cells[c].size()))
      patch.source = thinned(patch.source, cells[c], sources, patch.spacing, room);
    target_tree.within(patch.centre, patch.radius, patch.target);
    // At the border itself the share is zero.
    std::erase_if(patch.target,
                  [&](Index t) { return (targets.col(t) - patch.centre).norm() >= patch.radius; });
    for (const Index t : patch.target)
      partition.of_target[static_cast<std::size_t>(t)].push_back(static_cast<Index>(c));
  }
  for (Index t = 0; t < targets.cols(); ++t) {
    auto& of = partition.of_target[static_cast<std::size_t>(t)];
    if (!of.empty()) continue;
    of.push_back(least_beyond(partition.patches, targets.col(t)));
    auto& target = partition.patches[static_cast<std::size_t>(of.front())].target;
    target.insert(std::lower_bound(target.begin(), target.end(), t), t);
    ++partition.beyond;
  }
  return partition;
}

// D. Shepard's weights on smooth bumps: ψ_k = (1 − q)⁴(4q + 1)/R_k³, q = |x − c_k|/R_k; share ψ_k/Σψ.
std::vector<double> shares(const PartitionOfUnity& partition, Index i, const Vector3d& position) {
  const auto& of = partition.of_target[static_cast<std::size_t>(i)];
  if (of.size() == 1) return {1.0};
  std::vector<double> share;
  double sum = 0;
  for (const Index k : of) {
    const Patch& patch = partition.patches[static_cast<std::size_t>(k)];
    const double q = (position - patch.centre).norm() / patch.radius, p = (1 - q) * (1 - q);
    share.push_back(p * p * (4 * q + 1) / (patch.radius * patch.radius * patch.radius));
    sum += share.back();
  }
  for (double& s : share) s /= sum;
  return share;
}

}  // namespace strake
