#pragma once

#include "proto/descriptor.hpp"

#include <filesystem>
#include <memory>
#include <string>

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

}  // namespace strake
