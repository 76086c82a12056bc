#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/state.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace strake::fluid {

/// Returns the number of dummy layers behind the wall layer of the tank. It is the largest n with n l0 < r_e,
/// where r_e is the largest radius of the scheme. The wall layer then has full support.
int dummy_rows(const Scheme&);

/// The box round some points, of which there is at least one.
Box bounds(const std::vector<Eigen::Vector3d>& points);

/// The water's shapes, each two corners of a box or a polygon: that of fluid.water where there is no other.
std::vector<std::vector<Eigen::Vector3d>> water_shapes(const Parameters&);

/// The reason why tank and water cannot be filled with particles: `key` of [fluid] should be `expected`.
struct BoxFault {
  std::string key, expected, fix;
};
/// Returns the first fault of the tank and the water, if there is one. Faults are: a box that is not a
/// multiple of l0, water not inside the tank, a spacing too coarse for the water, a polygon that cannot be a
/// tank, a tank too narrow to be periodic.
std::optional<BoxFault> find_box_fault(const Parameters&);

/// Whether x lies in one of the water's shapes.
template <int dim>
bool is_water_at(const Parameters&, const Vector<dim>& x);

/// Makes the particles of water and tank at t = 0. Water stands at (i + ½) l0 in the water's shapes, clipped
/// to the tank, and is packed against walls off the lattice (`pack`). Behind the tank's walls are one wall
/// layer at l0/2 and `dummy_rows` layers behind it. Order: fluid, wall, dummy_wall. The pressure is 0, the
/// velocity that of the tank at t = 0; water has its own besides (`InitialVelocity`). Throws Error(case_file)
/// where `find_box_fault` finds one. Bodies are added later, by `Simulation`.
template <int dim>
State<dim> fill(const Parameters&);

/// The water of one of several ranks at the start, and how much there is on all of them.
template <int dim>
struct WaterShare {
  State<dim> state;  // without layer particles
  std::int64_t water_of_whole;
};
/// Makes the same water for one of several ranks: its share in the order of the whole (`begin_of_share`). All
/// faces of the tank stand on the lattice.
template <int dim>
WaterShare<dim> fill_share(const Parameters&, int rank, int ranks);

}  // namespace strake::fluid
