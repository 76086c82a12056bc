#include "fluid/air/surface_response.hpp"

#include "fluid/air/near_columns.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace strake::fluid {
namespace {

constexpr double reach = 4;  // [l0] past which surface and row move alike: 1/x − x/(x² + d²) is 0.004/l0

// A pressure that jumps by 1 along the normal of a side moves the surface at x by 1/(πρx), and the water at
// the depth d by x/(πρ(x² + d²)), both downwards where x > 0. In space the side has a length:
//   I(X) = ∫ x/(X² + s²)^(3/2) ds = x/X² [ s/√(X² + s²) ] between its ends, in place of 2x/X².
template <int plane>
double kernel(const typename AirColumns<plane>::Side& side,
              const typename AirColumns<plane>::Place& from_middle, double depth) {
  const double x = from_middle.dot(side.normal), surface = x * x, row = surface + depth * depth;
  if constexpr (plane == 1) {
    return (x / surface - x / row) / std::numbers::pi;
  } else {
    const double along = (from_middle - x * side.normal).norm();
    const double near = 0.5 * side.length - along, far = 0.5 * side.length + along;
    const auto line = [&](double square) {
      return x / square * (near / std::sqrt(square + near * near) + far / std::sqrt(square + far * far));
    };
    return (line(surface) - line(row)) / (2 * std::numbers::pi);
  }
}

}  // namespace

template <int plane>
SurfaceResponse<plane>::SurfaceResponse(const AirColumns<plane>& columns, double spacing, double density)
    : spacing_(spacing),
      density_(density),
      of_jumps_(columns.size(), static_cast<Eigen::Index>(columns.sides.size())) {
  const NearColumns<plane> near(columns.place, reach * spacing);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t s = 0; s < columns.sides.size(); ++s) {
    const auto& side = columns.sides[s];
    near.for_each(side.middle, [&](int c, double) {
      const typename AirColumns<plane>::Place from_middle = columns.place.col(c) - side.middle;
      const double across = std::abs(from_middle.dot(side.normal));
      if (across < 1e-6 * spacing) return;  // along the side itself: nothing
      if (side.other < 0 && c == side.column) borders_.push_back({c, 2 * across});
      entries.emplace_back(c, static_cast<int>(s),
                           -kernel<plane>(side, from_middle, 0.5 * spacing) / density);
    });
  }
  of_jumps_.setFromTriplets(entries.begin(), entries.end());
}

// At a border the pressure falls over the gap h, and the surface moves most just inside. Mean over the width
// b of the column less the value in its middle:
//   ( ln(1 + b²/h²) − ln(1 + b²/d²) )/(2πb) − K(b/2)
template <int plane>
double SurfaceResponse<plane>::border_mean(double width, double gap) const {
  const double middle = 0.5 * width, depth = 0.5 * spacing_, fall = std::max(gap, steep * spacing_);
  const auto mean = [&](double length) { return std::log1p(std::pow(width / length, 2)) / (2 * width); };
  const double in_middle = 1 / middle - middle / (middle * middle + depth * depth);
  return (mean(fall) - mean(depth) - in_middle) / std::numbers::pi;
}

template <int plane>
Eigen::VectorXd SurfaceResponse<plane>::acceleration(const AirColumns<plane>& columns,
                                                     const AirState<plane>& state,
                                                     const Eigen::VectorXd& pressure) const {
  Eigen::VectorXd jump = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns.sides.size()));
  for (std::size_t s = 0; s < columns.sides.size(); ++s) {
    const int i = columns.sides[s].column, j = columns.sides[s].other;
    if (!(state.mass[i] > 0) || (j >= 0 && !(state.mass[j] > 0))) continue;
    jump[static_cast<Eigen::Index>(s)] = (j < 0 ? 0 : pressure[j]) - pressure[i];
  }
  Eigen::VectorXd upwards = of_jumps_ * jump;
  for (const Border& border : borders_)
    if (const int c = border.column; state.mass[c] > 0)
      upwards[c] -= pressure[c] / density_ * border_mean(border.width, state.gap[c]);
  return upwards;
}

template class SurfaceResponse<1>;
template class SurfaceResponse<2>;

}  // namespace strake::fluid
