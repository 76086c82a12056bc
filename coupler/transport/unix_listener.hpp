#pragma once

#include "proto/descriptor.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <sys/stat.h>

namespace strake {

class SocketLock;

/// A folder that only this user may enter, removed at the end.
class PrivateFolder {
 public:
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A Unix socket that listens at a path, or at @NAME, which has no file. ZeroMQ's own bind removes any file
/// at the path; this one removes only the socket of a dead run of Strake. The file PATH.lock beside it
/// identifies such a socket: it names the socket, and a live run keeps it locked.
class UnixListener {
 public:
  /// `in_private`: the folder is the caller's alone and new, so that nothing is to be known about the path.
  /// Throws Error(command_line) where something else stands at the path, or no socket can be made there.
  explicit UnixListener(const std::string& path, bool in_private = false);
  ~UnixListener();  // its lock removes the socket, where it is still the one that was bound here

  int descriptor() const { return listening_.get(); }
  /// From here on the descriptor is ZeroMQ's, which closes it.
  void hand_over() { listening_.release(); }

 private:
  void make_way();
  void bind_and_listen();

  std::string path_;
  std::unique_ptr<SocketLock> lock_;  // none for @NAME and in a private folder
  Descriptor listening_;
};

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
