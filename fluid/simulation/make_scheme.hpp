#pragma once

#include "fluid/scheme/fluid_scheme.hpp"

#include <memory>

namespace strake::fluid {

/// Returns the data that neighbour rows keep of each pair, for the scheme that the parameters name.
PairData pair_data(const Scheme&);
/// Makes the scheme that `gradient` names. Throws Error(case_file) for a coupling that it does not have.
template <int dim>
std::unique_ptr<FluidScheme<dim>> make_scheme(const StepData<dim>&);

}  // namespace strake::fluid
