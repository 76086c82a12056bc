#include "coupler/watch/table_tail.hpp"

#include "proto/descriptor.hpp"

#include <chrono>
#include <cmath>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace strake::watch {
namespace {

constexpr std::size_t kept = 256;       // [bytes] of the part read before, to recognise the file
constexpr std::size_t piece = 1 << 20;  // [bytes] read at once

/// Up to `size` bytes from `from` on.
std::string bytes_at(int file, off_t from, std::size_t size) {
  std::string bytes(size, '\0');
  std::size_t got = 0;
  while (got < size) {
    const ssize_t n = ::pread(file, bytes.data() + got, size - got, from + static_cast<off_t>(got));
    if (n <= 0) break;
    got += static_cast<std::size_t>(n);
  }
  bytes.resize(got);
  return bytes;
}

}  // namespace

std::int64_t written_at(const std::filesystem::path& path) {
  struct stat now {};
  if (::stat(path.c_str(), &now) != 0) return 0;
  return static_cast<std::int64_t>(now.st_mtim.tv_sec) * 1'000'000'000 + now.st_mtim.tv_nsec;
}

std::int64_t clock_now() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

TableTail::TableTail(std::filesystem::path path) : path_(std::move(path)) {}

void TableTail::begin_anew() {
  table_ = {};
  damaged_ = 0;
  read_ = 0;
  last_bytes_.clear();
  ++generation_;
}

bool TableTail::update() {
  const Descriptor file(::open(path_.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat now {};
  if (!file || ::fstat(file.get(), &now) != 0 || !S_ISREG(now.st_mode)) {
    if (read_ == 0) return false;
    begin_anew();
    return true;
  }
  const std::uint32_t before = generation_;
  const auto size = static_cast<off_t>(last_bytes_.size());
  if (read_ > 0 && (now.st_ino != inode_ || now.st_size < read_ ||
                    bytes_at(file.get(), read_ - size, last_bytes_.size()) != last_bytes_))
    begin_anew();
  inode_ = now.st_ino;
  bool any = generation_ != before;
  for (std::size_t wanted = piece; read_ < now.st_size;) {
    const std::string bytes = bytes_at(file.get(), read_, wanted);
    const auto end = bytes.rfind('\n');
    if (end == std::string::npos) {
      if (bytes.size() < wanted) break;  // the last line is still being written
      wanted *= 2;
      continue;
    }
    std::string_view rest = std::string_view(bytes).substr(0, end + 1);
    while (!rest.empty()) {
      const auto newline = rest.find('\n');
      if (table_.add(rest.substr(0, newline))) ++damaged_;
      rest.remove_prefix(newline + 1);
    }
    read_ += static_cast<off_t>(end + 1);
    last_bytes_ = (last_bytes_ + bytes.substr(0, end + 1));
    if (last_bytes_.size() > kept) last_bytes_.erase(0, last_bytes_.size() - kept);
    any = true;
  }
  return any;
}

std::optional<double> TableTail::last(std::string_view name) const {
  const auto column = find(name);
  if (!column || rows() == 0 || std::isnan(value()[*column].back())) return std::nullopt;
  return value()[*column].back();
}

}  // namespace strake::watch
