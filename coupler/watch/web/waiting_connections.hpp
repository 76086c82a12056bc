#pragma once

#include <httplib.h>  // last: it brings resolv.h, whose macro _res is a name of Eigen's

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

namespace strake::watch {

/// Connections on which no whole request has come yet. Where there is no room for another, the one that has
/// stood for longest is closed: who has a request sends it at once.
class Waiting {
 public:
  /// Waits until the head of a request is there, in whole; false if it does not come in time.
  bool for_request(int socket, std::chrono::milliseconds limit);
  void close_oldest();

 private:
  using Clock = std::chrono::steady_clock;
  std::mutex mutex_;
  void close_first();                       // with the lock, one at least waiting
  std::map<int, Clock::time_point> since_;  // by descriptor
  std::size_t owed_ = 0;                    // calls of close_oldest that found nobody waiting
};

/// Threads as they are needed, each with one connection. Where all are taken, `make_room` is called.
class Crew final : public httplib::TaskQueue {
 public:
  Crew(std::size_t most, std::function<void()> make_room) : most_(most), make_room_(std::move(make_room)) {}
  void enqueue(std::function<void()> job) override;
  void shutdown() override;

 private:
  void work();

  std::size_t most_, idle_ = 0;
  std::function<void()> make_room_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;
  std::vector<std::thread> threads_;
  bool over_ = false;
};

/// httplib's server, with protection against connections that send no request or half of one. httplib gives
/// each of them a thread, for as long as a byte comes now and then.
class PatientServer final : public httplib::Server {
 public:
  PatientServer();
  /// After the bind: more connections may wait for their turn than httplib's five. Where the queue is full,
  /// the next one tries again after a second.
  void widen_queue();

 private:
  bool process_and_close_socket(socket_t socket) override;

  Waiting waiting_;
};

}  // namespace strake::watch
