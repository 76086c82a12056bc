#include "fluid/geometry/triangle_grid.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace strake::fluid {

namespace {

using Vector3 = Eigen::Vector3d;

/// Returns the place of the segment a–b nearest to x, as its share of b.
double share_of_end(const Vector3& x, const Vector3& a, const Vector3& b) {
  const Vector3 t = b - a;
  const double length2 = t.squaredNorm();
  return length2 > 0 ? std::clamp((x - a).dot(t) / length2, 0.0, 1.0) : 0.0;
}

}  // namespace

void TriangleGrid::build(const Eigen::Matrix3Xd& position, const Eigen::MatrixXi& faces, double least_cell) {
  position_ = position;
  faces_ = faces;
  count_ = {0, 0, 0};
  const auto triangles = static_cast<int>(faces.cols());
  if (triangles == 0) return;
  low_ = position.rowwise().minCoeff();
  high_ = position.rowwise().maxCoeff();
  double edges = 0;
  for (int t = 0; t < triangles; ++t)
    for (int k = 0; k < 3; ++k) edges += (corner(t, k) - corner(t, (k + 1) % 3)).norm();
  cell_ = std::max(least_cell, edges / (3.0 * triangles));
  for (std::size_t d = 0; d < 3; ++d) {
    const auto axis = static_cast<Eigen::Index>(d);
    count_[d] = static_cast<int>((high_[axis] - low_[axis]) / cell_) + 1;
  }
  const std::size_t cells = number(0, 0, count_[2]);
  const auto each = [&](auto&& put) {
    for (int t = 0; t < triangles; ++t) {
      const Vector3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
      const Cell from = cell_of(a.cwiseMin(b).cwiseMin(c)), to = cell_of(a.cwiseMax(b).cwiseMax(c));
      for (int z = from[2]; z <= to[2]; ++z)
        for (int y = from[1]; y <= to[1]; ++y)
          for (int x = from[0]; x <= to[0]; ++x) put(number(x, y, z), t);
    }
  };
  start_.assign(cells + 1, 0);
  each([&](std::size_t cell, int) { ++start_[cell + 1]; });
  for (std::size_t c = 0; c < cells; ++c) start_[c + 1] += start_[c];
  member_.resize(static_cast<std::size_t>(start_[cells]));
  std::vector<int> next(start_.begin(), start_.end() - 1);
  each([&](std::size_t cell, int t) { member_[static_cast<std::size_t>(next[cell]++)] = t; });
}

auto TriangleGrid::cell_of(const Vector3& x) const -> Cell {
  Cell c{};
  for (std::size_t d = 0; d < 3; ++d) {
    const auto axis = static_cast<Eigen::Index>(d);
    c[d] = static_cast<int>(std::clamp((x[axis] - low_[axis]) / cell_, 0.0, count_[d] - 1.0));
  }
  return c;
}

template <class Visit>
void TriangleGrid::visit(const Cell& from, const Cell& to, Visit&& each) const {
  for (int z = from[2]; z <= to[2]; ++z)
    for (int y = from[1]; y <= to[1]; ++y)
      for (int x = from[0]; x <= to[0]; ++x) {
        const std::size_t cell = number(x, y, z);
        for (int m = start_[cell]; m < start_[cell + 1]; ++m) each(member_[static_cast<std::size_t>(m)]);
      }
}

std::vector<int> TriangleGrid::in_box(const Vector3& low, const Vector3& high) const {
  std::vector<int> found;
  if (count_[0] > 0) visit(cell_of(low), cell_of(high), [&](int t) { found.push_back(t); });
  return found;
}

// Finds the place of a triangle nearest to x. The normal equations of two edges give the weights of the foot
// of the perpendicular. Where one of them is negative the nearest place lies on an edge.
auto TriangleGrid::foot_on(int t, const Vector3& x) const -> Foot {
  const std::array<Vector3, 3> p = {corner(t, 0), corner(t, 1), corner(t, 2)};
  const Vector3 e1 = p[1] - p[0], e2 = p[2] - p[0], d = x - p[0];
  const double g11 = e1.dot(e1), g12 = e1.dot(e2), g22 = e2.dot(e2), d1 = d.dot(e1), d2 = d.dot(e2);
  const double determinant = g11 * g22 - g12 * g12;
  Foot foot;
  foot.triangle = t;
  if (determinant > 0) {
    const double u = (g22 * d1 - g12 * d2) / determinant, v = (g11 * d2 - g12 * d1) / determinant;
    foot.weight = {1 - u - v, u, v};
  }
  if (determinant > 0 && foot.weight.minCoeff() >= 0) {
    foot.position = p[0] + foot.weight[1] * e1 + foot.weight[2] * e2;
    foot.distance = (x - foot.position).norm();
    return foot;
  }
  for (int k = 0; k < 3; ++k) {
    const auto a = static_cast<std::size_t>(k), b = static_cast<std::size_t>((k + 1) % 3);
    const double s = share_of_end(x, p[a], p[b]);
    const Vector3 place = p[a] + s * (p[b] - p[a]);
    const double distance = (x - place).norm();
    if (distance >= foot.distance) continue;
    foot.distance = distance;
    foot.position = place;
    foot.weight.setZero();
    foot.weight[k] = 1 - s;
    foot.weight[(k + 1) % 3] += s;
  }
  return foot;
}

/// Returns how far x lies in front of the plane of a triangle [m].
double TriangleGrid::height_over(int t, const Vector3& x) const {
  const Vector3 normal = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
  const double size = normal.norm();
  return size > 0 ? normal.dot(x - corner(t, 0)) / size : 0;
}

