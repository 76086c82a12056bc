#include "structure/body/closed_surface.hpp"

#include "proto/geometry/triangle.hpp"
#include "structure/body/solid_surface.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace strake::structure {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Corners of a triangle as columns.
Matrix3d corners(const Points& point, const Eigen::Matrix3Xi& triangle, Index t) {
  Matrix3d corner;
  for (Index k = 0; k < 3; ++k) corner.col(k) = point.col(triangle(k, t));
  return corner;
}

double area_of(const Matrix3d& corner) {
  return 0.5 * (corner.col(1) - corner.col(0)).cross(corner.col(2) - corner.col(0)).norm();
}

double longest_side(const Matrix3d& corner) {
  double longest = 0;
  for (Index k = 0; k < 3; ++k) longest = std::max(longest, (corner.col((k + 1) % 3) - corner.col(k)).norm());
  return longest;
}

/// Cuts triangles until no edge is longer than a limit. An edge above the limit is always halved, and so are
/// its halves, whatever triangle it belongs to: neighbours meet, and the surface stays closed.
class Cutter {
 public:
  explicit Cutter(double limit) : limit_(limit) {}

  /// Halves the longest edge of a triangle. A slender one is cut across first, into pieces about as long as
  /// its shortest edge is: halves of a slender triangle would stay slender.
  void cut(const Matrix3d& corner) {
    constexpr double slender = 0.5;  // of the longest edge
    std::array<double, 3> length{};  // of the edge opposite to each corner
    for (Index k = 0; k < 3; ++k)
      length[static_cast<std::size_t>(k)] = (corner.col((k + 2) % 3) - corner.col((k + 1) % 3)).norm();
    const Index longest = std::max_element(length.begin(), length.end()) - length.begin(),
                shortest = std::min_element(length.begin(), length.end()) - length.begin();
    const double most = length[static_cast<std::size_t>(longest)],
                 least = length[static_cast<std::size_t>(shortest)];
    if (most <= limit_) {
      face_.push_back({number(corner.col(0)), number(corner.col(1)), number(corner.col(2))});
    } else if (least < slender * most) {
      cut_across(corner.col(shortest), corner.col((shortest + 1) % 3), corner.col((shortest + 2) % 3), least);
    } else {
      const Vector3d tip = corner.col(longest), a = corner.col((longest + 1) % 3),
                     b = corner.col((longest + 2) % 3), middle = 0.5 * (a + b);
      cut(triangle_of(tip, a, middle));
      cut(triangle_of(tip, middle, b));
    }
  }

  InterfaceMesh mesh() const { return closed_surface(point_, face_); }

 private:
  static Matrix3d triangle_of(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    Matrix3d corner;
    corner << a, b, c;
    return corner;
  }

  /// Joins the points on both long edges of a slender triangle (tip, a, b), beginning at its tip.
  void cut_across(const Vector3d& tip, const Vector3d& a, const Vector3d& b, double width) {
    std::vector<Vector3d> one = {tip}, other = {tip};
    const double step = std::max(limit_, width);
    divide(tip, a, step, one);
    divide(tip, b, step, other);
    std::size_t i = 1, j = 1;
    cut(triangle_of(tip, one[1], other[1]));
    while (i + 1 < one.size() || j + 1 < other.size()) {
      const bool first = j + 1 == other.size() || (i + 1 < one.size() && (one[i + 1] - other[j]).norm() <=
                                                                             (one[i] - other[j + 1]).norm());
      if (first) {
        cut(triangle_of(one[i], one[i + 1], other[j]));
        ++i;
      } else {
        cut(triangle_of(one[i], other[j + 1], other[j]));
        ++j;
      }
    }
  }

  /// Adds the points after a on the edge to b, halved until no part is longer than `step`.
  static void divide(const Vector3d& a, const Vector3d& b, double step, std::vector<Vector3d>& points) {
    if ((b - a).norm() > step) {
      const Vector3d middle = 0.5 * (a + b);
      divide(a, middle, step, points);
      divide(middle, b, step, points);
    } else {
      points.push_back(b);
    }
  }

  /// Halves of the same edge are equal bit by bit, in whatever direction it is walked.
  int number(const Vector3d& X) {
    const auto [found, fresh] = number_.emplace(std::array<double, 3>{X.x(), X.y(), X.z()}, point_.size());
    if (fresh) point_.push_back(X);
    return static_cast<int>(found->second);
  }

  double limit_;  // [m]
  std::vector<Vector3d> point_;
  std::vector<std::array<int, 3>> face_;
  std::map<std::array<double, 3>, std::size_t> number_;
};

}  // namespace

double volume_of(const ClosedSurface& surface) {
  const Vector3d origin = surface.point.col(0);  // near the body, so that round-off stays small
  double volume = 0;
  for (Index t = 0; t < surface.triangle.cols(); ++t)
    volume += (corners(surface.point, surface.triangle, t).colwise() - origin).determinant() / 6;
  return volume;
}

double outer_area(const ClosedSurface& surface) {
  double area = 0;
  for (Index t = 0; t < surface.outer; ++t) area += area_of(corners(surface.point, surface.triangle, t));
  return area;
}

double winding_number(const Points& point, const Eigen::Matrix3Xi& triangle, const Vector3d& X) {
  double angle = 0;
  for (Index t = 0; t < triangle.cols(); ++t) {
    const Matrix3d arm = corners(point, triangle, t).colwise() - X;
    const Vector3d r = arm.colwise().norm();
    const double along = r[0] * r[1] * r[2] + arm.col(0).dot(arm.col(1)) * r[2] +
                         arm.col(1).dot(arm.col(2)) * r[0] + arm.col(2).dot(arm.col(0)) * r[1];
    angle += 2 * std::atan2(arm.determinant(), along);
  }
  return angle / (4 * std::numbers::pi);
}

bool is_inside(const ClosedSurface& surface, const Vector3d& X, double slack) {
  if (winding_number(surface.point, surface.triangle, X) > 0.5) return true;
  for (Index t = 0; t < surface.triangle.cols(); ++t) {
    const Matrix3d corner = corners(surface.point, surface.triangle, t);
    if ((corner * nearest_in_triangle(corner, X) - X).norm() <= slack) return true;
  }
  return false;
}

InterfaceMesh refined_surface(const ClosedSurface& surface, double spacing) {
  Cutter cutter(longest_edge * spacing);
  for (Index t = 0; t < surface.outer; ++t) cutter.cut(corners(surface.point, surface.triangle, t));
  return cutter.mesh();
}

double refined_count(const ClosedSurface& surface, double spacing) {
  double count = static_cast<double>(surface.point.cols());
  for (Index t = 0; t < surface.outer; ++t) {
    const Matrix3d corner = corners(surface.point, surface.triangle, t);
    const double longest = longest_side(corner);
    if (longest > longest_edge * spacing)  // a slender one: its long edges
      count += std::max(2.0 * area_of(corner) / (spacing * spacing), longest / spacing);
  }
  return count;
}

}  // namespace strake::structure
