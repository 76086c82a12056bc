#pragma once

#include "proto/descriptor.hpp"

#include <optional>
#include <string>
#include <sys/stat.h>

namespace strake {

/// The file PATH.lock beside a socket at PATH, locked while its run lives (flock). It names the socket that
/// the run has bound, so that the next run knows what a dead one has left. All operations use the folder that
/// was opened, so that a link placed in between has no effect.
class SocketLock {
 public:
  /// Throws Error(command_line) if another run has locked it, or a file of that name is not Strake's.
  explicit SocketLock(const std::string& path);
  ~SocketLock();  // removes the socket that it names, and itself
  SocketLock(const SocketLock&) = delete;
  SocketLock& operator=(const SocketLock&) = delete;

  /// What stands at the path itself; nothing where it is free.
  std::optional<struct stat> at_path() const;
  /// Whether that is the socket that the lock's last owner has bound.
  bool names(const struct stat&) const;
  void remove_socket() const;
  /// The socket at the path is ours from here on.
  void name_socket();

 private:
  void take();
  bool make();
  bool open_existing();
  std::string read() const;
  void write(const std::string&) const;

  std::string path_, socket_, lock_;  // the whole path; the names in its folder
  Descriptor folder_, file_;
  bool made_ = false, bound_ = false;
  std::string named_;  // identifies the socket
};

/// "coupling.endpoint = ipc://PATH", for errors.
std::string endpoint_key(const std::string& path);

}  // namespace strake
