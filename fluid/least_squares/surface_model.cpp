#include "fluid/least_squares/surface_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake::fluid {

template <int dim>
SurfaceLattice<dim>::SurfaceLattice(const LatticeConstants& laplacian, double l0)
    : spacing(l0),
      weights(laplacian.n0),
      first_weights(laplacian.n0),
      first_moment(0),
      second_moment(0),
      volume(0),
      filled_{},
      layer_(laplacian.radius / layers) {
  const int reach = static_cast<int>(std::ceil(laplacian.radius / l0)), depth = dim == 3 ? reach : 0;
  double above_first = 0, above_second = 0;
  for (int z = -depth; z <= depth; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const double r = l0 * std::sqrt(x * x + y * y + z * z);
        if (r == 0) continue;
        const double part = volume_weight(r / laplacian.radius);
        volume += part;
        if (y <= 0) continue;
        const double w = weight(r, laplacian.radius);
        first_weights -= w;
        first_moment += w * y * l0;
        above_first += part;
        if (y == 1) continue;
        second_moment += w * y * l0;
        above_second += part;
      }
  // Integrates ∫_{y<d} W / ∫ W over planes of distance y to the particle. Each plane is divided into rings
  // (2-D: pairs of points) of radius x.
  double half = 0;
  for (int j = 0; j < layers; ++j) {
    const double y = (j + 0.5) * layer_;
    for (int i = 0; i < layers; ++i) {
      const double x = (i + 0.5) * layer_;
      half += volume_weight(std::hypot(x, y) / laplacian.radius) * (dim == 3 ? std::numbers::pi * x : 1.0);
    }
    filled_[static_cast<std::size_t>(j) + 1] = half;
  }
  for (double& part : filled_) part = 0.5 + 0.5 * part / half;
  first_seen_ = seen(1 - above_first / (volume + 1));
  second_seen_ = seen(1 - above_second / (volume + 1));
}

template <int dim>
double SurfaceLattice<dim>::seen(double filled) const {
  const auto above = std::upper_bound(filled_.begin(), filled_.end(), filled);
  if (above == filled_.begin()) return 0;
  if (above == filled_.end()) return layers * layer_;
  const auto below = above - 1;
  return (static_cast<double>(below - filled_.begin()) + (filled - *below) / (*above - *below)) * layer_;
}

template <int dim>
double SurfaceLattice<dim>::depth(double filled) const {
  const double slope = spacing / (second_seen_ - first_seen_);
  return 0.5 * spacing + slope * (seen(filled) - first_seen_);
}

template class SurfaceLattice<2>;
template class SurfaceLattice<3>;

}  // namespace strake::fluid
