#pragma once

#include <optional>
#include <string>

#include "fluid/parameters.hpp"
#include "fluid/state.hpp"

namespace strake::fluid {

/// Rows of dummies behind a wall row so that the wall row itself has full support: the largest n with n l0 <
/// r_e, r_e the largest radius of the scheme.
int dummy_rows(const Scheme&);

/// Why tank and water cannot be filled with particles: `key` of [fluid] should be `expected`.
struct BoxFault {
  std::string key, expected, fix;
};
/// A box that is not a multiple of l0, water not inside the tank, a spacing too coarse for the water.
std::optional<BoxFault> find_box_fault(const Parameters&);

/// Water and tank at rest: fluid at (i + ½) l0 in the water box; around the tank box, on its floor and sides
/// (open at the top), one wall row at l0/2 outside the box and `dummy_rows` rows behind it. Order: fluid,
/// wall, dummy_wall. Pressure 0. Throws Error(case_file) where `find_box_fault` finds one. No bodies:
/// `Simulation` adds them.
template <int dim>
State<dim> fill(const Parameters&);

}  // namespace strake::fluid
