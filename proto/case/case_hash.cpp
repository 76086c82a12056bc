#include "proto/case/case_document.hpp"
#include "proto/files/whole_file.hpp"

#include <sodium.h>

#include <algorithm>
#include <fstream>
#include <vector>

namespace strake {
namespace {

/// SHA-256 of a list of parts. Before each part its length is added as 8 bytes, least significant first, so
/// that ("ab", "c") and ("a", "bc") differ.
class Digest {
 public:
  Digest() { crypto_hash_sha256_init(&state_); }
  void length(std::uint64_t n) {
    std::array<unsigned char, 8> bytes{};
    for (unsigned char& byte : bytes) {
      byte = static_cast<unsigned char>(n & 0xff);
      n >>= 8;
    }
    crypto_hash_sha256_update(&state_, bytes.data(), bytes.size());
  }
  void bytes(const char* data, std::size_t n) {
    crypto_hash_sha256_update(&state_, reinterpret_cast<const unsigned char*>(data), n);
  }
  void part(const std::string& text) {
    length(text.size());
    bytes(text.data(), text.size());
  }
  std::array<std::uint8_t, 32> result() {
    std::array<std::uint8_t, 32> hash{};
    crypto_hash_sha256_final(&state_, hash.data());
    return hash;
  }

 private:
  crypto_hash_sha256_state state_;
};

/// Every text of the case, tables by key, arrays in order.
void collect_texts(const toml::node& node, std::vector<std::string>& texts) {
  if (const auto* text = node.as_string()) texts.push_back(text->get());
  if (const auto* array = node.as_array())
    for (const toml::node& element : *array) collect_texts(element, texts);
  if (const auto* table = node.as_table())
    for (auto&& [key, value] : *table) collect_texts(value, texts);
}

/// Adds a file's length, and its bytes if they fit into the remaining budget `left`. The budget is needed
/// because any text of the case may name a file, even one that no key reads.
void add_file(Digest& digest, const std::filesystem::path& path, std::uintmax_t& left) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) || error) return;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) return;
  digest.length(size);
  if (size > left) return;
  left -= size;
  std::vector<char> block(1 << 16);
  std::uintmax_t rest = size;  // no more than that, where something is still writing to it
  while (rest > 0) {
    in.read(block.data(), static_cast<std::streamsize>(std::min<std::uintmax_t>(rest, block.size())));
    if (in.gcount() <= 0) break;
    digest.bytes(block.data(), static_cast<std::size_t>(in.gcount()));
    rest -= static_cast<std::uintmax_t>(in.gcount());
  }
}

}  // namespace

std::array<std::uint8_t, 32> CaseFile::hash() const {
  if (document_->whole) return CaseFile(std::const_pointer_cast<Document>(document_->whole)).hash();
  Digest digest;
  digest.part(document_->bytes);
  for (const Document::Set& set : document_->sets) digest.part(set.argument);
  std::vector<std::string> texts;
  collect_texts(document_->root, texts);
  std::uintmax_t left = largest_table;
  for (const std::string& text : texts)
    if (!text.empty() && text.find('\0') == std::string::npos) add_file(digest, folder() / text, left);
  return digest.result();
}

}  // namespace strake
