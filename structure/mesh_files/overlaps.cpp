#include "structure/mesh_files/overlaps.hpp"

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

constexpr double inside = 1e-6;  // of a cell's size: a middle this far behind all sides is inside

/// Collects the cells around the middle of one cell; what Eigen's BVIntersect asks.
class MiddleFinder {
 public:
  MiddleFinder(const Solid& solid, const std::vector<Bounds>& boxes) : solid_(solid), boxes_(boxes) {}

  void ask_for(int cell) {
    cell_ = cell;
    middle_ = middle_of(cell);
  }

  bool intersectVolume(const Bounds& box) const { return box.contains(middle_); }
  bool intersectObject(int other) {
    const Bounds& box = boxes_[static_cast<std::size_t>(other)];
    if (other == cell_ || !box.contains(middle_)) return false;
    if (!is_inside(middle_, other) || !is_inside(middle_of(other), other)) return false;
    const std::pair<int, int> pair = std::minmax(cell_, other);
    if (found.cells == 0 || pair < found.first) {
      found.first = pair;
      found.place = middle_;
    }
    ++found.cells;
    return true;  // one is enough
  }

  CellOverlaps found;

 private:
  Vector3d middle_of(int cell) const {
    Vector3d sum = Vector3d::Zero();
    for (Index k = 0; k < solid_.cell.rows(); ++k) sum += solid_.node.col(solid_.cell(k, cell));
    return sum / static_cast<double>(solid_.cell.rows());
  }
  bool is_inside(const Vector3d& X, int cell) const {
    const Eigen::Matrix4Xd planes = half_spaces(solid_, cell);  // n·X ≤ c
    const double outside = (X.transpose() * planes.topRows<3>() - planes.row(3)).maxCoeff();
    return outside <= -inside * boxes_[static_cast<std::size_t>(cell)].sizes().maxCoeff();
  }

  const Solid& solid_;
  const std::vector<Bounds>& boxes_;
  int cell_ = -1;
  Vector3d middle_ = Vector3d::Zero();
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
  MiddleFinder finder(solid, boxes);
  for (const int cell : number) {
    finder.ask_for(cell);
    Eigen::BVIntersect(tree, finder);
  }
  return finder.found;
}

}  // namespace strake::structure
