#pragma once

#include "proto/error.hpp"

#include <exception>
#include <string>

namespace strake {

/// An exception that no code of ours threw: what the system refused to do with a file (exit 6), else a bug of
/// ours at that place (exit 70).
Error error_of(const std::exception&, const std::string& where);

}  // namespace strake
