#pragma once

#include "structure/body/parameters.hpp"

#include <string>

namespace strake {
class CaseFile;
}

namespace strake::structure {

/// Reads [structure] and what it shares with [fluid] (spacing, dimension, gravity, gravity_ramp); checks
/// across keys.
Parameters read(CaseFile&, const std::string& kind);
/// The same when the common keys have been read already.
Parameters read(CaseFile&, const std::string& kind, const CommonKeys&);

}  // namespace strake::structure
