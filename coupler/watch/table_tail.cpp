#include "coupler/watch/table_tail.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fcntl.h>
#include <limits>
#include <sys/stat.h>
#include <unistd.h>

namespace strake::watch {
namespace {

constexpr std::size_t kept = 256;       // [bytes] of the part read before, to recognise the file
constexpr std::size_t piece = 1 << 20;  // [bytes] read at once

/// A file that closes itself.
class Descriptor {
 public:
  explicit Descriptor(const std::filesystem::path& path)
      : file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~Descriptor() {
    if (file_ >= 0) ::close(file_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return file_; }

 private:
  int file_ = -1;
};

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

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

GrowingTable::GrowingTable(std::filesystem::path path) : path_(std::move(path)) {}

void GrowingTable::begin_anew() {
  columns_.clear();
  value_.clear();
  damaged_ = 0;
  read_ = 0;
  last_bytes_.clear();
  ++generation_;
}

bool GrowingTable::look() {
  const Descriptor file(path_);
  struct stat now {};
  if (file.get() < 0 || ::fstat(file.get(), &now) != 0 || !S_ISREG(now.st_mode)) {
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
      take_line(trimmed(rest.substr(0, newline)));
      rest.remove_prefix(newline + 1);
    }
    read_ += static_cast<off_t>(end + 1);
    last_bytes_ = (last_bytes_ + bytes.substr(0, end + 1));
    if (last_bytes_.size() > kept) last_bytes_.erase(0, last_bytes_.size() - kept);
    any = true;
  }
  return any;
}

bool GrowingTable::take_header(std::string_view line) {
  std::vector<Column> columns;
  while (true) {
    const auto comma = line.find(',');
    const std::string_view cell = trimmed(line.substr(0, comma));
    const auto bracket = cell.find('[');
    if (bracket == std::string_view::npos || bracket == 0 || !cell.ends_with(']')) return false;
    columns.push_back({std::string(trimmed(cell.substr(0, bracket))),
                       std::string(cell.substr(bracket + 1, cell.size() - bracket - 2))});
    if (comma == std::string_view::npos) break;
    line.remove_prefix(comma + 1);
  }
  columns_ = std::move(columns);
  value_.assign(columns_.size(), {});
  return true;
}

void GrowingTable::take_line(std::string_view line) {
  if (line.starts_with('#') || line.empty()) return;
  if (columns_.empty()) {
    if (!take_header(line)) ++damaged_;
    return;
  }
  std::vector<double> row;
  row.reserve(columns_.size());
  while (true) {
    const auto comma = line.find(',');
    const std::string_view cell = trimmed(line.substr(0, comma));
    double value = std::numeric_limits<double>::quiet_NaN();
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (!cell.empty() && (error != std::errc() || end != cell.data() + cell.size())) break;
    row.push_back(cell.empty() ? std::numeric_limits<double>::quiet_NaN() : value);
    if (comma == std::string_view::npos) {
      if (row.size() != columns_.size()) break;
      for (std::size_t c = 0; c < row.size(); ++c) value_[c].push_back(row[c]);
      return;
    }
    line.remove_prefix(comma + 1);
  }
  ++damaged_;
}

std::optional<std::size_t> GrowingTable::find(std::string_view name) const {
  for (std::size_t c = 0; c < columns_.size(); ++c)
    if (columns_[c].name == name) return c;
  return std::nullopt;
}

std::optional<double> GrowingTable::last(std::string_view name) const {
  const auto column = find(name);
  if (!column || rows() == 0 || std::isnan(value_[*column].back())) return std::nullopt;
  return value_[*column].back();
}

}  // namespace strake::watch
