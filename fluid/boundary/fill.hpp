#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/state.hpp"

#include <optional>
#include <string>
#include <vector>

namespace strake::fluid {

/// Rows of dummies behind a wall row so that the wall row itself has full support: the largest n with n l0 <
/// r_e, r_e the largest radius of the scheme.
int dummy_rows(const Scheme&);

/// The water's shapes, each two corners of a box or a polygon: that of fluid.water where there is no other.
std::vector<std::vector<Eigen::Vector3d>> water_shapes(const Parameters&);

/// Why tank and water cannot be filled with particles: `key` of [fluid] should be `expected`.
struct BoxFault {
  std::string key, expected, fix;
};
/// A box that is not a multiple of l0, water not inside the tank, a spacing too coarse for the water, a
/// polygon that can be no tank, a tank too narrow to be periodic.
std::optional<BoxFault> find_box_fault(const Parameters&);

/// Water and tank at rest: fluid at (i + ½) l0 in the water's shapes, clipped to the tank, and packed against
/// walls off the lattice (`pack`); behind the tank's walls one wall row at l0/2 and `dummy_rows` rows behind
/// it. Order: fluid, wall, dummy_wall. Pressure 0; velocity that of the tank at t = 0. Throws
/// Error(case_file) where `find_box_fault` finds one. No bodies: `Simulation` adds them.
template <int dim>
State<dim> fill(const Parameters&);

}  // namespace strake::fluid
