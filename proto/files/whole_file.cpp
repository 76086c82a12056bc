#include "proto/files/whole_file.hpp"

#include "proto/descriptor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace strake {
namespace {

constexpr const char* check_path = "check the path; relative paths start at the current folder";

Error cannot_read(const std::string& where, int error_number) {
  if (error_number == ENOENT) return {ExitCode::case_file, where, "no such file", check_path};
  return {ExitCode::case_file, where, "cannot be read: " + std::generic_category().message(error_number),
          error_number == EACCES || error_number == EPERM ? "check the file's permissions" : check_path};
}

void require_regular(const struct stat& found, std::uintmax_t largest, const std::string& where) {
  if (S_ISDIR(found.st_mode)) throw Error(ExitCode::case_file, where, "is a folder, not a file", check_path);
  if (!S_ISREG(found.st_mode))
    throw Error(ExitCode::case_file, where, "is a pipe, a device or a socket, not a file: it may never end",
                "save what it gives as a file, and name that");
  if (const auto size = static_cast<std::uintmax_t>(found.st_size); size > largest)
    throw Error(ExitCode::case_file, where,
                fmt::format("has {:.3g} MB, at most {:.3g} MB are read here",
                            1e-6 * static_cast<double>(size), 1e-6 * static_cast<double>(largest)),
                "check the path, or leave out what the run does not need");
}

}  // namespace

void require_file(const std::filesystem::path& path, std::uintmax_t largest, const std::string& where) {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0) throw cannot_read(where, errno);
  require_regular(found, largest, where);
  if (access(path.c_str(), R_OK) != 0) throw cannot_read(where, errno);
}

std::string read_whole(const std::filesystem::path& path, std::uintmax_t largest, const std::string& where) {
  require_file(path, largest, where);  // before it is opened: opening a device may do something
  // Opens without waiting: a pipe without a writer would block the program here.
  const Descriptor file(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  struct stat found {};
  if (!file || fstat(file.get(), &found) != 0) throw cannot_read(where, errno);
  require_regular(found, largest, where);
  std::string bytes(static_cast<std::size_t>(found.st_size), '\0');
  std::size_t read_so_far = 0;
  while (read_so_far < bytes.size()) {
    const ssize_t n = read(file.get(), bytes.data() + read_so_far, bytes.size() - read_so_far);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw cannot_read(where, errno);
    if (n == 0) break;
    read_so_far += static_cast<std::size_t>(n);
  }
  bytes.resize(read_so_far);
  return bytes;
}

namespace {

/// 0 or the system's error number. Some file systems cannot wait for a folder, or for anything: no fault of
/// the write.
int synced(int file) {
  int result = 0;
  do result = fsync(file);
  while (result != 0 && errno == EINTR);
  return result == 0 || errno == EINVAL || errno == ENOTSUP || errno == EROFS ? 0 : errno;
}

}  // namespace

Error cannot_write(const std::filesystem::path& path, int error_number) {
  std::string fix = "free space there or choose another folder: --runs of a run, -o of one file";
  if (error_number == ENOENT || error_number == ENOTDIR)
    fix = "make the folder " + path.parent_path().string();
  if (error_number == EACCES || error_number == EROFS || error_number == EPERM)
    fix = "choose a folder that may be written: --runs of a run, -o of one file";
  return {ExitCode::cannot_write, path.string(),
          "cannot be written: " + std::generic_category().message(error_number), fix};
}

namespace {

/// Paths of the files that are being written, one per thread that writes.
struct Slot {
  enum State { free, taken, named };
  std::atomic<int> state{free};
  std::array<char, 4096> path{};
};
std::array<Slot, 4> slots;

/// Notes the path for `remove_unfinished_file` as long as it lives.
class Unfinished {
 public:
  explicit Unfinished(const std::string& path) {
    for (Slot& slot : slots) {
      int expected = Slot::free;
      if (path.size() >= slot.path.size() || !slot.state.compare_exchange_strong(expected, Slot::taken))
        continue;
      std::copy(path.begin(), path.end(), slot.path.begin());
      slot.path[path.size()] = '\0';
      slot.state = Slot::named;
      slot_ = &slot;
      return;
    }
  }
  ~Unfinished() {
    if (slot_ != nullptr) slot_->state = Slot::free;
  }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

 private:
  Slot* slot_ = nullptr;
};

void write_aside(const std::filesystem::path& path, std::string_view bytes, bool lasting) {
  std::filesystem::path part = path;
  part += ".part";
  const Unfinished noted(part.string());
  const int file = open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) throw cannot_write(path, errno);
  int failed = 0;
  while (!bytes.empty() && failed == 0) {
    const ssize_t n = write(file, bytes.data(), bytes.size());
    if (n >= 0)
      bytes.remove_prefix(static_cast<std::size_t>(n));
    else if (errno != EINTR)
      failed = errno;
  }
  if (failed == 0 && lasting) failed = synced(file);
  if (close(file) != 0 && failed == 0) failed = errno;
  if (failed == 0 && rename(part.c_str(), path.c_str()) != 0) failed = errno;
  if (failed != 0) {
    unlink(part.c_str());
    throw cannot_write(path, failed);
  }
}

}  // namespace

void remove_unfinished_file() noexcept {
  for (Slot& slot : slots)
    if (slot.state == Slot::named) unlink(slot.path.data());
}

void write_whole(const std::filesystem::path& path, std::string_view bytes) {
  write_aside(path, bytes, false);
}

void write_lasting(const std::filesystem::path& path, std::string_view bytes) {
  write_aside(path, bytes, true);
  sync_to_disk(path.has_parent_path() ? path.parent_path() : ".");
}

void sync_to_disk(int file, const std::filesystem::path& path) {
  if (const int failed = synced(file); failed != 0) throw cannot_write(path, failed);
}

void sync_to_disk(const std::filesystem::path& path) {
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file) throw cannot_write(path, errno);
  sync_to_disk(file.get(), path);
}

}  // namespace strake
