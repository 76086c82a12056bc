#include "proto/visible.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace strake {
namespace {

/// A character at the begin of a text: its bytes and its number. No bytes: it is no UTF-8.
struct Character {
  std::size_t bytes = 0;
  std::uint32_t number = 0;
};

Character first_of(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return {1, lead};
  const std::size_t bytes = lead >= 0xF0 && lead < 0xF8 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return {};
  std::uint32_t number = lead & (0x7Fu >> bytes);
  for (std::size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xC0) != 0x80) return {};
    number = number << 6 | (byte(k) & 0x3Fu);
  }
  const bool longer_than_needed = (bytes == 3 && number < 0x800) || (bytes == 4 && number < 0x10000);
  const bool half_of_a_pair = number >= 0xD800 && number < 0xE000;
  return longer_than_needed || half_of_a_pair || number > 0x10FFFF ? Character{} : Character{bytes, number};
}

}  // namespace

std::string visible(std::string_view text, std::string_view kept) {
  std::string shown;
  while (!text.empty()) {
    const Character next = first_of(text);
    const bool control = next.number < 0x20 || (next.number >= 0x7F && next.number < 0xA0);
    const bool stays = next.bytes > 0 && (!control || (next.bytes == 1 && kept.find(text[0]) != kept.npos));
    const std::size_t taken = next.bytes > 0 ? next.bytes : 1;
    if (stays)
      shown += text.substr(0, taken);
    else
      shown += fmt::format("\\x{:02x}", next.bytes > 0 ? next.number : static_cast<unsigned char>(text[0]));
    text.remove_prefix(taken);
  }
  return shown;
}

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string all;
  for (std::size_t k = 0; k < words.size(); ++k) all += (k > 0 ? separator : "") + words[k];
  return all;
}

}  // namespace strake
