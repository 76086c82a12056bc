#pragma once

#include "fluid/parameters/parameters.hpp"

namespace strake {
class CaseFile;
}

namespace strake::fluid {

/// Reads [fluid], [fluid.scheme] and what it shares; checks across keys (water inside tank, time step against
/// window …).
Parameters read(CaseFile&);
Parameters read(CaseFile&, const CommonKeys&);

}  // namespace strake::fluid
