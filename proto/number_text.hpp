#pragma once

#include <string>

namespace strake {

/// 3000 → "3 000".
std::string grouped(long long number);

}  // namespace strake
