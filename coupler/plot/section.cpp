#include "coupler/plot/section.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace strake::picture {
namespace {

/// Pairs of corners that an edge joins. Of four corners (a tetrahedron) these are all pairs. Of eight they
/// are those of a hexahedron whose two faces are numbered alike.
std::vector<std::pair<int, int>> edges(Eigen::Index corners) {
  if (corners != 8) {
    std::vector<std::pair<int, int>> all;
    for (int a = 0; a < corners; ++a)
      for (int b = a + 1; b < corners; ++b) all.emplace_back(a, b);
    return all;
  }
  return {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
}

}  // namespace

std::vector<Place> section(const Points& point, const Eigen::VectorXi& cell, double at) {
  std::vector<Place> cut;
  for (const auto& [a, b] : edges(cell.size())) {
    const auto p = point.col(cell(a)), q = point.col(cell(b));
    if ((p.z() < at) == (q.z() < at)) continue;
    const double s = (at - p.z()) / (q.z() - p.z());
    cut.push_back({p.x() + s * (q.x() - p.x()), p.y() + s * (q.y() - p.y())});
  }
  if (cut.size() < 3) return cut.size() == 2 ? cut : std::vector<Place>{};
  Place middle;
  for (const Place& c : cut) {
    middle.x += c.x / static_cast<double>(cut.size());
    middle.y += c.y / static_cast<double>(cut.size());
  }
  // The section of a convex cell is convex: its corners stand in the order of their angle.
  std::sort(cut.begin(), cut.end(), [&](const Place& p, const Place& q) {
    return std::atan2(p.y - middle.y, p.x - middle.x) < std::atan2(q.y - middle.y, q.x - middle.x);
  });
  return cut;
}

}  // namespace strake::picture
