#pragma once

#include "proto/files/json_file.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <span>
#include <string>

namespace strake::watch {

/// Named arrays and a few words about them as one block of bytes for the page:
///   4 bytes   length n of the head, little-endian
///   n bytes   JSON, {"arrays": {name: {"type": "f32" | "f64" | "u32" | "u8", "at": offset [bytes], "count":
///   …}}, …},
///             with blanks behind it, so that 4 + n is a multiple of 8
///   the arrays, little-endian, each at its offset from the block's first byte, a multiple of 8: a page uses
///   them in place.
class ArrayMessage {
 public:
  Json head;
  void add(const std::string& name, std::span<const float>);
  void add(const std::string& name, std::span<const double>);
  void add(const std::string& name, std::span<const std::uint32_t>);
  void add(const std::string& name, std::span<const std::uint8_t>);
  std::string bytes() const;

 private:
  struct Array {
    std::string name, type;
    std::size_t count = 0, at = 0;  // at: from the first array
  };
  void add(const std::string& name, const char* type, const void* data, std::size_t count, std::size_t size);
  std::vector<Array> arrays_;
  std::string data_;
};

}  // namespace strake::watch
