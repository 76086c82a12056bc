#pragma once

#include "coupler/transport/curve_keys.hpp"
#include "coupler/transport/sockets.hpp"
#include "proto/error.hpp"

#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <thread>

/// Detects that the coupler of a participant is gone, for serve.cpp alone.
namespace strake {

/// From here on the death of the process that started this program ends it. For the first moments of a
/// program and for its modes (--check); `prepare_last_moments` then says it with a line in the log.
void end_with_starter();

/// From this call on, SIGTERM ends the process with a line in the log. So does the end of a coupler that
/// started it.
void prepare_last_moments(const std::string& name, const std::string& endpoint);

/// Whether the coupler started this process, so that both are on one machine.
bool started_by_coupler();

/// Libraries that a solver starts (MPI, PETSc) may have their own ideas about signals: called again after
/// Setup.
void take_signals();

/// Watches parent and connection, in a thread of its own, while the numerics run. Ends the process when the
/// coupler is gone, or will never let it in.
class Watch {
 public:
  Watch(ParticipantSocket& socket, std::string endpoint, std::optional<ParticipantKeys> keys)
      : endpoint_(std::move(endpoint)), keys_(std::move(keys)), thread_([this, &socket] { run(socket); }) {}
  ~Watch() {
    stop_ = true;
    thread_.join();
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// True if the connection was made anew since the last call: the other side needs Hello again.
  bool take_renewed() { return renewed_.exchange(false); }

 private:
  void run(ParticipantSocket& socket);
  /// Ends the process if the coupler will never receive its messages.
  void judge(LinkEvent, int in_a_row, std::chrono::steady_clock::duration since_first) const;
  [[noreturn]] void give_up(ExitCode, const std::string& problem, const std::string& fix) const;

  std::string endpoint_;
  std::optional<ParticipantKeys> keys_;
  std::atomic<bool> stop_{false}, renewed_{false};
  std::thread thread_;
};

}  // namespace strake
