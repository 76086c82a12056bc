#include "proto/whole_file.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <system_error>

namespace strake {

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
  std::string fix = "free space there or choose another folder with --runs";
  if (error_number == ENOENT || error_number == ENOTDIR)
    fix = "make the folder " + path.parent_path().string();
  if (error_number == EACCES || error_number == EROFS || error_number == EPERM)
    fix = "choose a folder that may be written with --runs";
  return {ExitCode::cannot_write, path.string(),
          "cannot be written: " + std::generic_category().message(error_number), fix};
}

namespace {

void write_aside(const std::filesystem::path& path, std::string_view bytes, bool lasting) {
  std::filesystem::path part = path;
  part += ".part";
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
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw cannot_write(path, errno);
  const int failed = synced(file);
  close(file);
  if (failed != 0) throw cannot_write(path, failed);
}

}  // namespace strake
