#pragma once

#include <Eigen/Core>

#include <array>
#include <limits>
#include <vector>

namespace strake::fluid {

/// Triangles of a closed surface, sorted into the cells of an even grid. The grid finds the triangle nearest
/// to a place, what lies inside the surface, and whether the surface lies between two places.
class TriangleGrid {
 public:
  using Vector3 = Eigen::Vector3d;

  /// Sorts the triangles into cells. position: 3×n; faces: 3×m, counter-clockwise seen from outside.
  /// least_cell: no cell is smaller [m].
  void build(const Eigen::Matrix3Xd& position, const Eigen::MatrixXi& faces, double least_cell);

  struct Foot {
    int triangle = -1;                 // −1: none within the limit
    Vector3 weight = Vector3::Zero();  // of its corners
    Vector3 position = Vector3::Zero();
    double distance = std::numeric_limits<double>::infinity();  // [m]
  };
  /// The nearest place of the surface within `limit` [m]. Of triangles that are equally near, those beside an
  /// edge, it is on the one that x is most in front of, and then on the first.
  Foot nearest(const Vector3& x, double limit = std::numeric_limits<double>::infinity()) const;
  /// Whether the surface encloses x: an odd number of triangles above it.
  bool inside(const Vector3& x) const;
  /// Whether the straight line from a to b goes through a triangle.
  bool cuts(const Vector3& a, const Vector3& b) const;

  /// Triangles that reach into the cells of that box; some more than once.
  std::vector<int> in_box(const Vector3& low, const Vector3& high) const;

  const Vector3& low() const { return low_; }  // bounding box
  const Vector3& high() const { return high_; }

 private:
  using Cell = std::array<int, 3>;
  Cell cell_of(const Vector3& x) const;  // clamped to the grid
  double distance_to_cell(const Cell&, const Vector3& x) const;
  template <class Visit>
  void visit(const Cell& from, const Cell& to, Visit&&) const;
  std::size_t number(int x, int y, int z) const {
    return static_cast<std::size_t>((z * count_[1] + y) * count_[0] + x);
  }
  Vector3 corner(int triangle, int k) const { return position_.col(faces_(k, triangle)); }
  Foot foot_on(int triangle, const Vector3& x) const;
  double height_over(int triangle, const Vector3& x) const;
  bool is_before(const Foot&, const Foot& best, const Vector3& x) const;
  bool above(int triangle, const Vector3& x) const;

  Eigen::Matrix3Xd position_;
  Eigen::MatrixXi faces_;
  Vector3 low_ = Vector3::Zero(), high_ = Vector3::Zero();
  double cell_ = 1;
  Cell count_{0, 0, 0};
  std::vector<int> start_, member_;  // of each cell
};

}  // namespace strake::fluid
