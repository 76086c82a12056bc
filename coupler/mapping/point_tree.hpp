#pragma once

#include "proto/interface.hpp"

#include <Eigen/Core>
#include <nanoflann.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace strake {

/// A k-d tree over points. Its answers do not depend on the order in which it visits them: lists ascend, and
/// of equally near points the first is taken. The points must outlive it and stay.
class PointTree {
 public:
  explicit PointTree(const Points& points) : cloud_{points}, tree_(3, cloud_) { tree_.buildIndex(); }

  /// Indices of all points within `distance` of p, ascending.
  void within(const Eigen::Vector3d& p, double distance, std::vector<Eigen::Index>& found) const {
    thread_local std::vector<std::pair<std::size_t, double>> pairs;
    nanoflann::SearchParams unsorted;
    unsorted.sorted = false;
    const double squared = distance * distance;
    tree_.radiusSearch(p.data(), std::nextafter(squared, 2 * squared + 1), pairs, unsorted);
    found.clear();
    for (const auto& f : pairs) found.push_back(static_cast<Eigen::Index>(f.first));
    std::sort(found.begin(), found.end());
  }
  double nearest_distance(const Eigen::Vector3d& p) const { return std::sqrt(nearest_squared<1>(p)); }
  /// The first of the nearest points; those nearer than `tie` (relative) to the nearest count as equally
  /// near.
  Eigen::Index nearest(const Eigen::Vector3d& p, double tie) const {
    thread_local std::vector<Eigen::Index> found;
    within(p, nearest_distance(p) * (1 + tie), found);
    return found.front();
  }
  /// From a point of the tree to the nearest other one; infinite where it is alone.
  double distance_to_another(Eigen::Index i) const {
    if (cloud_.points.cols() < 2) return std::numeric_limits<double>::infinity();
    return std::sqrt(nearest_squared<2>(cloud_.points.col(i)));
  }

 private:
  /// Squared distance to the n-th nearest point.
  template <std::size_t n>
  double nearest_squared(const Eigen::Vector3d& p) const {
    std::array<std::size_t, n> index{};
    std::array<double, n> squared{};
    nanoflann::KNNResultSet<double> result(n);
    result.init(index.data(), squared.data());
    tree_.findNeighbors(result, p.data(), {});
    return squared[n - 1];
  }

  /// Points for nanoflann, which wants coordinates one by one.
  struct Cloud {
    const Points& points;
    std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(points.cols()); }
    double kdtree_get_pt(std::size_t i, std::size_t d) const { return points.data()[3 * i + d]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::size_t>
      tree_;
};

}  // namespace strake
