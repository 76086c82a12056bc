#pragma once

#include <Eigen/Core>

#include <vector>

namespace strake::fluid {

/// Columns of air between a body and the water, seen from above: cells of a line (plane = 1, per metre of
/// depth) or of an area (plane = 2).
template <int plane>
struct AirColumns {
  using Place = Eigen::Matrix<double, plane, 1>;
  /// What two columns share, or a column and the open air.
  struct Side {
    int column = 0, other = -1;    // −1: the open air
    Place normal = Place::Zero();  // from `column` to `other`, of length 1
    double length = 1;             // [m]; on a line 1
    Place middle = Place::Zero();  // [m]
  };
  Eigen::Matrix<double, plane, Eigen::Dynamic> place;  // middles, plane×n [m]
  Eigen::VectorXd area;                                // n [m²]; on a line the width [m]
  std::vector<Side> sides;

  int size() const { return static_cast<int>(area.size()); }
};

/// Columns side by side in the order of x, open at both ends. middle, width: n [m].
AirColumns<1> air_strip(const Eigen::VectorXd& middle, const Eigen::VectorXd& width);
/// n columns of equal width from x = low to high.
AirColumns<1> air_strip(double low, double high, int n);

}  // namespace strake::fluid
