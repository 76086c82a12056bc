#include "coupler/watch/web/array_message.hpp"

#include <bit>

namespace strake::watch {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays go out as they lie in memory");

std::size_t padded(std::size_t bytes) {
  return (bytes + 7) / 8 * 8;
}

}  // namespace

void ArrayMessage::add(const std::string& name, const char* type, const void* data, std::size_t count,
                       std::size_t size) {
  arrays_.push_back({name, type, count, data_.size()});
  data_.append(static_cast<const char*>(data), count * size);
  data_.resize(padded(data_.size()), '\0');
}

void ArrayMessage::add(const std::string& name, std::span<const float> a) {
  add(name, "f32", a.data(), a.size(), sizeof(float));
}
void ArrayMessage::add(const std::string& name, std::span<const double> a) {
  add(name, "f64", a.data(), a.size(), sizeof(double));
}
void ArrayMessage::add(const std::string& name, std::span<const std::uint32_t> a) {
  add(name, "u32", a.data(), a.size(), sizeof(std::uint32_t));
}
void ArrayMessage::add(const std::string& name, std::span<const std::uint8_t> a) {
  add(name, "u8", a.data(), a.size(), sizeof(std::uint8_t));
}

std::string ArrayMessage::bytes() const {
  constexpr std::size_t length_bytes = 4;
  // The offsets stand in the head, whose length shifts them: it is made longer until it fits.
  std::string text;
  std::size_t first = 0;
  do {
    first = padded(std::max(first + 8, text.size() + length_bytes));
    Json json = head;
    json["arrays"] = Json::object();
    for (const Array& array : arrays_)
      json["arrays"][array.name] = {{"type", array.type}, {"at", first + array.at}, {"count", array.count}};
    text = json_text(json);
  } while (text.size() + length_bytes > first);
  text.resize(first - length_bytes, ' ');
  const auto n = static_cast<std::uint32_t>(text.size());
  std::string all(reinterpret_cast<const char*>(&n), length_bytes);
  return all + text + data_;
}

}  // namespace strake::watch
