#pragma once

#include <string>

namespace strake::report {

/// The whole page: one file, its style within, nothing fetched from anywhere. The contents are made from the
/// sections of `body`.
std::string page(const std::string& title, const std::string& lead, const std::string& body);

}  // namespace strake::report
