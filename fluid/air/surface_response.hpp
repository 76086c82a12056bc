#pragma once

#include "fluid/air/air_layer.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <vector>

namespace strake::fluid {

/// How the water's surface below a layer of air moves beside the water's first row (fluid/THEORY.md (F95)).
/// The row lies l0/2 below the surface, and the water there follows a pressure that changes over less than
/// some spacings, as at a border, too slowly. Slopes of the surface are small.
template <int plane>
class SurfaceResponse {
 public:
  /// How far the surface may lie off the row, and the least length over which a pressure falls [l0].
  static constexpr double steep = 0.1;

  /// spacing: l0 [m]; density: ρ of the water [kg/m³]. The columns keep their places.
  SurfaceResponse(const AirColumns<plane>&, double spacing, double density);

  /// Returns ∂v/∂t of each column, upwards [m/s²]: v is the surface's velocity less that of the row. Nothing
  /// jumps at a side to a column that is in contact with the water, for the water carries the pressure on.
  Eigen::VectorXd acceleration(const AirColumns<plane>&, const AirState<plane>&,
                               const Eigen::VectorXd& pressure) const;

 private:
  /// A border beside its own column, which is as wide as `width` across it [m].
  struct Border {
    int column;
    double width;
  };
  double border_mean(double width, double gap) const;

  double spacing_, density_;
  Eigen::SparseMatrix<double> of_jumps_;  // columns × sides, of a jump along the side's normal [m/s² per Pa]
  std::vector<Border> borders_;
};

}  // namespace strake::fluid
