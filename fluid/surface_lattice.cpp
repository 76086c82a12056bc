#include "fluid/surface_lattice.hpp"

#include <cmath>

namespace strake::fluid {

template <int dim>
SurfaceLattice<dim>::SurfaceLattice(const LatticeConstants& laplacian, const LatticeConstants& gradient,
                                    double l0)
    : spacing(l0),
      weights(laplacian.n0),
      first_weights(laplacian.n0),
      first_moment(0),
      second_moment(0),
      first_crowding(0),
      row_height(0),
      volume(0) {
  const int reach = static_cast<int>(std::ceil(laplacian.radius / l0)), depth = dim == 3 ? reach : 0;
  double height = 0, height_squared = 0;
  for (int z = -depth; z <= depth; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const double r = l0 * std::sqrt(x * x + y * y + z * z);
        if (r == 0) continue;
        volume += volume_weight(r / laplacian.radius);
        if (y <= 0) continue;
        const double w = weight(r, laplacian.radius), near = weight(r, gradient.radius);
        first_weights -= w;
        first_moment += w * y * l0;
        if (y > 1) second_moment += w * y * l0;
        first_crowding += near * y * l0 / (r * r);
        height += near * y * l0;
        height_squared += near * y * l0 * y * l0;
      }
  row_height = height_squared / height;
}

template struct SurfaceLattice<2>;
template struct SurfaceLattice<3>;

}  // namespace strake::fluid
