#include "coupler/mapping/mapping.hpp"
#include "coupler/mapping/mapping_parts.hpp"
#include "coupler/mapping/partition_of_unity.hpp"
#include "coupler/mapping/point_tree.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

namespace strake {
namespace {

using namespace mapping_parts;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Matrix = Mapping::Matrix;

// Points nearer than this part of the mesh's size are one point.
constexpr double coincident = 1e-9;
// The dense system of all points: n³/3 operations once, and n·n_fluid weights that every exchange multiplies.
constexpr Index most_points = 2000, most_weights = 8'000'000;
// Beyond this the weights' digits are gone.
constexpr double worst_condition = 1e15;
// Patches whose weights are kept at a time, before they are added to the rows in order.
constexpr Index batch = 128;

/// The structure's points without repetition, and the points that each replaces.
struct Sources {
  Points position;
  std::vector<std::vector<Index>> members;
};

Sources distinct(const Points& points) {
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  const PointTree tree(points);
  const auto n = static_cast<std::size_t>(points.cols());
  std::vector<Index> taken_by(n, -1), near, kept;
  Sources sources;
  for (Index i = 0; i < points.cols(); ++i) {
    if (taken_by[static_cast<std::size_t>(i)] >= 0) continue;
    tree.within(points.col(i), coincident * size, near);
    sources.members.emplace_back();
    for (const Index j : near)
      if (taken_by[static_cast<std::size_t>(j)] < 0) {
        taken_by[static_cast<std::size_t>(j)] = i;
        sources.members.back().push_back(j);
      }
    kept.push_back(i);
  }
  sources.position = points(Eigen::all, kept);
  return sources;
}

/// Expands the weights over the distinct points to all points: coincident ones share a weight evenly.
void spread(Matrix& weights, const Sources& sources, Index n_structure) {
  if (static_cast<Index>(sources.members.size()) == n_structure) return;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < weights.cols(); ++j) {
    const auto& members = sources.members[static_cast<std::size_t>(j)];
    for (const Index i : members) entries.emplace_back(j, i, 1.0 / static_cast<double>(members.size()));
  }
  Matrix shared(weights.cols(), n_structure);
  shared.setFromTriplets(entries.begin(), entries.end());
  Matrix all = weights * shared;
  weights.swap(all);
}

/// One column per target of `patch`, in units of the patch: what the patch's interpolation makes of its
/// sources.
LocalWeights patch_weights(const Patch& patch, const RadialBasis& basis, RadialFunction function,
                           const Points& sources, const Points& targets) {
  const double unit = std::isfinite(patch.radius) && patch.radius > 0 ? patch.radius : 1;
  const double support = basis.support > 0 ? basis.support : usual_support * patch.spacing;
  return local_weights(function, support / unit, basis.polynomial == "linear",
                       (sources(Eigen::all, patch.source).colwise() - patch.centre) / unit,
                       (targets(Eigen::all, patch.target).colwise() - patch.centre) / unit);
}

void check_condition(const LocalWeights& local, const Patch& patch, const RadialBasis& basis,
                     const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  if (local.condition < worst_condition && local.weights.allFinite()) return;
  throw Error(
      ExitCode::case_file, title(structure, fluid),
      fmt::format("the radial basis of the {} structure points near ({:g}, {:g}, {:g}) m is singular "
                  "in double precision",
                  patch.source.size(), patch.centre.x(), patch.centre.y(), patch.centre.z()),
      fmt::format("{}a less smooth function (wendland-c2); points that all but coincide do this, too",
                  basis.support > 0 ? "a smaller coupling.surface.mapping.radial_basis.support, or " : ""));
}

/// The pattern of W: a row has all sources of its target's patches, ascending.
Matrix empty_rows(const PartitionOfUnity& partition, Index n_sources, Index n_targets) {
  Matrix weights(n_targets, n_sources);
  std::vector<Index> row, merged;
  const auto fill_row = [&](Index t) {
    row.clear();
    for (const Index k : partition.of_target[static_cast<std::size_t>(t)]) {
      const auto& source = partition.patches[static_cast<std::size_t>(k)].source;
      merged.clear();
      std::set_union(row.begin(), row.end(), source.begin(), source.end(), std::back_inserter(merged));
      row.swap(merged);
    }
  };
  std::vector<Index> begin = {0};
  for (Index t = 0; t < n_targets; ++t) {
    fill_row(t);
    begin.push_back(begin.back() + static_cast<Index>(row.size()));
  }
  if (begin.back() > std::numeric_limits<int>::max())
    throw Error(ExitCode::case_file, "coupling.surface.mapping.radial_basis",
                fmt::format("the mapping would have {} weights", begin.back()),
                "fewer patch_points, or mapping.kind = \"nearest-projection\"");
  weights.resizeNonZeros(begin.back());
  for (Index t = 0; t < n_targets; ++t) {
    fill_row(t);
    std::copy(row.begin(), row.end(), weights.innerIndexPtr() + begin[static_cast<std::size_t>(t)]);
    weights.outerIndexPtr()[t + 1] = static_cast<int>(begin[static_cast<std::size_t>(t) + 1]);
  }
  std::fill_n(weights.valuePtr(), begin.back(), 0.0);
  return weights;
}

/// Adds the weights of one patch to the rows of its targets.
void add(Matrix& weights, const PartitionOfUnity& partition, Index k, const MatrixXd& local,
         const Points& targets) {
  const Patch& patch = partition.patches[static_cast<std::size_t>(k)];
  for (std::size_t t = 0; t < patch.target.size(); ++t) {
    const Index row = patch.target[t];
    const auto& of = partition.of_target[static_cast<std::size_t>(row)];
    const auto place = std::lower_bound(of.begin(), of.end(), k) - of.begin();
    const double share = shares(partition, row, targets.col(row))[static_cast<std::size_t>(place)];
    Index entry = weights.outerIndexPtr()[row];
    for (std::size_t s = 0; s < patch.source.size(); ++s, ++entry) {
      while (weights.innerIndexPtr()[entry] != patch.source[s]) ++entry;
      weights.valuePtr()[entry] += share * local(static_cast<Index>(s), static_cast<Index>(t));
    }
  }
}

/// W_ij = Σ_k share_k(x_i) w_kj(x_i): every patch interpolates by itself, its share fades out at its border.
Matrix by_patches(const PartitionOfUnity& partition, const RadialBasis& basis, const Points& sources,
                  const InterfaceMesh& structure, const InterfaceMesh& fluid, MappingQuality& quality) {
  const RadialFunction function = radial_function(basis.function);
  Matrix weights = empty_rows(partition, sources.cols(), fluid.position.cols());
  const auto count = static_cast<Index>(partition.patches.size());
  std::vector<LocalWeights> local(static_cast<std::size_t>(std::min(batch, count)));
  for (Index first = 0; first < count; first += batch) {
    const Index here = std::min(batch, count - first);
#pragma omp parallel for schedule(dynamic, 4) if (count > 4)
    for (Index k = 0; k < here; ++k)
      local[static_cast<std::size_t>(k)] = patch_weights(
          partition.patches[static_cast<std::size_t>(first + k)], basis, function, sources, fluid.position);
    for (Index k = 0; k < here; ++k) {
      const LocalWeights& weight = local[static_cast<std::size_t>(k)];
      const Patch& patch = partition.patches[static_cast<std::size_t>(first + k)];
      check_condition(weight, patch, basis, structure, fluid);
      quality.condition = std::max(quality.condition, weight.condition);
      quality.patch_points += static_cast<double>(patch.source.size()) / static_cast<double>(count);
      add(weights, partition, first + k, weight.weights, fluid.position);
    }
  }
  quality.patches = count;
  return weights;
}

/// All points in one patch, so large that every target is inside.
PartitionOfUnity whole(const Points& sources, const Points& targets) {
  const auto everything = static_cast<int>(sources.cols());
  return divide(sources, targets, {.points = everything, .overlap = 0});
}

void check_size(Index n_structure, Index n_fluid, const InterfaceMesh& structure,
                const InterfaceMesh& fluid) {
  if (n_structure <= most_points && n_structure * n_fluid <= most_weights) return;
  throw Error(ExitCode::case_file, title(structure, fluid),
              fmt::format("one radial basis through all {} structure points for {} fluid points is too much: "
                          "at most {} structure points and {} weights",
                          n_structure, n_fluid, most_points, most_weights),
              "coupling.surface.mapping.radial_basis.solve = \"partition\"");
}

/// Records the distance from the nearest structure point. If that is too far and there are faces, it is the
/// distance from the nearest face. Between coarse points a fluid point may lie on the surface and yet far
/// from all of them.
void note_distances(MappingQuality& quality, const Points& sources, double limit,
                    const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  const PointTree tree(sources);
  std::vector<Index> far;
  for (Index i = 0; i < fluid.position.cols(); ++i) {
    const double distance = tree.nearest_distance(fluid.position.col(i));
    if (distance > limit && structure.faces.cols() > 0)
      far.push_back(i);
    else
      note_distance(quality, i, distance);
  }
  if (far.empty()) return;
  const InterfaceMesh beyond = {fluid.name, fluid.dimension, fluid.position(Eigen::all, far), {}, {}};
  const MappingQuality onto = nearest_projection(structure, beyond).quality();
  note_distance(quality, far[static_cast<std::size_t>(onto.farthest)], onto.largest_distance);
}

}  // namespace

Mapping radial_basis(const InterfaceMesh& structure, const InterfaceMesh& fluid, const RadialBasis& basis,
                     double limit) {
  check_meshes(structure, fluid);
  const Sources sources = distinct(structure.position);
  const bool global = basis.solve == "global";
  if (global) check_size(sources.position.cols(), fluid.position.cols(), structure, fluid);

  MappingQuality quality;
  note_distances(quality, sources.position, limit, structure, fluid);
  check_distance(quality, limit, structure, fluid);

  const PartitionOfUnity partition = global
                                         ? whole(sources.position, fluid.position)
                                         : divide(sources.position, fluid.position,
                                                  {.points = basis.patch_points, .overlap = basis.overlap});
  quality.outside = partition.beyond;
  Matrix weights = by_patches(partition, basis, sources.position, structure, fluid, quality);
  spread(weights, sources, structure.position.cols());
  return Mapping(std::move(weights), quality);
}

}  // namespace strake
