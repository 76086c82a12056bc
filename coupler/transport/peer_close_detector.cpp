#include "coupler/transport/peer_close_detector.hpp"

#include <cerrno>
#include <fcntl.h>
#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace strake {

PeerCloseDetector::PeerCloseDetector(int socket) : socket_(fcntl(socket, F_DUPFD_CLOEXEC, 0)) {}

PeerCloseDetector::~PeerCloseDetector() {
  if (socket_ >= 0) close(socket_);
}

// The end of a stream is read again and again. Nothing to read yet: the other end is still open.
bool PeerCloseDetector::closed_by_peer() const {
  char byte = 0;
  const ssize_t n = recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return n == 0 || (n < 0 && (errno == ECONNRESET || errno == EPIPE));
}

int PeerCloseDetector::unread() const {
  int bytes = 0;
  return ioctl(socket_, SIOCINQ, &bytes) == 0 ? bytes : 0;
}

std::uint64_t bytes_received(int socket) {
  tcp_info info{};
  socklen_t size = sizeof info;
  return getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 ? info.tcpi_bytes_received : 0;
}

}  // namespace strake
