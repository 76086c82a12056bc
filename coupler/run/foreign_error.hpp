#pragma once

#include "proto/error.hpp"

#include <exception>
#include <string>

namespace strake {

/// Converts an exception that our code did not throw. If the system refused an operation on a file it is exit
/// 6, else a bug of ours at that place (exit 70).
Error error_of(const std::exception&, const std::string& where);

}  // namespace strake
