#pragma once

#include "fluid/particles/state.hpp"
#include "proto/interface.hpp"

namespace strake::fluid {

/// The whole State under names of its own: what a checkpoint writes.
template <int dim>
void save(const State<dim>&, Archive&);
/// Back again, to the last bit. Throws Error(case_file) naming what is missing or of another size;
/// `n_probes`: as many as the case has.
template <int dim>
State<dim> load(const Archive&, std::size_t n_probes);

}  // namespace strake::fluid
