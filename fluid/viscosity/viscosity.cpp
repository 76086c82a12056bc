#include "fluid/viscosity/viscosity.hpp"

namespace strake::fluid {

template <int dim>
Vectors<dim> viscous_acceleration(const Vectors<dim>& velocity, const Neighbours& rows,
                                  const LatticeConstants& laplacian_lattice, double kinematic_viscosity,
                                  const Masks& masks) {
  if (kinematic_viscosity == 0) return Vectors<dim>::Zero(dim, rows.size());
  return kinematic_viscosity * laplacian<dim>(velocity, rows, laplacian_lattice, masks);
}

template Vectors<2> viscous_acceleration<2>(const Vectors<2>&, const Neighbours&, const LatticeConstants&,
                                            double, const Masks&);
template Vectors<3> viscous_acceleration<3>(const Vectors<3>&, const Neighbours&, const LatticeConstants&,
                                            double, const Masks&);

}  // namespace strake::fluid
