#include "coupler/transport/connection_limit.hpp"

#include "coupler/transport/system_calls.hpp"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <utility>

namespace strake {
namespace {

using std::chrono::milliseconds;

constexpr std::uint64_t introduction = 1 << 16;  // [bytes] more than any Hello has, with all around it
constexpr std::size_t least_places = 4, most_places = 64;
constexpr milliseconds to_speak{30};       // [ms] a connection that has sent nothing may be replaced then
constexpr milliseconds to_introduce{200};  // [ms] any other
constexpr milliseconds between_looks{2};
// The kernel counts only the unread bytes of a Unix socket. A peer that has unread bytes at so many tests,
// over all connections, has sent for 16 ms without a pause.
constexpr int most_sending = 8, greeting = 2;  // [tests]; those of a peer that introduces itself
constexpr int little = 4096;                   // [bytes]

/// The limits of this process, for accept4.
struct Registry {
  std::mutex mutex;
  std::vector<ConnectionLimit*> limits;
};
Registry& registry() {
  static Registry all;
  return all;
}

ino_t file_of(int descriptor) {
  struct stat entry {};
  return fstat(descriptor, &entry) == 0 && S_ISSOCK(entry.st_mode) ? entry.st_ino : 0;
}

/// A quarter of the descriptors at most: the run itself opens files.
std::size_t places() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return most_places;
  return std::clamp<std::size_t>(limit.rlim_cur / 4, least_places, most_places);
}

bool is_local(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  return getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
         address.ss_family == AF_UNIX;
}

int system_accept(int listening, sockaddr* address, socklen_t* size, int flags) {
  return static_cast<int>(syscall(SYS_accept4, listening, address, size, flags));
}

}  // namespace

ConnectionLimit::ConnectionLimit() : spare_(open("/dev/null", O_RDONLY | O_CLOEXEC)), most_(least_places) {
  {
    const std::lock_guard lock(registry().mutex);
    registry().limits.push_back(this);
  }
  thread_ = thread_without_signals([this] { run(); });
}

ConnectionLimit::~ConnectionLimit() {
  {
    const std::lock_guard lock(registry().mutex);
    std::erase(registry().limits, this);
  }
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void ConnectionLimit::guard(int listening) {
  const std::lock_guard lock(registry().mutex);
  const std::lock_guard own(mutex_);
  listening_ = listening;
  most_ = places();
}

void ConnectionLimit::admit(int socket) {
  const std::lock_guard lock(mutex_);
  std::erase_if(waiting_, [socket](const Waiting& w) { return w.socket == socket; });
}

std::map<std::string, int> ConnectionLimit::take_refused() {
  const std::lock_guard lock(mutex_);
  return std::exchange(refused_, {});
}

void ConnectionLimit::note(const std::string& what) {
  constexpr std::size_t enough = 100;  // between two tests
  ++refused_[refused_.size() < enough || refused_.contains(what) ? what : "others were refused too"];
}

bool ConnectionLimit::lets_in(int socket) {
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= most_) forget_closed();
  if (waiting_.size() >= most_ && !make_room()) {
    note(peer_address(socket) + " was turned away: too many have not said who they are");
    return false;
  }
  waiting_.push_back({socket, file_of(socket), Clock::now()});
  if (waiting_.size() == 1) changed_.notify_one();
  return true;
}

/// Those that are cut keep their descriptors until ZeroMQ has seen it: never more of them than places.
bool ConnectionLimit::make_room() {
  if (waiting_.size() >= 2 * most_) return false;
  const auto now = Clock::now();
  Waiting* oldest = nullptr;
  std::size_t standing = 0;
  for (Waiting& w : waiting_) {
    if (w.cut) continue;
    ++standing;
    if (!oldest) oldest = &w;  // they stand in the order in which they came
  }
  if (standing < most_) return true;
  const bool silent =
      now - oldest->since >= to_speak && !is_local(oldest->socket) && bytes_received(oldest->socket) == 0;
  if (!silent && now - oldest->since < to_introduce) return false;
  cut(*oldest, "");
  return true;
}

void ConnectionLimit::cut(Waiting& w, const std::string& why) {
  w.cut = true;
  if (file_of(w.socket) != w.file) return;
  if (!why.empty()) note(peer_address(w.socket) + why);
  shutdown(w.socket, SHUT_RDWR);
}

void ConnectionLimit::forget_closed() {
  std::erase_if(waiting_, [](const Waiting& w) { return file_of(w.socket) != w.file; });
}

/// ZeroMQ hands a message over when it is whole. The parts of one that never ends would pile up in memory,
/// and no limit of its own counts them.
void ConnectionLimit::cut_the_talkative() {
  int sending = 0;
  Waiting* most = nullptr;
  for (Waiting& w : waiting_) {
    if (w.cut) continue;
    int unread = 0;
    if (is_local(w.socket) && ioctl(w.socket, SIOCINQ, &unread) == 0 && unread > 0 &&
        (unread > little || unread != w.unread))  // a few bytes may wait for ZeroMQ's thread
      ++w.sending;
    w.unread = unread;
    if (bytes_received(w.socket) > introduction) cut(w, " sent more than 64 kB and did not say who it is");
    if (w.cut) continue;
    sending += std::max(0, w.sending - greeting);
    if (!most || w.sending > most->sending) most = &w;
  }
  if (sending > most_sending) cut(*most, " sent without a pause and did not say who it is");
}

void ConnectionLimit::run() {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    if (waiting_.empty())
      changed_.wait(lock);
    else
      changed_.wait_for(lock, between_looks);
    forget_closed();
    cut_the_talkative();
  }
}

void ConnectionLimit::turn_away_one(int listening) {
  const std::lock_guard lock(mutex_);
  spare_.close();
  const int socket = system_accept(listening, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (socket >= 0) {
    note(peer_address(socket) + " was turned away: the process has no descriptor left");
    close(socket);
  }
  spare_ = Descriptor(open("/dev/null", O_RDONLY | O_CLOEXEC));
}

namespace {

/// What accept4 does where ZeroMQ listens.
int accept_within(ConnectionLimit& limit, int listening, sockaddr* address, socklen_t* size, int flags) {
  const int socket = system_accept(listening, address, size, flags);
  if (socket < 0 &&
      (errno == EMFILE || errno == ENFILE)) {  // ZeroMQ would abort, or try again without a pause
    limit.turn_away_one(listening);
    errno = ECONNABORTED;
    return -1;
  }
  if (socket < 0 || limit.lets_in(socket)) return socket;
  close(socket);
  errno = ECONNABORTED;
  return -1;
}

}  // namespace
}  // namespace strake

/// Replaces the C library's accept4 for every library of this process: the dynamic linker takes the program's
/// own. Only here can a connection be kept back from ZeroMQ. Its filters see addresses and users alone, and
/// its monitor reports a connection that is already accepted.
extern "C" int accept4(int listening, sockaddr* address, socklen_t* size, int flags) {
  using namespace strake;
  {
    const std::lock_guard lock(registry().mutex);
    const auto& limits = registry().limits;
    const auto limit = std::find_if(limits.begin(), limits.end(),
                                    [&](const ConnectionLimit* g) { return g->is_for(listening); });
    if (limit != limits.end()) return accept_within(**limit, listening, address, size, flags);
  }
  return system_accept(listening, address, size, flags);
}
