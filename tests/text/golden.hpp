#pragma once

#include <cstddef>
#include <string>

// Compiled once for all tests, which spares them the templates of <regex>.

namespace strake {

/// A text as it is stored: without what differs from one run to the next.
std::string without_chance(std::string text, const std::string& folder = {});

/// Compares a text with the block of that name in tests/text/FILE, whole. STRAKE_WRITE_TEXTS=1 writes the
/// block anew: read the difference before keeping it. Blocks are `==== name` and the text below.
void expect_stored(const std::string& file, const std::string& name, const std::string& text);

/// The name of the test that is under way.
std::string this_test();

/// Whether the whole of a text is as the expression says.
bool matches(const std::string& text, const std::string& expression);
/// What the expression's first brackets hold where it is found first, and the length of all that it found;
/// empty and 0 where it is not found.
struct Found {
  std::string in_brackets;
  std::size_t length = 0;
};
Found find_expression(const std::string& text, const std::string& expression);

}  // namespace strake
