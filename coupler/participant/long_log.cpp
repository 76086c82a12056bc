#include "coupler/participant/long_log.hpp"

#include "proto/descriptor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace strake {
namespace {

bool write_at(int file, const char* data, std::size_t count, off_t place) {
  while (count > 0) {
    const ssize_t n = pwrite(file, data, count, place);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    data += n;
    count -= static_cast<std::size_t>(n);
    place += n;
  }
  return true;
}

/// Reads up to the buffer's size. Returns the number of bytes, 0 at the end of the file or after a fault.
std::size_t read_at(int file, std::vector<char>& buffer, off_t place) {
  ssize_t n = 0;
  do n = pread(file, buffer.data(), buffer.size(), place);
  while (n < 0 && errno == EINTR);
  return n > 0 ? static_cast<std::size_t>(n) : 0;
}

/// The first line that begins at `place` or behind it; `place` itself where no line is near.
off_t next_line(int file, off_t place) {
  std::vector<char> buffer(std::size_t{1} << 16);
  const std::size_t n = read_at(file, buffer, place - 1);
  const auto end = buffer.begin() + static_cast<std::ptrdiff_t>(n);
  const auto found = std::find(buffer.begin(), end, '\n');
  return found == end ? place : place + (found - buffer.begin());
}

}  // namespace

bool free_middle(const std::filesystem::path& log, const LogBounds& bounds) {
  const Descriptor file(open(log.c_str(), O_WRONLY | O_CLOEXEC));
  struct stat now {};
  if (!file || fstat(file.get(), &now) != 0 || !S_ISREG(now.st_mode)) return false;
  constexpr std::size_t block = 512;  // [bytes] of st_blocks
  if (static_cast<std::size_t>(now.st_blocks) * block <= bounds.most) return false;
  const std::string note = fmt::format(
      "\n[strake: the log is longer than {} MB, its middle is left out here]\n", bounds.most >> 20);
  const auto begin = static_cast<off_t>(bounds.first + note.size()),
             end = now.st_size - static_cast<off_t>(bounds.last);
  if (begin >= end) return false;
  if (fallocate(file.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, begin, end - begin) != 0)
    return false;
  return write_at(file.get(), note.data(), note.size(), static_cast<off_t>(bounds.first));
}

void take_out_middle(const std::filesystem::path& log, const LogBounds& bounds) {
  if (log.empty()) return;
  const Descriptor file(open(log.c_str(), O_RDWR | O_CLOEXEC));
  struct stat now {};
  if (!file || fstat(file.get(), &now) != 0 || !S_ISREG(now.st_mode)) return;
  if (static_cast<std::size_t>(now.st_size) <= bounds.most) return;
  const auto first = static_cast<off_t>(bounds.first);
  off_t from = next_line(file.get(), now.st_size - static_cast<off_t>(bounds.last));
  const std::string note = fmt::format("\n[strake: {} bytes of the log are left out here]\n", from - first);
  if (!write_at(file.get(), note.data(), note.size(), first)) return;
  off_t to = first + static_cast<off_t>(note.size());
  std::vector<char> buffer(std::size_t{1} << 20);
  for (std::size_t n = 0; (n = read_at(file.get(), buffer, from)) > 0; from += static_cast<off_t>(n)) {
    if (!write_at(file.get(), buffer.data(), n, to)) return;  // the end still stands behind
    to += static_cast<off_t>(n);
  }
  if (ftruncate(file.get(), to) != 0) return;  // all is kept then
}

bool LogLength::look(const std::filesystem::path& log, Clock::time_point now) {
  constexpr std::chrono::milliseconds between{250};
  if (log.empty() || now < next_) return false;
  next_ = now + between;
  return free_middle(log) && !std::exchange(told_, true);
}

}  // namespace strake
