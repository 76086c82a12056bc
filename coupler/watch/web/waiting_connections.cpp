#include "coupler/watch/web/waiting_connections.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <poll.h>
#include <string_view>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

namespace strake::watch {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t most_threads = 128;
constexpr std::size_t longest_head = 16384;  // [bytes] of a request
constexpr milliseconds to_ask{2000};         // for the head of a request, from the last answer
constexpr int to_move = 5000;                // [ms] a read or a write may wait

/// A quarter of the descriptors at most: the page is made of files.
std::size_t most_visitors() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return most_threads;
  return std::clamp<std::size_t>(limit.rlim_cur / 4, 8, most_threads);
}

void address_of(int (*ask)(int, sockaddr*, socklen_t*) noexcept, int socket, std::string& ip, int& port) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (ask(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) return;
  const auto& four = reinterpret_cast<const sockaddr_in&>(address);
  const auto& six = reinterpret_cast<const sockaddr_in6&>(address);
  const bool is_six = address.ss_family == AF_INET6;
  const void* number = is_six ? static_cast<const void*>(&six.sin6_addr) : &four.sin_addr;
  if (inet_ntop(address.ss_family, number, text.data(), text.size())) ip = text.data();
  port = ntohs(is_six ? six.sin6_port : four.sin_port);
}

/// A connection as httplib reads and writes it.
class Connection final : public httplib::Stream {
 public:
  explicit Connection(int socket) : socket_(socket) {}
  bool is_readable() const override { return ready(POLLIN); }
  bool is_writable() const override { return ready(POLLOUT); }
  ssize_t read(char* to, std::size_t size) override {
    return is_readable() ? recv(socket_, to, size, 0) : -1;
  }
  ssize_t write(const char* from, std::size_t size) override {
    return is_writable() ? send(socket_, from, size, MSG_NOSIGNAL) : -1;
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    address_of(getpeername, socket_, ip, port);
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override {
    address_of(getsockname, socket_, ip, port);
  }
  socket_t socket() const override { return socket_; }

 private:
  bool ready(short what) const {
    pollfd one{socket_, what, 0};
    return poll(&one, 1, to_move) > 0;
  }
  int socket_;
};

/// The socket is readable when more than so many bytes are there.
void wake_beyond(int socket, std::size_t bytes) {
  const int least = static_cast<int>(bytes) + 1;
  setsockopt(socket, SOL_SOCKET, SO_RCVLOWAT, &least, sizeof least);
}

bool head_comes(int socket, milliseconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  std::array<char, longest_head> text;
  for (std::size_t had = 0;;) {
    const auto left = std::chrono::duration_cast<milliseconds>(end - std::chrono::steady_clock::now());
    pollfd one{socket, POLLIN, 0};
    if (left.count() <= 0 || poll(&one, 1, static_cast<int>(left.count())) <= 0) return false;
    const ssize_t n = recv(socket, text.data(), text.size(), MSG_PEEK | MSG_DONTWAIT);
    if (n <= 0) return false;
    const std::string_view head(text.data(), static_cast<std::size_t>(n));
    if (head.find("\r\n\r\n") != std::string_view::npos) return true;
    if (head.size() == had || head.size() == text.size()) return false;  // it has closed, or never ends
    had = head.size();
    wake_beyond(socket, had);
  }
}

}  // namespace

bool Waiting::for_request(int socket, milliseconds limit) {
  {
    const std::lock_guard lock(mutex_);
    since_[socket] = Clock::now();
    if (owed_ > 0 && since_.size() > 1) {
      --owed_;
      close_first();
    }
  }
  const bool comes = head_comes(socket, limit);
  wake_beyond(socket, 0);
  const std::lock_guard lock(mutex_);
  since_.erase(socket);
  return comes;
}

void Waiting::close_oldest() {
  const std::lock_guard lock(mutex_);
  // Under load the threads may not yet wait for the connections that they were given. One is closed when they
  // do.
  if (since_.empty())
    ++owed_;
  else
    close_first();
}

void Waiting::close_first() {
  const auto oldest = std::min_element(since_.begin(), since_.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
  ::shutdown(oldest->first, SHUT_RDWR);
  since_.erase(oldest);
}

void Crew::enqueue(std::function<void()> job) {
  bool full = false;
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
    if (jobs_.size() > idle_) {
      full = threads_.size() >= most_;
      if (!full) threads_.emplace_back([this] { work(); });
    }
  }
  changed_.notify_one();
  if (full) make_room_();
}

void Crew::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    ++idle_;
    changed_.wait(lock, [this] { return over_ || !jobs_.empty(); });
    --idle_;
    if (jobs_.empty()) return;
    const auto job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    job();
    lock.lock();
  }
}

void Crew::shutdown() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

PatientServer::PatientServer() {
  new_task_queue = [this] {  // httplib owns it
    return new Crew(most_visitors(), [this] { waiting_.close_oldest(); });
  };
}

void PatientServer::widen_queue() {
  constexpr int connections = 512;
  ::listen(svr_sock_, connections);
}

bool PatientServer::process_and_close_socket(socket_t socket) {
  Connection connection(socket);
  bool good = true;
  for (std::size_t left = keep_alive_max_count_; good && left > 0 && is_running(); --left) {
    if (!waiting_.for_request(socket, to_ask)) break;
    bool closed = false;
    good = process_request(connection, left == 1, closed, nullptr);
    if (closed) break;
  }
  ::shutdown(socket, SHUT_RDWR);
  ::close(socket);
  return good;
}

}  // namespace strake::watch
