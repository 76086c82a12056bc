#include "coupler/transport/peer_close_detector.hpp"

#include <cerrno>
#include <fcntl.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace strake {

PeerCloseDetector::PeerCloseDetector(int socket) : socket_(fcntl(socket, F_DUPFD_CLOEXEC, 0)) {}

// The end of a stream is read again and again. Nothing to read yet: the other end is still open.
bool PeerCloseDetector::closed_by_peer() const {
  char byte = 0;
  const ssize_t n = recv(socket_.get(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return n == 0 || (n < 0 && (errno == ECONNRESET || errno == EPIPE));
}

int PeerCloseDetector::unread() const {
  int bytes = 0;
  return ioctl(socket_.get(), SIOCINQ, &bytes) == 0 ? bytes : 0;
}

}  // namespace strake
