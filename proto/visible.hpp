#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace strake {

/// A text as a terminal or a log may show it. Control characters, and bytes that are no UTF-8, become escapes
/// such as "\\x1b". Otherwise texts of a case file, a participant or a table could move the cursor, or forge
/// messages. kept: control characters that stay.
std::string visible(std::string_view text, std::string_view kept = "\n\t");

/// "a, b, c".
std::string joined(const std::vector<std::string>& words, const std::string& separator = ", ");

}  // namespace strake
