#pragma once

#include "proto/descriptor.hpp"

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <sys/types.h>
#include <thread>
#include <vector>

namespace strake {

/// Limits the connections that have not yet said who they are. ZeroMQ accepts all that come, and has no limit
/// of its own: a crowd would use up the descriptors and the memory of the whole process. Therefore this
/// program's own accept4 replaces that of the C library and calls this class. If all places are taken, the
/// connection with the longest time to introduce itself is closed for the next. A connection that sends far
/// more than an introduction is cut.
class ConnectionLimit {
 public:
  /// Whoever is accepted anywhere counts, until `guard` says where.
  ConnectionLimit();
  ~ConnectionLimit();
  ConnectionLimit(const ConnectionLimit&) = delete;
  ConnectionLimit& operator=(const ConnectionLimit&) = delete;

  /// The descriptor that listens.
  void guard(int listening);
  /// That connection takes part, and no longer counts.
  void admit(int socket);
  /// Whom it turned away since the last call: "127.0.0.1 was turned away …" → how often.
  std::map<std::string, int> take_refused();

  bool is_for(int listening) const { return listening_ == listening || listening_ < 0; }
  /// Of a connection that has just been accepted: whether it may stay. Called by ZeroMQ's thread.
  bool lets_in(int socket);
  /// The process has no descriptor left: takes one connection from the queue and closes it.
  void turn_away_one(int listening);

 private:
  using Clock = std::chrono::steady_clock;
  struct Waiting {
    int socket = -1;
    ino_t file = 0;  // of that socket: the number may be another's by now
    Clock::time_point since;
    int unread = 0;   // bytes at the last test
    int sending = 0;  // how often it was seen to send on
    bool cut = false;
  };
  void run();
  void forget_closed();
  bool make_room();
  void cut_the_talkative();
  void cut(Waiting&, const std::string& why);
  void note(const std::string& what);

  int listening_ = -1;  // only changed while the registry is locked
  Descriptor spare_;
  std::size_t most_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Waiting> waiting_;
  std::map<std::string, int> refused_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace strake
