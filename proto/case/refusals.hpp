#pragma once

#include "proto/error.hpp"

#include <vector>

namespace strake {

/// One Error(case_file) with the texts of all, in their order, each once. An error may itself hold several:
/// each begins with a line that is not indented. errors: at least one.
Error all_of(const std::vector<Error>& errors);

}  // namespace strake
