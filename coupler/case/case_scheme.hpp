#pragma once

#include "coupler/case/coupling_keys.hpp"
#include "coupler/coupling/scheme.hpp"
#include "coupler/processes/remote.hpp"
#include "proto/case/case_keys.hpp"

#include <optional>
#include <string>

namespace strake {

/// What a case says of its coupling, for the process that runs the scheme.
struct CouplingCase {
  CommonKeys common;
  CouplingKeys coupling;
  std::optional<double> spacing;  // [m] fluid.spacing, where there is one
};

SchemeParameters scheme_of(const CouplingCase&, const Participant& structure);
FieldTransfer transfer_of(const CouplingCase&, const Participant& structure, const Participant& fluid);
/// What beside the solvers' own words may help where no window is short enough; may be empty.
std::string remedy_of(const CouplingCase&);
Deadlines deadlines_of(const WaitingKeys&, bool patient);

}  // namespace strake
