#pragma once

#include <string>

namespace strake::report {

/// RFC 4648, with padding.
std::string base64(const std::string& bytes);

}  // namespace strake::report
