#include "coupler/run/checkpoint.hpp"
#include "proto/error.hpp"
#include "proto/files/result_file.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <vector>

namespace strake {

namespace fs = std::filesystem;

namespace {

struct Sum {
  std::uintmax_t size = 0;
  std::string digest;  // hexadecimal
};

/// Size and BLAKE2b-256 of a file; nothing in `digest` when it cannot be read.
Sum sum_of(const fs::path& path) {
  Sum sum;
  std::ifstream in(path, std::ios::binary);
  if (!in) return sum;
  crypto_generichash_state state;
  crypto_generichash_init(&state, nullptr, 0, crypto_generichash_BYTES);
  std::vector<char> block(1 << 16);
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
    const auto n = static_cast<std::size_t>(in.gcount());
    crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(block.data()), n);
    sum.size += n;
  }
  if (in.bad()) return sum;
  std::array<unsigned char, crypto_generichash_BYTES> bytes{};
  crypto_generichash_final(&state, bytes.data(), bytes.size());
  sum.digest = hexadecimal(bytes);
  return sum;
}

}  // namespace

void write_checksums(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.is_regular_file() && entry.path().filename() != checksums_name) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string text;
  for (const fs::path& file : files) {
    sync_to_disk(file);
    const Sum sum = sum_of(file);
    if (error || sum.digest.empty())
      throw Error(ExitCode::cannot_write, file.string(), "cannot be read back", "look at the disk");
    text += fmt::format("{} {} {}\n", sum.digest, sum.size, file.filename().string());
  }
  write_text(folder / checksums_name, text);
}

std::string damage(const fs::path& folder) {
  std::ifstream list(folder / checksums_name);
  if (!list) return fmt::format("holds no {}: it was never finished", checksums_name);
  std::size_t files = 0;
  for (std::string line; std::getline(list, line); ++files) {
    std::istringstream words(line);
    Sum expected;
    std::string name;
    if (!(words >> expected.digest >> expected.size) || !std::getline(words >> std::ws, name))
      return fmt::format("{} is damaged", checksums_name);
    std::error_code none;
    if (!fs::exists(folder / name, none)) return name + " is missing";
    const Sum found = sum_of(folder / name);
    if (found.size != expected.size)
      return fmt::format("{} holds {} bytes, not {}", name, found.size, expected.size);
    if (found.digest != expected.digest) return name + " has other bytes than were written";
  }
  return files == 0 ? fmt::format("{} is empty", checksums_name) : "";
}

}  // namespace strake
