#include "coupler/transport/unix_listener.hpp"

#include "coupler/transport/endpoint.hpp"
#include "coupler/transport/socket_lock.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
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

}  // namespace strake
