#pragma once

#include <charconv>
#include <cstdint>
#include <ctime>
#include <optional>
#include <span>
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

/// Two digits for each byte: "0a1f".
std::string hexadecimal(std::span<const std::uint8_t> bytes);

/// A date and a time of the day by the letters of strftime, of at most 63 bytes.
std::string time_text(const char* format, const std::tm& time);

/// "Pressure" → "pressure"; letters beyond ASCII stay as they are.
std::string lower_case(std::string_view);

}  // namespace strake
