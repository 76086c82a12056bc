#include "coupler/witness.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

namespace strake {

Witness::Witness(int socket) : socket_(fcntl(socket, F_DUPFD_CLOEXEC, 0)) {}

Witness::~Witness() {
  if (socket_ >= 0) close(socket_);
}

// The end of a stream is read again and again. Nothing to read yet: the other end is still open.
bool Witness::closed_by_peer() const {
  char byte = 0;
  const ssize_t n = recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return n == 0 || (n < 0 && (errno == ECONNRESET || errno == EPIPE));
}

}  // namespace strake