// Before an edge all its triangles are equally far, whatever round-off gives. The one that x is most in front
// of is taken: on either side of the plane that halves the edge that is the triangle of this side.
bool TriangleGrid::is_before(const Foot& foot, const Foot& best, const Vector3& x) const {
  constexpr double round_off = 1e-9;
  if (best.triangle < 0) return foot.distance < best.distance;
  const double slack = round_off * (cell_ + best.distance);
  if (std::abs(foot.distance - best.distance) > slack) return foot.distance < best.distance;
  const double more = height_over(foot.triangle, x) - height_over(best.triangle, x);
  return std::abs(more) > slack ? more > 0 : foot.triangle < best.triangle;
}

/// Distance of x from a cell, a little less for round-off [m]. No triangle has a nearer place in that cell.
double TriangleGrid::distance_to_cell(const Cell& cell, const Vector3& x) const {
  constexpr double round_off = 1e-9;
  double square = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto axis = static_cast<Eigen::Index>(d);
    const double low = low_[axis] + cell[d] * cell_ - x[axis];
    const double away = std::max({low, -low - cell_, 0.0});
    square += away * away;
  }
  return std::sqrt(square) - round_off * cell_;
}

// Searches cubes of cells around x, one layer more each time. A place outside a cube is at least as far as
// its sides.
auto TriangleGrid::nearest(const Vector3& x, double limit) const -> Foot {
  if (count_[0] == 0) return {};
  const Vector3 beyond = (low_ - x).cwiseMax(x - high_).cwiseMax(0.0);
  const double outside = beyond.norm();
  if (outside > limit) return {};
  Foot best;
  best.distance = limit;
  const Cell centre = cell_of(x);
  const int farthest = std::max({count_[0], count_[1], count_[2]});
  for (int shell = 0; shell < farthest; ++shell) {
    if (std::max(outside, (shell - 1) * cell_) > best.distance) break;
    Cell from = centre, to = centre;
    for (std::size_t d = 0; d < 3; ++d) {
      from[d] = std::max(0, centre[d] - shell);
      to[d] = std::min(count_[d] - 1, centre[d] + shell);
    }
    for (int cz = from[2]; cz <= to[2]; ++cz)
      for (int cy = from[1]; cy <= to[1]; ++cy) {
        const bool face = std::max(std::abs(cz - centre[2]), std::abs(cy - centre[1])) == shell;
        for (int cx = from[0]; cx <= to[0]; ++cx) {
          if (!face && std::abs(cx - centre[0]) != shell) continue;
          const std::size_t cell = number(cx, cy, cz);
          if (start_[cell] == start_[cell + 1] || distance_to_cell({cx, cy, cz}, x) > best.distance) continue;
          for (int m = start_[cell]; m < start_[cell + 1]; ++m) {
            const int t = member_[static_cast<std::size_t>(m)];
            const Foot foot = foot_on(t, x);
            if (is_before(foot, best, x)) best = foot;
          }
        }
      }
  }
  return best.triangle < 0 ? Foot{} : best;
}

// Whether x lies under the triangle, along y. It does when a line along x to infinity crosses the triangle's
// edges an odd number of times. Both triangles beside an edge compute that crossing in the same order, so
// that none is missed or counted twice.
bool TriangleGrid::above(int t, const Vector3& x) const {
  bool under = false;
  for (int k = 0; k < 3; ++k) {
    int first = faces_(k, t), last = faces_((k + 1) % 3, t);
    if (first > last) std::swap(first, last);
    const Vector3 a = position_.col(first), b = position_.col(last);
    if ((a.z() > x.z()) == (b.z() > x.z())) continue;
    if (x.x() < a.x() + (x.z() - a.z()) / (b.z() - a.z()) * (b.x() - a.x())) under = !under;
  }
  if (!under) return false;
  const Vector3 a = corner(t, 0), normal = (corner(t, 1) - a).cross(corner(t, 2) - a);
  return normal.y() > 0 ? normal.dot(x - a) < 0 : normal.dot(x - a) > 0;
}

bool TriangleGrid::inside(const Vector3& x) const {
  if (count_[0] == 0 || (x.array() < low_.array()).any() || (x.array() > high_.array()).any()) return false;
  const Cell here = cell_of(x);
  bool odd = false;
  std::vector<int> found;  // a triangle reaches into several cells of the column
  visit(here, {here[0], count_[1] - 1, here[2]}, [&](int t) {
    if (above(t, x)) found.push_back(t);
  });
  std::sort(found.begin(), found.end());
  for (std::size_t k = 0; k < found.size(); ++k)
    if (k == 0 || found[k] != found[k - 1]) odd = !odd;
  return odd;
}

// Whether the segment x = a + s (b − a) cuts a triangle. It does where x lies in the triangle's plane,
// (x − p0)·N = 0, on the inner side of all three edges.
bool TriangleGrid::cuts(const Vector3& a, const Vector3& b) const {
  if (count_[0] == 0) return false;
  const Vector3 from = a.cwiseMin(b), to = a.cwiseMax(b);
  if ((to.array() < low_.array()).any() || (from.array() > high_.array()).any()) return false;
  bool cut = false;
  visit(cell_of(from), cell_of(to), [&](int t) {
    if (cut) return;
    const Vector3 p0 = corner(t, 0), p1 = corner(t, 1), p2 = corner(t, 2);
    const Vector3 normal = (p1 - p0).cross(p2 - p0);
    const double ha = normal.dot(a - p0), hb = normal.dot(b - p0);
    if ((ha > 0) == (hb > 0)) return;
    const Vector3 x = a + ha / (ha - hb) * (b - a);
    cut = normal.dot((p1 - p0).cross(x - p0)) >= 0 && normal.dot((p2 - p1).cross(x - p1)) >= 0 &&
          normal.dot((p0 - p2).cross(x - p2)) >= 0;
  });
  return cut;
}

}  // namespace strake::fluid
