#pragma once

#include "coupler/participant/serve.hpp"

namespace strake {

/// How to reach the coupler, from the environment of a program that Strake starts: STRAKE_CONNECT,
/// STRAKE_NAME, STRAKE_CASE_HASH, STRAKE_TOKEN (proto/WIRE.md). Error(command_line) if one is missing or
/// cannot be.
ServeOptions connection_of_environment();

}  // namespace strake
