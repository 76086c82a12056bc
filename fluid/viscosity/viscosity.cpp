#include "fluid/viscosity/viscosity.hpp"

#include <cassert>

namespace strake::fluid {

template <int dim>
Vectors<dim> viscous_acceleration(const Vectors<dim>& velocity, const Neighbours& rows,
                                  const LatticeConstants& laplacian_lattice, double kinematic_viscosity,
                                  const Masks& masks) {
  if (kinematic_viscosity == 0) return Vectors<dim>::Zero(dim, rows.size());
  return kinematic_viscosity * laplacian<dim>(velocity, rows, laplacian_lattice, masks);
}

// (2d/(n0 λ)) Σ_j ν_ij (u_j − u_i) w, ν_ij = 2 ν_i ν_j/(ν_i + ν_j), ν_i = ν + ν_t,i: the harmonic mean keeps
// the shear stress continuous where the viscosity jumps. Symmetric in i and j, so momentum is exact.
template <int dim>
Vectors<dim> viscous_acceleration(const Vectors<dim>& velocity, const Neighbours& rows,
                                  const LatticeConstants& laplacian_lattice, double kinematic_viscosity,
                                  const Eigen::VectorXd& eddy_viscosity, const Masks& masks) {
  assert(eddy_viscosity.size() == rows.size());
  Vectors<dim> acceleration = Vectors<dim>::Zero(dim, rows.size());
  const double factor = 2 * dim / (laplacian_lattice.n0 * laplacian_lattice.lambda0);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < rows.size(); ++i) {
    if (!masks.row.empty() && !masks.row[static_cast<std::size_t>(i)]) continue;
    const auto row = rows.row(i);
    const auto inverse = rows.inverses(i);
    const Vector<dim> here = velocity.col(i);
    const double own = kinematic_viscosity + eddy_viscosity[i];
    Vector<dim> sum = Vector<dim>::Zero();
    for (std::size_t k = 0; k < row.size(); ++k) {
      const auto j = row[k];
      const double w = laplacian_lattice.radius * inverse[k] - 1;
      if (w <= 0 || (!masks.column.empty() && !masks.column[static_cast<std::size_t>(j)])) continue;
      const double other = kinematic_viscosity + eddy_viscosity[j];
      if (own + other > 0) sum += (2 * own * other / (own + other) * w) * (velocity.col(j) - here);
    }
    acceleration.col(i) = factor * sum;
  }
  return acceleration;
}

template Vectors<2> viscous_acceleration<2>(const Vectors<2>&, const Neighbours&, const LatticeConstants&,
                                            double, const Masks&);
template Vectors<3> viscous_acceleration<3>(const Vectors<3>&, const Neighbours&, const LatticeConstants&,
                                            double, const Masks&);
template Vectors<2> viscous_acceleration<2>(const Vectors<2>&, const Neighbours&, const LatticeConstants&,
                                            double, const Eigen::VectorXd&, const Masks&);
template Vectors<3> viscous_acceleration<3>(const Vectors<3>&, const Neighbours&, const LatticeConstants&,
                                            double, const Eigen::VectorXd&, const Masks&);

}  // namespace strake::fluid
