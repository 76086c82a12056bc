#pragma once

#include <string>

namespace strake {

/// What this machine calls itself.
std::string host_name();

}  // namespace strake
