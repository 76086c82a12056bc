#include "coupler/patches.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "coupler/point_tree.hpp"

namespace strake {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Halves the cell of the sources [first, last) across its longest side until it counts one patch; a side's
/// share of patches is its share of sources, so that all cells are of one size.
class Cells {
 public:
  Cells(const Points& sources, Index count)
      : sources_(sources), order_(static_cast<std::size_t>(sources.cols())) {
    std::iota(order_.begin(), order_.end(), Index{0});
    split(0, order_.size(), count);
  }
  /// The sources of each cell.
  std::vector<std::vector<Index>> cells;

 private:
  void split(std::size_t first, std::size_t last, Index count) {
    const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first),
               end = order_.begin() + static_cast<std::ptrdiff_t>(last);
    if (count <= 1) {
      cells.emplace_back(begin, end);
      return;
    }
    Vector3d low = sources_.col(*begin), high = low;
    for (auto i = begin; i != end; ++i) {
      low = low.cwiseMin(sources_.col(*i));
      high = high.cwiseMax(sources_.col(*i));
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    const Index left = count / 2;
    const std::size_t middle =
        first + (last - first) * static_cast<std::size_t>(left) / static_cast<std::size_t>(count);
    // The index decides between equal coordinates: the cells do not depend on the library's algorithm.
    std::nth_element(begin, order_.begin() + static_cast<std::ptrdiff_t>(middle), end, [&](Index a, Index b) {
      const double x = sources_(axis, a), y = sources_(axis, b);
      return x < y || (x == y && a < b);
    });
    split(first, middle, left);
    split(middle, last, count - left);
  }
  const Points& sources_;
  std::vector<Index> order_;
};

// The cell that a patch serves takes so many of its sources; the rest is overlap. A disc of radius √½ a about
// a square of side a holds π/2 times its points, 2.1 times with the usual overlap.
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

}  // namespace

Partition divide(const Points& sources, const Points& targets, const PatchParameters& parameters) {
  const Index n = sources.cols();
  const PointTree source_tree(sources);
  std::vector<double> spacing(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) spacing[static_cast<std::size_t>(i)] = source_tree.distance_to_another(i);

  Partition partition;
  partition.of_target.resize(static_cast<std::size_t>(targets.cols()));
  const double cell_size = std::max(1.0, share_of_cell * parameters.points);
  const bool single = n <= parameters.points;
  const Index count = single ? 1 : static_cast<Index>(std::ceil(static_cast<double>(n) / cell_size));
  Cells cells(sources, count);

  if (single) {
    Patch patch = ball_around(cells.cells.front(), sources, spacing, parameters.overlap);
    patch.source.resize(static_cast<std::size_t>(n));
    std::iota(patch.source.begin(), patch.source.end(), Index{0});
    patch.target.resize(static_cast<std::size_t>(targets.cols()));
    std::iota(patch.target.begin(), patch.target.end(), Index{0});
    for (auto& of : partition.of_target) of = {0};
    partition.patches.push_back(std::move(patch));
    return partition;
  }

  std::vector<Index> cell_of(static_cast<std::size_t>(n));
  const PointTree target_tree(targets);
  for (std::size_t c = 0; c < cells.cells.size(); ++c) {
    for (const Index i : cells.cells[c]) cell_of[static_cast<std::size_t>(i)] = static_cast<Index>(c);
    Patch patch = ball_around(cells.cells[c], sources, spacing, parameters.overlap);
    source_tree.within(patch.centre, patch.radius, patch.source);
    target_tree.within(patch.centre, patch.radius, patch.target);
    // At the border itself the share is zero.
    std::erase_if(patch.target,
                  [&](Index t) { return (targets.col(t) - patch.centre).norm() >= patch.radius; });
    for (const Index t : patch.target)
      partition.of_target[static_cast<std::size_t>(t)].push_back(static_cast<Index>(c));
    partition.patches.push_back(std::move(patch));
  }
  for (Index t = 0; t < targets.cols(); ++t) {
    auto& of = partition.of_target[static_cast<std::size_t>(t)];
    if (!of.empty()) continue;
    const Index c = cell_of[static_cast<std::size_t>(source_tree.nearest(targets.col(t), 0))];
    of.push_back(c);
    auto& target = partition.patches[static_cast<std::size_t>(c)].target;
    target.insert(std::lower_bound(target.begin(), target.end(), t), t);
    ++partition.beyond;
  }
  return partition;
}

// D. Shepard's weights on smooth bumps: ψ_k = (1 − q)⁴(4q + 1), q = |x − c_k|/R_k; share ψ_k/Σψ.
std::vector<double> shares(const Partition& partition, Index i, const Vector3d& position) {
  const auto& of = partition.of_target[static_cast<std::size_t>(i)];
  if (of.size() == 1) return {1.0};
  std::vector<double> share;
  double sum = 0;
  for (const Index k : of) {
    const Patch& patch = partition.patches[static_cast<std::size_t>(k)];
    const double q = (position - patch.centre).norm() / patch.radius, p = (1 - q) * (1 - q);
    share.push_back(p * p * (4 * q + 1));
    sum += share.back();
  }
  for (double& s : share) s /= sum;
  return share;
}

}  // namespace strake
