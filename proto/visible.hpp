#pragma once

#include <string>
#include <string_view>

namespace strake {

/// A text as a terminal or a log may show it: control characters, and bytes that are no UTF-8, as "\\x1b".
/// Texts of a case file, a participant or a table could else move the cursor, or write what nobody said.
/// kept: control characters that stay.
std::string visible(std::string_view text, std::string_view kept = "\n\t");

}  // namespace strake
