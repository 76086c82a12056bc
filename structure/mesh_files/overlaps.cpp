#include "structure/mesh_files/mesh_file.hpp"

#include <Eigen/Geometry>
#include <unsupported/Eigen/BVH>

#include <algorithm>
#include <numeric>
#include <vector>

namespace strake::structure {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Bounds = Eigen::AlignedBox3d;

constexpr double inset = 0.2;  // of the way from a corner to the middle
/// How far behind each side a place is inside, over the distance of the cell's middle from that side. With
/// bent sides the planes of cells that share but an edge reach into one another a little.
constexpr double margin = 0.05;
constexpr double at_middle = 1e-6;  // the same for the middle itself

/// Collects the cells around the places of one cell; what Eigen's BVIntersect asks.
class OverlapFinder {
 public:
  OverlapFinder(const Solid& solid, const std::vector<Bounds>& boxes)
      : solid_(solid), boxes_(boxes), middle_(3, solid.cell.cols()) {
    for (Index c = 0; c < solid.cell.cols(); ++c) {
      Vector3d sum = Vector3d::Zero();
      for (Index k = 0; k < solid.cell.rows(); ++k) sum += solid.node.col(solid.cell(k, c));
      middle_.col(c) = sum / static_cast<double>(solid.cell.rows());
      const Eigen::Matrix4Xd planes = half_spaces(solid, static_cast<int>(c));
      sides_ = planes.cols();
      if (c == 0) plane_.resize(4, sides_ * solid.cell.cols());
      plane_.middleCols(c * sides_, sides_) = planes;
    }
  }

  void ask_for(int cell) {
    cell_ = cell;
    place_.clear();
    if (is_inside(middle_.col(cell), cell, at_middle)) place_.emplace_back(middle_.col(cell));
    for (Index k = 0; k < solid_.cell.rows(); ++k) {
      const Vector3d corner = solid_.node.col(solid_.cell(k, cell)),
                     place = corner + inset * (middle_.col(cell) - corner);
      if (is_inside(place, cell, margin)) place_.push_back(place);
    }
  }

  bool intersectVolume(const Bounds& box) const {
    return box.intersects(boxes_[static_cast<std::size_t>(cell_)]);
  }
  bool intersectObject(int other) {
    const Bounds& box = boxes_[static_cast<std::size_t>(other)];
    if (other == cell_ || !intersectVolume(box) || !is_inside(middle_.col(other), other, at_middle))
      return false;
    const auto inside = std::find_if(place_.begin(), place_.end(), [&](const Vector3d& X) {
      return box.contains(X) && is_inside(X, other, X == middle_.col(cell_) ? at_middle : margin);
    });
    if (inside == place_.end()) return false;
    const std::pair<int, int> pair = std::minmax(cell_, other);
    if (found.cells == 0 || pair < found.first) {
      found.first = pair;
      found.place = *inside;
    }
    ++found.cells;
    return true;  // one is enough
  }

  CellOverlaps found;

 private:
  /// Whether X lies behind the plane of each side, n·X ≤ c, by more than `least` of what the middle does.
  bool is_inside(const Vector3d& X, int cell, double least) const {
    for (Index s = cell * sides_; s < (cell + 1) * sides_; ++s) {
      const double depth = plane_(3, s) - plane_.col(s).head<3>().dot(X),
                   of_middle = plane_(3, s) - plane_.col(s).head<3>().dot(middle_.col(cell));
      if (!(of_middle > 0) || depth < least * of_middle) return false;
    }
    return true;
  }

  const Solid& solid_;
  const std::vector<Bounds>& boxes_;
  Eigen::Matrix3Xd middle_;
  Eigen::Matrix4Xd plane_;  // of the sides of all cells, one cell after the other
  Index sides_ = 0;
  int cell_ = -1;
  std::vector<Vector3d> place_;
};

}  // namespace

CellOverlaps find_overlaps(const Solid& solid) {
  std::vector<Bounds> boxes(static_cast<std::size_t>(solid.cell.cols()));
  for (Index c = 0; c < solid.cell.cols(); ++c)
    for (Index k = 0; k < solid.cell.rows(); ++k)
      boxes[static_cast<std::size_t>(c)].extend(solid.node.col(solid.cell(k, c)));
  std::vector<int> number(boxes.size());
  std::iota(number.begin(), number.end(), 0);
  const Eigen::KdBVH<double, 3, int> tree(number.begin(), number.end(), boxes.begin(), boxes.end());
  OverlapFinder finder(solid, boxes);
  for (const int cell : number) {
    finder.ask_for(cell);
    Eigen::BVIntersect(tree, finder);
  }
  return finder.found;
}

}  // namespace strake::structure
