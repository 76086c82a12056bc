#include "coupler/transport/unix_listener.hpp"

#include "coupler/transport/endpoint.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <system_error>
#include <unistd.h>

namespace strake {
namespace {

sockaddr_un address_of(const std::string& path, socklen_t& size) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), std::min(path.size(), unix_path));
  size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
  if (path.front() == '@')
    address.sun_path[0] = '\0';
  else
    ++size;  // with the zero at its end
  return address;
}

Descriptor unix_socket() {
  return Descriptor(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

/// Whether a living process listens there.
bool somebody_listens(const std::string& path) {
  socklen_t size = 0;
  const sockaddr_un address = address_of(path, size);
  const Descriptor s = unix_socket();
  if (!s) return true;  // not known: leave it alone
  return connect(s.get(), reinterpret_cast<const sockaddr*>(&address), size) == 0 || errno != ECONNREFUSED;
}

std::string kind_of(const struct stat& entry) {
  if (S_ISDIR(entry.st_mode)) return "a folder";
  if (S_ISLNK(entry.st_mode)) return "a link";
  if (S_ISFIFO(entry.st_mode)) return "a pipe";
  return S_ISREG(entry.st_mode) ? "a file" : "no socket";
}

}  // namespace

PrivateFolder::PrivateFolder() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  for (const std::string& base : {std::string(runtime ? runtime : ""), std::string("/tmp")}) {
    std::string pattern = base + "/strake-XXXXXX";
    if (base.empty() || pattern.size() + 4 > unix_path) continue;
    if (mkdtemp(pattern.data())) {
      path_ = pattern;
      return;
    }
  }
  throw Error(ExitCode::cannot_write, "/tmp",
              fmt::format("no folder for the socket: {}", std::strerror(errno)),
              "set XDG_RUNTIME_DIR to a folder of yours");
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

UnixListener::UnixListener(const std::string& path, bool in_private) : path_(path) {
  if (path.front() != '@' && !in_private) {
    lock_ = std::make_unique<SocketLock>(path);
    make_way();
  }
  bind_and_listen();
  if (lock_) lock_->name_socket();
}

UnixListener::~UnixListener() = default;

void UnixListener::make_way() {
  const auto entry = lock_->at_path();
  if (!entry) return;
  const auto refuse = [&](const std::string& what, const std::string& fix) {
    throw Error(ExitCode::command_line, endpoint_key(path_), what, fix);
  };
  const std::string another = "another path in coupling.endpoint, or \"ipc\"";
  if (!S_ISSOCK(entry->st_mode))
    refuse(fmt::format("the path is taken: {} stands there", kind_of(*entry)), another);
  if (somebody_listens(path_)) refuse("the path is taken: another program listens there", another);
  if (!lock_->names(*entry))
    refuse("the path is taken: a socket stands there that no run of Strake has left",
           "another path in coupling.endpoint; or remove that socket if nobody uses it");
  lock_->remove_socket();
}

void UnixListener::bind_and_listen() {
  socklen_t size = 0;
  const sockaddr_un address = address_of(path_, size);
  listening_ = unix_socket();
  if (listening_ && bind(listening_.get(), reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
      listen(listening_.get(), accept_queue) == 0)
    return;
  const int reason = errno;
  throw Error(ExitCode::command_line, endpoint_key(path_),
              reason == EADDRINUSE ? "the path is taken: another program uses it"
                                   : fmt::format("cannot be bound: {}", std::strerror(reason)),
              "another path in coupling.endpoint, or \"ipc\"");
}

namespace {

const std::string signature = "socket of a run of Strake:";
constexpr mode_t mine = 0600;

/// A socket made later may have the same number of its file; not also the same time.
std::string identity(const struct stat& entry) {
  return fmt::format("{} {} {} {}.{:09}\n", signature, entry.st_dev, entry.st_ino, entry.st_mtim.tv_sec,
                     entry.st_mtim.tv_nsec);
}

bool same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

}  // namespace

std::string endpoint_key(const std::string& path) {
  return "coupling.endpoint = \"ipc://" + path + "\"";
}

SocketLock::SocketLock(const std::string& path) : path_(path) {
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  socket_ = slash == std::string::npos ? path : path.substr(slash + 1);
  lock_ = socket_ + ".lock";
  folder_ = Descriptor(open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!folder_)
    throw Error(ExitCode::command_line, endpoint_key(path_),
                fmt::format("the folder {} cannot be entered: {}", folder, std::strerror(errno)),
                "a folder that exists and is yours, or \"ipc\"");
  take();
  named_ = read();
}

SocketLock::~SocketLock() {
  const auto entry = at_path();
  const bool ours = bound_ && entry && names(*entry);
  if (ours) remove_socket();
  struct stat held {
  }, found{};
  const bool stands = fstat(file_.get(), &held) == 0 &&
                      fstatat(folder_.get(), lock_.c_str(), &found, AT_SYMLINK_NOFOLLOW) == 0 &&
                      same_file(held, found);
  if (stands && (made_ || bound_)) unlinkat(folder_.get(), lock_.c_str(), 0);
}

/// The file may be removed by its last owner while it is opened here: then once more.
void SocketLock::take() {
  constexpr int attempts = 100;
  for (int i = 0; i < attempts; ++i) {
    if (make()) return;
    if (open_existing()) return;
  }
  throw Error(ExitCode::command_line, endpoint_key(path_), "another run starts there", "another path");
}

/// The file is created with its content and its lock: it is never visible without them.
bool SocketLock::make() {
  const std::string own = fmt::format(".{}-{}", lock_, getpid());
  file_ = Descriptor(
      openat(folder_.get(), own.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mine));
  if (!file_)
    throw Error(ExitCode::command_line, endpoint_key(path_),
                fmt::format("nothing can be written beside it: {}", std::strerror(errno)),
                "a path in a folder of yours, or \"ipc\"");
  try {
    write(signature + "\n");
  } catch (const Error&) {
    unlinkat(folder_.get(), own.c_str(), 0);
    throw;
  }
  made_ = flock(file_.get(), LOCK_EX | LOCK_NB) == 0 &&
          linkat(folder_.get(), own.c_str(), folder_.get(), lock_.c_str(), 0) == 0;
  const int reason = errno;
  unlinkat(folder_.get(), own.c_str(), 0);
  if (made_) return true;
  file_.close();
  if (reason == EEXIST) return false;
  throw Error(ExitCode::command_line, endpoint_key(path_),
              fmt::format("{}.lock cannot be made: {}", path_, std::strerror(reason)),
              "a path in a folder of yours, or \"ipc\"");
}

bool SocketLock::open_existing() {
  file_ = Descriptor(openat(folder_.get(), lock_.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (!file_ && errno == ENOENT) return false;
  struct stat held {
  }, found{};
  const bool known = file_ && fstat(file_.get(), &held) == 0 && S_ISREG(held.st_mode) &&
                     held.st_uid == geteuid() && read().starts_with(signature);
  if (!known)
    throw Error(ExitCode::command_line, endpoint_key(path_),
                fmt::format("{}.lock stands beside it and is no lock of Strake", path_),
                "another path in coupling.endpoint, or remove that file if nobody uses it");
  if (flock(file_.get(), LOCK_EX | LOCK_NB) != 0)
    throw Error(ExitCode::command_line, endpoint_key(path_), "the path is taken: another run uses it",
                "another path in coupling.endpoint, or \"ipc\"");
  if (fstatat(folder_.get(), lock_.c_str(), &found, AT_SYMLINK_NOFOLLOW) == 0 && same_file(held, found))
    return true;
  file_.close();
  return false;
}

std::optional<struct stat> SocketLock::at_path() const {
  struct stat entry {};
  if (fstatat(folder_.get(), socket_.c_str(), &entry, AT_SYMLINK_NOFOLLOW) != 0) return {};
  return entry;
}

bool SocketLock::names(const struct stat& entry) const {
  return S_ISSOCK(entry.st_mode) && entry.st_uid == geteuid() && named_ == identity(entry);
}

void SocketLock::remove_socket() const {
  unlinkat(folder_.get(), socket_.c_str(), 0);
}

void SocketLock::name_socket() {
  const auto entry = at_path();
  if (!entry) return;
  named_ = identity(*entry);
  bound_ = true;
  write(named_);
}

std::string SocketLock::read() const {
  std::array<char, 256> text{};
  const ssize_t n = pread(file_.get(), text.data(), text.size(), 0);
  return {text.data(), static_cast<std::size_t>(n > 0 ? n : 0)};
}

void SocketLock::write(const std::string& text) const {
  const bool written = ftruncate(file_.get(), 0) == 0 &&
                       pwrite(file_.get(), text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
  if (!written)
    throw Error(ExitCode::cannot_write, path_ + ".lock",
                fmt::format("cannot be written: {}", std::strerror(errno)));
}

}  // namespace strake
