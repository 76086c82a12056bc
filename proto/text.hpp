#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace strake {

/// 3000 → "3 000".
std::string grouped(long long number);

/// The number that a text is from its first letter to its last; nothing for any other text.
template <class Number>
std::optional<Number> number_from(std::string_view text) {
  Number value{};
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  return error == std::errc() && end == last ? std::optional(value) : std::nullopt;
}

/// Without the blanks, tabs and line ends on either side.
std::string_view trimmed(std::string_view);

/// "Pressure" → "pressure"; letters beyond ASCII stay as they are.
std::string lower_case(std::string_view);

}  // namespace strake
