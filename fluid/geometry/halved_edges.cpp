#include "fluid/geometry/halved_edges.hpp"

#include <algorithm>
#include <limits>

namespace strake::fluid {

HalvedEdges::HalvedEdges(const SurfacePatches& surface) {
  std::vector<const SurfacePatches::Border*> once;
  for (const auto& border : surface.border)
    if (border.is_halved() && border.is_first()) once.push_back(&border);
  ends_.resize(3, static_cast<Eigen::Index>(once.size()));
  for (std::size_t e = 0; e < once.size(); ++e) {
    ends_.col(static_cast<Eigen::Index>(e)) << once[e]->from, once[e]->to, once[e]->to;
    patches_.emplace_back(once[e]->patch, once[e]->other);
  }
}

void HalvedEdges::build(const Eigen::Matrix3Xd& position, double least_cell) {
  if (patches_.empty()) return;
  position_ = position;
  grid_.build(position, ends_, least_cell);
}

// Computes the least |a − v| + |v − b| over the places v of each edge. Unfolded about the edge the way is
// straight: along the edge it passes v in proportion to the distances of a and b from the edge's line. The
// order of the patches, not that of a and b, sets the last bits.
double HalvedEdges::way_around(const Vector3& a, int patch_a, const Vector3& b, int patch_b,
                               double limit) const {
  if (patch_b < patch_a) return way_around(b, patch_b, a, patch_a, limit);
  double way = limit;
  const std::pair both(patch_a, patch_b);
  const Vector3 middle = 0.5 * (a + b), farthest = Vector3::Constant(0.5 * limit);
  for (const int e : grid_.in_box(middle - farthest, middle + farthest)) {
    if (patches_[static_cast<std::size_t>(e)] != both) continue;
    const Vector3 from = position_.col(ends_(0, e)), along = position_.col(ends_(1, e)) - from;
    const double length = along.norm();
    const Vector3 t = along / length;
    const double at_a = t.dot(a - from), at_b = t.dot(b - from);
    const double from_a = (a - from - at_a * t).norm(), from_b = (b - from - at_b * t).norm();
    const double share = from_a + from_b > 0 ? from_a / (from_a + from_b) : 0.5;
    const Vector3 v = from + std::clamp(at_a + share * (at_b - at_a), 0.0, length) * t;
    way = std::min(way, (a - v).norm() + (b - v).norm());
  }
  return way < limit ? way : std::numeric_limits<double>::infinity();
}

}  // namespace strake::fluid
