#include "fluid/geometry/halved_edges.hpp"

#include <algorithm>
#include <limits>

namespace strake::fluid {

HalvedEdges::HalvedEdges(const SurfacePatches& surface) {
  std::vector<const SurfacePatches::Border*> once;
  for (const auto* sides : {&surface.border, &surface.chine})
    for (const auto& border : *sides)
      if (border.is_halved() && border.is_first()) once.push_back(&border);
  ends_.resize(3, static_cast<Eigen::Index>(once.size()));
  across_.setZero(3, ends_.cols());
  for (std::size_t e = 0; e < once.size(); ++e) {
    const auto& border = *once[e];
    ends_.col(static_cast<Eigen::Index>(e)) << border.from, border.to, border.to;
    patches_.emplace_back(border.patch, border.other);
    const bool is_within = border.is_within_patch();
    triangles_.emplace_back(is_within ? border.triangle : -1, is_within ? border.other_triangle : -1);
    has_within_ = has_within_ || is_within;
  }
}

void HalvedEdges::build(const Eigen::Matrix3Xd& position, const Eigen::Matrix3Xd& normal, double least_cell) {
  if (patches_.empty()) return;
  position_ = position;
  grid_.build(position, ends_, least_cell);
  for (std::size_t e = 0; has_within_ && e < triangles_.size(); ++e)
    if (const auto [mine, theirs] = triangles_[e]; mine >= 0)
      across_.col(static_cast<Eigen::Index>(e)) = normal.col(mine) - normal.col(theirs);
}

// Computes the least |a − v| + |v − b| over the places v of an edge. Unfolded about the edge the way is
// straight: along the edge it passes v in proportion to the distances of a and b from the edge's line.
HalvedEdges::Way HalvedEdges::way_over(int e, const Vector3& a, const Vector3& b) const {
  constexpr double room = 0.1;  // at the end of an edge, where the next one turns aside [the distances' sum]
  const Vector3 from = position_.col(ends_(0, e)), along = position_.col(ends_(1, e)) - from;
  const double length = along.norm();
  const Vector3 t = along / length;
  const double at_a = t.dot(a - from), at_b = t.dot(b - from);
  const double from_a = (a - from - at_a * t).norm(), from_b = (b - from - at_b * t).norm();
  const double share = from_a + from_b > 0 ? from_a / (from_a + from_b) : 0.5;
  const double at = at_a + share * (at_b - at_a), beyond = std::max(-at, at - length);
  const Vector3 v = from + std::clamp(at, 0.0, length) * t;
  return {(a - v).norm() + (b - v).norm(), beyond <= room * (from_a + from_b)};
}

// Whether the plane that halves a chine within a patch divides a from b.
bool HalvedEdges::is_passed(int e, const Vector3& a, const Vector3& b) const {
  const Vector3 from = position_.col(ends_(0, e)), across = across_.col(e);
  return (across.dot(a - from) > 0) != (across.dot(b - from) > 0);
}

// The order of the patches, not that of a and b, sets the last bits.
double HalvedEdges::way_around(const Vector3& a, int patch_a, const Vector3& b, int patch_b,
                               double limit) const {
  if (patch_b < patch_a) return way_around(b, patch_b, a, patch_a, limit);
  double way = limit;
  const std::pair both(patch_a, patch_b);
  const Vector3 middle = 0.5 * (a + b), farthest = Vector3::Constant(0.5 * limit);
  for (const int e : grid_.in_box(middle - farthest, middle + farthest)) {
    const auto k = static_cast<std::size_t>(e);
    if (patches_[k] != both || (triangles_[k].first >= 0 && !is_passed(e, a, b))) continue;
    way = std::min(way, way_over(e, a, b).length);
  }
  return way < limit ? way : std::numeric_limits<double>::infinity();
}

bool HalvedEdges::divides(const Vector3& a, const Vector3& b, int patch, double limit) const {
  if (!has_within_) return false;
  const Vector3 middle = 0.5 * (a + b), farthest = Vector3::Constant(0.5 * limit);
  for (const int e : grid_.in_box(middle - farthest, middle + farthest)) {
    const auto k = static_cast<std::size_t>(e);
    if (triangles_[k].first < 0 || patches_[k].first != patch || !is_passed(e, a, b)) continue;
    if (const Way way = way_over(e, a, b); way.between_ends && way.length < limit) return true;
  }
  return false;
}

}  // namespace strake::fluid
